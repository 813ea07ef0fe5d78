//! Things that are thinner than a pixel, or smaller: what is known to be there is sampled, and what is said of the error is true.

use glam::DVec3;
use whitted::{
    geometry::{Mesh, mesh::Attributes},
    math::random::SplitMix64,
    render::{Goal, RenderOptions, Rendering},
    scene::{MeshPart, Parts, Scene, builtin},
};

use super::{
    super::support,
    mode,
    scenes::{SIDE, rendered, rmse},
};

/// White things on black; a pixel is 20/72 = 0.278 wide at z = 0.
const DARK: &str = r"
    resolution = [72, 72]
    depth = 1
    background = [0, 0, 0]
    camera = { eye = [0, 0, 10], look_at = [0, 0, 0], up = [0, 1, 0], vertical_fov = 90 }
    light = []
    material.white = { ambient = 1 }
";

/// Cylinders a twentieth of a pixel wide and spheres smaller than a pixel, bright on black: the rays of `adaptive` meet them in
/// every pixel that they cross for two thirds of a side or more, and look into every pixel that they touch; samples alone find
/// a few.
#[test]
fn thin_things_are_found() {
    let scene = support::scene(&format!(
        r#"{DARK}
        object = [
            {{ material = "white", shape.cylinder = {{ base = [-7.9, -9.5, 0], top = [-7.9, 9.5, 0], radius = 0.00694, ends = "open" }} }},
            {{ material = "white", shape.cylinder = {{ base = [-7, -9.1, 0], top = [9, 8.3, 0], radius = 0.00694, ends = "open" }} }},
            {{ material = "white", shape.sphere = {{ center = [5.07, -6.2, 0], radius = 0.06 }} }},
        ]"#
    ));
    let seen = |aa: &str| {
        let film = rendered(&scene, mode(aa)).film;
        (film.pixels().iter().filter(|color| color.x > 0.0).count(), film)
    };
    // The upright one crosses 68 whole pixels, the slanted one 58 columns and 63 rows.
    let (truth, reference) = seen("sobol:1024");
    assert!((180..220).contains(&truth), "{truth}");
    let (blind, _) = seen("none");
    let (found, film) = seen("adaptive:4");
    assert!(blind * 5 < truth, "{blind} of {truth}");
    let crossed = reference.pixels().iter().zip(film.pixels()).filter(|(t, _)| t.x > 0.035);
    let missed = crossed.filter(|(_, color)| color.x == 0.0).count();
    assert_eq!(missed, 0, "{found} of {truth}");
    let touched = reference.pixels().iter().zip(film.samples()).filter(|(t, _)| t.x > 0.0);
    assert!(touched.into_iter().all(|(_, rays)| *rays >= 10), "every pixel touched is sampled");
    let rays: u32 = film.samples().iter().sum();
    assert!(rays < 6 * SIDE * SIDE, "{rays}");
}

/// The triangles of a bar between two points, `width` wide both ways, every corner by itself.
fn bar(a: DVec3, b: DVec3, width: f64) -> Vec<DVec3> {
    let (u, v) = (b - a).normalize().any_orthonormal_pair();
    let corner = |k: usize| {
        let side = |bit: usize| (k >> bit & 1) as f64 - 0.5;
        let end = if k < 4 { a } else { b };
        end + (u * side(0) + v * side(1)) * width
    };
    let sides =
        [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];
    sides.into_iter().flat_map(|[a, b, c, d]| [a, b, c, a, c, d]).map(corner).collect()
}

/// A square of many triangles smaller than a pixel, every corner by itself.
fn plate(corner: DVec3, side: f64) -> Vec<DVec3> {
    const PARTS: u32 = 60;
    let point = |i: u32, j: u32| {
        corner + DVec3::new(f64::from(i), f64::from(j), 0.0) * (side / f64::from(PARTS))
    };
    let cells = (0..PARTS).flat_map(|i| (0..PARTS).map(move |j| (i, j)));
    let corners = |(i, j): (u32, u32)| {
        let [a, b, c, d] =
            [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(i, j)| point(i, j));
        [a, b, c, a, c, d]
    };
    cells.flat_map(corners).collect()
}

/// The same with bars and a crumb that are pieces of one mesh, beside a plate that is not thin whatever its triangles are. A bar is
/// narrower than the rod about it, so a few of the pixels may be looked into in vain.
#[test]
fn thin_pieces_of_a_mesh_are_found() {
    let behind =
        r#"object = [{ material = "white", shape.sphere = { center = [0, 0, 20], radius = 1 } }]"#;
    let desc = toml::from_str(&format!("{DARK}{behind}")).expect("a description");
    let mut parts = Parts::try_new(&desc, &mut builtin::picture).expect("parts");
    let mut vertices = bar(DVec3::new(-7.9, -9.5, 0.0), DVec3::new(-7.9, 9.5, 0.0), 0.0139);
    vertices.extend(bar(DVec3::new(-7.0, -9.1, 0.0), DVec3::new(3.0, 8.3, 0.0), 0.0139));
    vertices.extend(bar(DVec3::new(2.0, -6.2, 0.0), DVec3::new(2.05, -6.2, 0.0), 0.05));
    vertices.extend(plate(DVec3::new(4.05, -3.95, 0.0), 5.0));
    let count = vertices.len() as u32 / 3;
    let triangles = (0..count).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    let mesh = Mesh::try_new(vertices, triangles, Attributes::default()).expect("a mesh");
    let material_of = vec![parts.material_of[0]; count as usize];
    parts.meshes.push(MeshPart { mesh, material_of });
    let scene = Scene::assemble("pieces", parts).expect("a scene");
    let [truth, blind, film] =
        ["sobol:1024", "none", "adaptive:4"].map(|aa| rendered(&scene, mode(aa)).film);
    let (mut touched, mut by_chance, mut missed) = (0, 0, 0);
    for (x, y) in (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x, y))) {
        let rays = film.samples()[(y * SIDE + x) as usize];
        if x > 49 {
            let is_white = |x: u32, y: u32| truth.pixel(x.min(SIDE - 1), y.min(SIDE - 1)).x == 1.0;
            let inner = (0..9).all(|k| y > 0 && is_white(x + k % 3 - 1, y + k / 3 - 1));
            assert!(!inner || rays <= 2, "{x}, {y}: {rays}");
        } else if truth.pixel(x, y).x > 0.0 {
            touched += 1;
            by_chance += u32::from(blind.pixel(x, y).x > 0.0);
            missed += u32::from(truth.pixel(x, y).x > 0.035 && film.pixel(x, y).x == 0.0);
            assert!(rays >= 10, "{x}, {y}: {rays}");
        }
    }
    assert!(
        touched > 150 && by_chance * 10 < touched && missed * 12 < touched,
        "{touched} {by_chance} {missed}"
    );
}

/// A picture in which the white objects of [`DARK`] are these.
fn white(shapes: &[String]) -> Scene {
    let object = |shape: &String| format!("{{ material = \"white\", shape.{shape} }}");
    let objects: Vec<String> = shapes.iter().map(object).collect();
    support::scene(&format!("{DARK} object = [{}]", objects.join(", ")))
}

/// A render to an error, however many rays it takes.
fn towards(scene: &Scene, error: f64) -> Rendering {
    let options = RenderOptions {
        size: Some([SIDE; 2]),
        aa: mode("adaptive:0,1024"),
        goal: Goal::Error(error),
        ..RenderOptions::default()
    };
    support::rendering(scene, &options)
}

/// Asserts that what a render says of its error is true within a factor of 2; returns the error.
fn assert_honest(name: &str, rendering: &Rendering, truth: &whitted::film::Film) -> f64 {
    let error = rmse(&rendering.film, truth);
    let ratio = rendering.estimated_rmse.expect("an estimate") / error;
    println!("{name:12} is off by {error:6.3}, and says {ratio:.2} of that");
    assert!((0.5..=2.0).contains(&ratio), "{name}: {ratio:.2} of {error:.3}");
    error
}

/// Oracle: 1024 samples in every pixel, which meet what 8 or 32 may miss.
#[test]
fn spheres_smaller_than_pixels_are_found_at_any_place() {
    let mut random = SplitMix64::new(11);
    let pixel = 20.0 / f64::from(SIDE);
    let mut place = || (random.uniform() - 0.5) * 19.0;
    let spheres: Vec<String> = (0..150)
        .map(|_| {
            let (x, y) = (place(), place());
            format!("sphere = {{ center = [{x}, {y}, 0], radius = {} }}", 0.2 * pixel)
        })
        .collect();
    let scene = white(&spheres);
    let truth = rendered(&scene, mode("sobol:1024")).film;
    let refined = rendered(&scene, mode("adaptive"));
    let lit = truth.pixels().iter().zip(refined.film.pixels()).filter(|(t, _)| t.x > 0.05);
    let (all, missed) = lit
        .fold((0, 0), |(all, missed), (_, color)| (all + 1, missed + usize::from(color.x == 0.0)));
    assert!(all > 140 && missed * 50 <= all, "{missed} of {all} pixels");
    assert_honest("adaptive", &refined, &truth);
    // One ray in each pixel meets few; that is no error of zero.
    let error = assert_honest("to an error", &towards(&scene, 1.0), &truth);
    assert!(error < 1.5, "{error}");
}

/// Oracle: 1024 samples in every pixel.
#[test]
fn a_wire_that_runs_past_the_eye_is_found() {
    let scene = white(&[
        "cylinder = { base = [-2, 1, -30], top = [0.3, 0.2, 14], radius = 0.003, ends = \"open\" }"
            .to_owned(),
    ]);
    let truth = rendered(&scene, mode("sobol:1024")).film;
    let refined = rendered(&scene, mode("adaptive"));
    let touched = truth.pixels().iter().zip(refined.film.samples()).filter(|(t, _)| t.x > 0.0);
    let (all, seen) =
        touched.fold((0, 0), |(all, seen), (_, rays)| (all + 1, seen + usize::from(*rays > 1)));
    assert!(all > 30 && seen == all, "{seen} of {all} pixels");
    assert_honest("adaptive", &refined, &truth);
}

/// Needles wider than a pixel and a half at one end, of which the other end is thin. Oracle: 1024 samples in every pixel.
#[test]
fn the_thin_ends_of_needles_are_found() {
    let pixel = 20.0 / f64::from(SIDE);
    for width in [1.6, 2.0] {
        let needle = |k: u32| {
            let (x, lean) = (0.8 * f64::from(k) - 8.0, 0.07 * f64::from(k) - 0.5);
            let (from, to) = (format!("[{x}, -8, 0]"), format!("[{}, 8, 0]", x + lean));
            let radius = width / 2.0 * pixel;
            format!("cone = {{ base = {from}, apex = {to}, radius = {radius}, ends = \"open\" }}")
        };
        let scene = white(&(0..20).map(needle).collect::<Vec<String>>());
        let truth = rendered(&scene, mode("sobol:1024")).film;
        for aa in ["adaptive", "adaptive:16"] {
            assert_honest(&format!("{width} {aa}"), &rendered(&scene, mode(aa)), &truth);
        }
        assert_honest(&format!("{width} to 2"), &towards(&scene, 2.0), &truth);
    }
}

/// Discs seen nearly edge-on, small tetrahedra, and narrow quads and triangles. Oracle: 1024 samples in every pixel.
#[test]
fn thin_flat_things_are_found() {
    let pixel = 20.0 / f64::from(SIDE);
    let mut random = SplitMix64::new(8);
    let mut number = |from: f64, to: f64| from + (to - from) * random.uniform();
    let mut disc = || {
        let (x, y, lean) = (number(-8.0, 8.0), number(-9.0, 9.0), number(-0.8, 0.8));
        let [dx, dy] = [-lean.sin(), lean.cos()].map(|part| 0.15 * pixel * part);
        let (from, to) = (format!("[{x}, {y}, 0]"), format!("[{}, {}, 0]", x + dx, y + dy));
        format!("cylinder = {{ base = {from}, top = {to}, radius = 1.3, ends = \"closed\" }}")
    };
    let discs: Vec<String> = (0..30).map(|_| disc()).collect();
    let mut tetrahedron = || {
        let (x, y, turn) = (number(-9.0, 9.0), number(-9.0, 9.0), number(0.0, 120.0));
        let edge = 0.5 * pixel;
        format!("tetrahedron = {{ base_center = [{x}, {y}, 0], edge = {edge}, turn = {turn} }}")
    };
    let tetrahedra: Vec<String> = (0..200).map(|_| tetrahedron()).collect();
    let mut narrow = |k: u32| {
        let (x, y, lean) = (number(-8.0, 8.0), number(-8.0, 3.0), number(-0.8, 0.8));
        let [dx, dy] = [lean.sin(), lean.cos()].map(|part| 5.0 * part);
        let [u, v] = [lean.cos(), -lean.sin()].map(|part| 0.2 * pixel * part);
        if k.is_multiple_of(2) {
            format!("quad = {{ corner = [{x}, {y}, 0], edges = [[{dx}, {dy}, 0], [{u}, {v}, 0]] }}")
        } else {
            let corners = [[x, y], [x + u, y + v], [x + dx, y + dy]].map(|[x, y]| [x, y, 0.0]);
            format!("triangle = {{ vertices = {corners:?} }}")
        }
    };
    let narrow: Vec<String> = (0..40).map(&mut narrow).collect();
    for (name, shapes) in [("discs", discs), ("tetrahedra", tetrahedra), ("narrow", narrow)] {
        let scene = white(&shapes);
        let truth = rendered(&scene, mode("sobol:1024")).film;
        for aa in ["adaptive", "adaptive:8", "adaptive:16"] {
            assert_honest(&format!("{name} {aa}"), &rendered(&scene, mode(aa)), &truth);
        }
        assert_honest(&format!("{name} to 2"), &towards(&scene, 2.0), &truth);
    }
}

/// Thirty wires `width` pixels wide, each leaning a little more than the one before.
fn fence(width: f64, least_lean: f64) -> Scene {
    let pixel = 20.0 / f64::from(SIDE);
    let wire = |k: u32| {
        let (x, lean) = (0.4 * f64::from(k) - 8.0, least_lean + 0.07 * f64::from(k));
        format!(
            "cylinder = {{ base = [{x}, -8, 0], top = [{}, 8, 0], radius = {}, ends = \"open\" }}",
            x + lean,
            width / 2.0 * pixel
        )
    };
    white(&(0..30).map(wire).collect::<Vec<String>>())
}

/// Wires a tenth of a pixel wide, each of whose pixels is met by one sample of four or two of sixteen: by chance, which even
/// samples know of. Oracle: 1024 samples in every pixel.
#[test]
fn even_samples_know_that_they_meet_wires_by_chance() {
    let scene = fence(0.1, 4.0);
    let truth = rendered(&scene, mode("sobol:1024")).film;
    for aa in ["grid:2", "grid:3", "grid:4", "grid:8", "sobol:4", "sobol:16"] {
        assert_honest(aa, &rendered(&scene, mode(aa)), &truth);
    }
}

/// The same for wires that are nearly upright, so that a whole column of samples meets one or none does.
#[test]
fn whole_columns_of_samples_know_that_they_meet_wires_by_chance() {
    for width in [0.1, 0.3, 0.6] {
        let scene = fence(width, -1.0);
        let truth = rendered(&scene, mode("sobol:1024")).film;
        for aa in ["grid:2", "grid:3", "grid:4", "grid:6"] {
            assert_honest(&format!("{width} {aa}"), &rendered(&scene, mode(aa)), &truth);
        }
    }
}

/// Rectangles whose edges are upright and level, or nearly: all rows of a pixel's samples are off by as much. Oracle: 1024 samples
/// in every pixel.
#[test]
fn edges_along_the_samples_are_known_to_be_off() {
    for slope in [0.0, 0.01] {
        let mut random = SplitMix64::new(4);
        let mut number = |from: f64, to: f64| from + (to - from) * random.uniform();
        let quads: Vec<String> = (0..12)
            .map(|k| {
                let (x, y, z) = (number(-9.0, 6.0), number(-9.0, 6.0), 0.01 * f64::from(k));
                let (width, height) = (number(0.5, 3.0), number(0.5, 3.0));
                let edges = [[width, width * slope], [-height * slope, height]];
                let [[a, b], [c, d]] = edges;
                format!(
                    "quad = {{ corner = [{x}, {y}, {z}], edges = [[{a}, {b}, 0], [{c}, {d}, 0]] }}"
                )
            })
            .collect();
        let scene = white(&quads);
        let truth = rendered(&scene, mode("sobol:1024")).film;
        for aa in ["none", "grid:2", "grid:3", "grid:4", "grid:6", "grid:8", "sobol:16"] {
            assert_honest(&format!("{slope} {aa}"), &rendered(&scene, mode(aa)), &truth);
        }
    }
}

/// A board of squares half as wide as a pixel, so that neighbouring centres meet the same colour. Oracle: 1024 samples in every pixel.
#[test]
fn cells_between_pixels_are_noticed_in_mirrors_and_behind_glass() {
    let quad = |material: &str, height: f64| {
        format!(
            "{{ material = \"{material}\", shape.quad = {{ corner = [-99, {height}, -99], \
             edges = [[0, 0, 198], [198, 0, 0]] }} }}"
        )
    };
    let eye = "eye = [0, 5, 0], up = [0, 0, -1], vertical_fov = 11.42";
    for (name, look_at, between) in
        [("in a mirror", 9, quad("mirror", 7.5)), ("behind glass", 0, quad("glass", 2.5))]
    {
        let board = quad("board", if look_at == 9 { 0.0 } else { -5.0 });
        let scene = support::scene(&format!(
            r#"
            resolution = [72, 72]
            depth = 4
            background = [0, 0, 0]
            camera = {{ {eye}, look_at = [0, {look_at}, 0] }}
            light = []
            texture.board = {{ checker = {{ even = [0.9, 0.9, 0.9], odd = [0.1, 0.1, 0.1], size = 0.0144, origin = [0.003, 0, 0.004] }} }}
            material.board = {{ texture = "board", ambient = 1 }}
            material.mirror = {{ color = [0, 0, 0], reflection = 1 }}
            material.glass = {{ color = [0, 0, 0], transmission = 1, opacity = 0, ior = 1 }}
            object = [{board}, {between}]"#
        ));
        let truth = rendered(&scene, mode("sobol:1024")).film;
        assert_honest(name, &rendered(&scene, mode("adaptive")), &truth);
    }
}
