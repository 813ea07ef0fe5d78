//! Closed forms.

use glam::{DVec2, Vec2Swizzles};
use whitted::{math::random::SplitMix64, render::Goal};

use super::{Found, Seen, found, picture_of};

const SIDE: u32 = 48;

/// The averages of all pixels, row by row.
fn truth(average: impl Fn(f64, f64) -> f64) -> Vec<f64> {
    let pixels = (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (f64::from(x), f64::from(y))));
    pixels.map(|(x, y)| average(x, y)).collect()
}

fn measure(function: &(dyn Fn(DVec2) -> Seen + Sync), truth: &[f64], aa: &str) -> Found {
    found(&picture_of(function, SIDE, aa, Goal::Mode), truth)
}

/// The area of the part of a pixel where `n·p < c`: its outline, cut off at the line.
fn half_plane_area(x: f64, y: f64, n: DVec2, c: f64) -> f64 {
    let corners =
        [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|(i, j)| DVec2::new(x + i, y + j));
    let mut outline = Vec::new();
    for (k, &from) in corners.iter().enumerate() {
        let to = corners[(k + 1) % 4];
        let (a, b) = (n.dot(from) - c, n.dot(to) - c);
        if a < 0.0 {
            outline.push(from);
        }
        if (a < 0.0) != (b < 0.0) {
            outline.push(from + (to - from) * (a / (a - b)));
        }
    }
    let next = |k: usize| outline[(k + 1) % outline.len()];
    outline.iter().enumerate().map(|(k, p)| p.perp_dot(next(k))).sum::<f64>() / 2.0
}

/// Dark and bright at the sides of a line, at any angle; the line goes off the middle so that all its phases occur.
#[test]
fn edges_at_any_angle_have_their_area() {
    let mut worst_ratio = (1.0_f64, 1.0_f64);
    for degrees in [0.0, 3.0, 11.0, 30.0, 45.0, 67.0, 88.0, 90.0] {
        let n = DVec2::from_angle(f64::to_radians(degrees));
        let c = n.dot(DVec2::splat(f64::from(SIDE) / 2.0)) + 0.3;
        let edge = move |p: DVec2| if n.dot(p) < c { (0.9, 1) } else { (0.1, 2) };
        let truth = truth(|x, y| 0.1 + 0.8 * half_plane_area(x, y, n, c));
        let none = measure(&edge, &truth, "none");
        let four = measure(&edge, &truth, "adaptive:4");
        let one = measure(&edge, &truth, "adaptive:1");
        assert!(
            four.rmse < none.rmse / 3.0 && one.rmse < none.rmse / 6.0,
            "{degrees}: {none:?} {four:?} {one:?}"
        );
        assert!(four.bias.abs() < 1e-3 && one.bias.abs() < 4e-4, "{degrees}: {four:?} {one:?}");
        assert!(four.rays < 3.0 && one.rays < 6.0, "{degrees}: {four:?} {one:?}");
        for Found { ratio, .. } in [none, four, one] {
            worst_ratio = (worst_ratio.0.min(ratio), worst_ratio.1.max(ratio));
        }
    }
    // One line has one phase if it is upright; a picture of many edges is in `scenes`.
    assert!(worst_ratio.0 > 0.5 && worst_ratio.1 < 2.0, "{worst_ratio:?}");
}

/// A disc: the height of its part in a column is known, and columns are summed up finely.
#[test]
fn a_disc_has_its_area() {
    let (center, radius) = (DVec2::new(23.7, 24.2), 15.3_f64);
    let disc = move |p: DVec2| if p.distance(center) < radius { (0.9, 1) } else { (0.1, 2) };
    let average = |x: f64, y: f64| {
        let steps = 4000;
        let height = |k: i32| {
            let along = x + (f64::from(k) + 0.5) / f64::from(steps) - center.x;
            let half = (radius * radius - along * along).max(0.0).sqrt();
            ((center.y + half).min(y + 1.0) - (center.y - half).max(y)).clamp(0.0, 1.0)
        };
        0.1 + 0.8 * (0..steps).map(height).sum::<f64>() / f64::from(steps)
    };
    let truth = truth(average);
    for (aa, most, ratio) in [
        ("none", 20.0, 1.5),
        ("grid:2", 9.0, 2.0),
        ("grid:4", 4.0, 2.0),
        ("adaptive:4", 2.5, 2.0),
        ("adaptive:1", 0.7, 2.0),
    ] {
        let found = measure(&disc, &truth, aa);
        assert!(found.rmse < most, "{aa}: {found:?}");
        assert!(found.ratio > 0.5 && found.ratio < ratio, "{aa}: {found:?}");
        assert!(found.bias.abs() < 2e-3, "{aa}: {found:?}");
    }
}

/// A checkerboard of squares larger than a pixel: a product of two square waves, whose averages are known.
#[test]
fn a_checkerboard_is_the_product_of_its_waves() {
    for size in [1.7, 3.3, 7.9] {
        let sign = move |t: f64| if (t / size).floor().rem_euclid(2.0) < 0.5 { 1.0 } else { -1.0 };
        let board = move |p: DVec2| {
            let product = sign(p.x + 0.4) * sign(p.y + 0.9);
            (0.5 + 0.4 * product, u32::from(product > 0.0))
        };
        // The integral of the wave from 0: a zigzag.
        let zigzag = move |t: f64| {
            let phase = t.rem_euclid(2.0 * size);
            phase.min(2.0 * size - phase)
        };
        let along = |from: f64| zigzag(from + 1.0) - zigzag(from);
        let truth = truth(|x, y| 0.5 + 0.4 * along(x + 0.4) * along(y + 0.9));
        for (aa, most) in [("adaptive:4", 4.5), ("adaptive:1", 2.0)] {
            let found = measure(&board, &truth, aa);
            assert!(found.rmse < most && found.bias.abs() < 2e-3, "{size}, {aa}: {found:?}");
            assert!(found.ratio > 0.5 && found.ratio < 3.0, "{size}, {aa}: {found:?}");
        }
        let none = measure(&board, &truth, "none");
        assert!(none.ratio > 0.5 && none.ratio < 2.0, "{size}: {none:?}");
    }
}

/// A wave that gets shorter to the right, from many pixels to less than two, without any signature: texture alone. The average
/// along x is summed up finely. Where colours are smooth, a grid does better than at the edges that its estimate expects, which
/// is then too large; it is never too small by half.
#[test]
fn a_chirp_is_told_from_its_colours_alone() {
    let rate = 0.032; // half a radian a pixel at x = 8; 1.5 at 24; 3 at 48
    let wave = move |x: f64| 0.5 + 0.45 * (rate * x * x).sin();
    let chirp = move |p: DVec2| (wave(p.x), 0);
    let average = |x: f64, _| {
        let steps = 1000;
        (0..steps).map(|k| wave(x + (f64::from(k) + 0.5) / f64::from(steps))).sum::<f64>()
            / f64::from(steps)
    };
    let truth = truth(average);
    for (aa, most) in [
        ("none", 60.0),
        ("grid:2", 12.0),
        ("grid:4", 4.0),
        ("adaptive:4", 6.0),
        ("adaptive:1", 2.0),
    ] {
        let found = measure(&chirp, &truth, aa);
        assert!(found.rmse < most, "{aa}: {found:?}");
        assert!(found.ratio > 0.5 && found.ratio < 8.0, "{aa}: {found:?}");
    }
}

/// Cells of random greys, or of black and white, without any signature, as a picture that is seen very small: neighbours are alike by
/// chance. The average of a pixel is that of the whole cells in it.
#[test]
fn noise_is_told_from_smooth_colours() {
    for (per_pixel, is_grey, most) in [(7, true, [8.0, 6.0]), (2, false, [12.0, 10.0])] {
        let grey = move |x: i64, y: i64| {
            let mut random = SplitMix64::new((x as u64) << 32 ^ y as u64);
            random.uniform(); // the first is close to that of the cell beside
            let value = random.uniform();
            if is_grey { value } else { value.round() }
        };
        let cell = move |x: f64| (x * f64::from(per_pixel)).floor() as i64;
        let noise = move |p: DVec2| (grey(cell(p.x), cell(p.y)), 0);
        let truth = truth(|x, y| {
            let cells = (0..per_pixel).flat_map(|j| (0..per_pixel).map(move |i| (i, j)));
            let all = cells.map(|(i, j)| grey(cell(x) + i64::from(i), cell(y) + i64::from(j)));
            all.sum::<f64>() / f64::from(per_pixel * per_pixel)
        });
        for (aa, most) in ["adaptive:8", "adaptive:4"].into_iter().zip(most) {
            let found = measure(&noise, &truth, aa);
            println!("{per_pixel} cells, {aa}: off by {:.2}, says {:.2}", found.rmse, found.ratio);
            assert!(found.rmse < most, "{aa}: {found:?}");
            assert!(found.ratio > 0.5 && found.ratio < 2.0, "{aa}: {found:?}");
        }
    }
}

/// One colour: exact, one ray in each pixel, and no error claimed.
#[test]
fn a_plain_picture_takes_one_ray_a_pixel() {
    for aa in ["none", "grid:3", "adaptive:0", "adaptive:1"] {
        let picture = picture_of(&|_| (0.3, 7), SIDE, aa, Goal::Mode);
        assert!(picture.colors.iter().all(|color| (color.x - 0.3).abs() < 1e-6), "{aa}");
        assert!(picture.estimated_rmse() < 1e-3, "{aa}: {}", picture.estimated_rmse());
        let most = picture.samples.iter().max();
        assert_eq!(most, Some(&if aa == "grid:3" { 9 } else { 1 }), "{aa}");
    }
}

/// Discs of a thousandth of a pixel, one in each pixel, at places that differ: no sampling finds them all, and the mean of
/// samples is right on average, which is what the sequence promises.
#[test]
fn specks_are_right_on_average() {
    let area = 1e-3_f64;
    let radius = (area / std::f64::consts::PI).sqrt();
    let speck = move |p: DVec2| {
        let pixel = p.floor();
        let place =
            (pixel * DVec2::new(0.618, 0.755) + pixel.yx() * DVec2::new(0.414, 0.732)).fract();
        let middle = pixel + 0.1 + 0.8 * place;
        if p.distance(middle) < radius { (1.0, 1) } else { (0.0, 2) }
    };
    let truth = vec![area; (SIDE * SIDE) as usize];
    let found = measure(&speck, &truth, "sobol:64");
    // 147,456 samples, of which 147 hit on average.
    let deviation = (area / f64::from(SIDE * SIDE * 64)).sqrt();
    assert!(found.bias.abs() < 5.0 * deviation, "{found:?}, {deviation}");
    let adaptive = picture_of(&speck, SIDE, "adaptive:1", Goal::Mode);
    let hit = adaptive.colors.iter().filter(|color| color.x > 0.0).count();
    // Centres hit one in a thousand pixels; their neighbours look more closely, in vain.
    assert!(hit < (SIDE * SIDE / 20) as usize, "{hit}");
}
