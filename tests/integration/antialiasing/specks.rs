//! Specks seen in a mirror, which no geometry tells and which are found by chance; and small highlights, which are
//! found.

use std::{f64::consts::PI, fmt::Write};

use whitted::{
    film::{Film, Tile},
    render::RenderOptions,
    scene::Scene,
};

use super::{
    super::support,
    mode,
    scenes::{rendered, rmse},
};

/// Pixels either way, and those of each square with a speck in its middle.
const SIDE: u32 = 160;
const SQUARE: u32 = 8;
const SPECKS: u32 = (SIDE / SQUARE).pow(2);

/// The mirror is so far in front of the eye, which sees so much of it up and down: a little, so that spheres look round.
const MIRROR: f64 = 10.0;
const SLOPE: f64 = 0.1;
/// How far the specks are behind the eye.
const BEHIND: f64 = 5.0;

/// White spheres of so many pixels radius, one in each square at a place of its own, behind the eye and in the mirror before it;
/// the rest is black.
fn specks(radius: f64) -> Scene {
    // A sphere at (x, y, z) is seen at (x, y, -2 MIRROR - z), where a pixel is so long:
    let pixel = 2.0 * SLOPE * (2.0 * MIRROR + BEHIND) / f64::from(SIDE);
    let mut random = 1_u32;
    let mut place = |square: u32| {
        random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let within = 2.0 + 4.0 * f64::from(random >> 8) / f64::from(1 << 24);
        (f64::from(square * SQUARE) + within - f64::from(SIDE) / 2.0) * pixel
    };
    let mut spheres = String::new();
    for square in 0..SPECKS {
        let (x, y) = (place(square % (SIDE / SQUARE)), place(square / (SIDE / SQUARE)));
        let shape = format!("{{ center = [{x}, {y}, {BEHIND}], radius = {} }}", radius * pixel);
        let _ = writeln!(spheres, "{{ material = \"white\", shape.sphere = {shape} }},");
    }
    let fov = 2.0 * SLOPE.atan().to_degrees();
    support::scene(&format!(
        r#"
        resolution = [{SIDE}, {SIDE}]
        depth = 2
        background = [0, 0, 0]
        camera = {{ eye = [0, 0, 0], look_at = [0, 0, -1], up = [0, 1, 0], vertical_fov = {fov} }}
        light = []
        material.white = {{ ambient = 1 }}
        material.mirror = {{ color = [0, 0, 0], reflection = 1 }}
        object = [
            {spheres}
            {{ material = "mirror", shape.quad = {{ corner = [-99, -99, -{MIRROR}], edges = [[198, 0, 0], [0, 198, 0]] }} }},
        ]"#
    ))
}

/// The share of the squares with a pixel that is not black.
fn found(film: &Film) -> f64 {
    let mut is_found = vec![false; SPECKS as usize];
    for (y, x) in (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (y, x))) {
        let square = y / SQUARE * (SIDE / SQUARE) + x / SQUARE;
        is_found[square as usize] |= film.pixel(x, y).x > 0.0;
    }
    is_found.iter().filter(|found| **found).count() as f64 / f64::from(SPECKS)
}

/// Oracle: `n` even samples in each pixel meet a disc of radius r pixels, whose place is random, with a chance of n π r² as long as
/// no two of them can. The rays of the adaptive mode follow what the centres met, so whatever they may be at most, n is 1.
#[test]
fn specks_in_a_mirror_are_found_by_chance() {
    let modes: [(f64, &[&str]); 4] = [
        (1.0, &["none", "adaptive:1,4", "adaptive:1,16", "adaptive:1,64", "adaptive:1,256"]),
        (4.0, &["grid:2", "sobol:4"]),
        (16.0, &["grid:4", "sobol:16"]),
        (64.0, &["grid:8"]),
    ];
    for radius in [0.05, 0.1, 0.2, 0.4] {
        let scene = specks(radius);
        for (rays, modes) in modes {
            let expected = rays * PI * radius * radius;
            if expected > 4.0 {
                continue; // none is missed by fewer
            }
            let expected = expected.min(1.0);
            for name in modes {
                let options = RenderOptions { aa: mode(name), ..Default::default() };
                let rendering = support::rendering(&scene, &options);
                let share = found(&rendering.film);
                println!("radius {radius:4}: {name:14} {share:.3}, expected {expected:.3}");
                // Five standard deviations; and discs about the samples overlap where there are many.
                let chance = 5.0 * (expected * (1.0 - expected) / f64::from(SPECKS)).sqrt();
                let overlap = if expected > 0.7 { 0.05 } else { 0.02 };
                assert!((share - expected).abs() <= chance + overlap, "{radius} {name}: {share}");
            }
        }
    }
}

/// Shiny balls whose highlights are narrower than a pixel.
fn shiny_balls() -> Scene {
    let mut objects = String::new();
    for k in 0..60_u32 {
        // Evenly spread, by the golden ratio.
        let [x, y] = [f64::from(k % 10), f64::from(k / 10)];
        let [x, y, z] = [x - 4.5 + 0.618 * y % 1.0, 0.9 * y - 1.3 + 0.618 * x % 0.6, -0.8 * y];
        let shape = format!("{{ center = [{x}, {y}, {z}], radius = 0.4 }}");
        let _ = writeln!(objects, "{{ material = \"shiny\", shape.sphere = {shape} }},");
    }
    support::scene(&format!(
        r"resolution = [72, 72]
        depth = 3
        background = [0.5, 0.6, 0.8]
        camera = {{ eye = [0, 2, 14], look_at = [0, 1, 0], up = [0, 1, 0], vertical_fov = 40 }}
        light = [{{ position = [8, 12, 10], intensity = 0.5 }}, {{ position = [-9, 10, 6], intensity = 0.5 }}]
        material.shiny = {{ color = [0.05, 0.05, 0.05], ambient = 0.1, diffuse = 0.2, specular = 1, shininess = 400 }}
        object = [{objects}]"
    ))
}

/// The adaptive mode finds them, and what every mode says of its error is true.
///
/// Oracle: a converged picture.
#[test]
fn small_highlights_are_found() {
    let scene = shiny_balls();
    let reference = rendered(&scene, mode("sobol:1024")).film;
    let mut honest = |aa: &str| {
        let rendering = rendered(&scene, mode(aa));
        let error = rmse(&rendering.film, &reference);
        let ratio = rendering.estimated_rmse.expect("an estimate") / error;
        println!("highlights: {aa:11} is off by {error:6.2}, and says {ratio:.2} of that");
        assert!((1.0 / 1.5..1.5).contains(&ratio), "{aa}: {ratio:.2} of {error:.3}");
        error
    };
    let [one, four, sixteen] = ["none", "grid:2", "grid:4"].map(&mut honest);
    assert!(one > 2.0 * four && four > 1.5 * sixteen);
    let [coarse, fine, finest] = ["adaptive:8", "adaptive:4", "adaptive:1"].map(&mut honest);
    assert!(coarse < 0.2 * one && fine < 0.7 * coarse && finest < fine);
}

/// Oracle: the whole picture. The first part shows no ball, but the rays around it are as told apart as elsewhere.
#[test]
fn parts_with_small_highlights_are_those_of_the_whole() {
    let scene = shiny_balls();
    let whole = rendered(&scene, mode("adaptive:4")).film;
    for part in [Tile { x0: 30, y0: 0, x1: 41, y1: 7 }, Tile { x0: 21, y0: 30, x1: 50, y1: 47 }] {
        let options =
            RenderOptions { crop: Some(part), aa: mode("adaptive:4"), ..Default::default() };
        let film = support::rendering(&scene, &options).film;
        for (x, y) in (part.y0..part.y1).flat_map(|y| (part.x0..part.x1).map(move |x| (x, y))) {
            assert_eq!(film.pixel(x - part.x0, y - part.y0), whole.pixel(x, y), "{x}, {y}");
        }
    }
}
