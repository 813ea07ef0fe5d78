//! Scenes against converged pictures: is what a render says of its error true? Some of these scenes were never looked at when
//! the constants of the estimate were chosen.

use std::fmt::Write;

use glam::DVec3;
use whitted::{
    aa::{AntiAliasing, levels::levels},
    film::Film,
    geometry::{Mesh, mesh::Attributes},
    render::{RenderOptions, Rendering},
    scene::{MeshPart, Parts, Scene, builtin, load_builtin, load_builtin_of},
};

use super::{super::support, mode};

const SIDE: u32 = 72;

fn rendered(scene: &Scene, aa: AntiAliasing) -> Rendering {
    support::rendering(scene, &RenderOptions { size: Some([SIDE; 2]), aa, ..Default::default() })
}

fn rmse(a: &Film, b: &Film) -> f64 {
    let squares = a
        .pixels()
        .iter()
        .zip(b.pixels())
        .map(|(a, b)| f64::from((levels(*a) - levels(*b)).length_squared()) / 3.0);
    (squares.sum::<f64>() / f64::from(SIDE * SIDE)).sqrt()
}

const STAGE: &str = r#"
    resolution = [72, 72]
    depth = 5
    background = [0.1, 0.2, 0.4]
    camera = { eye = [0, 2, 8], look_at = [0, 1, 0], up = [0, 1, 0], vertical_fov = 40 }
    light = [{ position = [5, 9, 6], intensity = 1 }]
    texture.cat = { image = "cat.png" }
    texture.flower = { image = "flower.png" }
    texture.tiles = { checker = { even = [0.9, 0.9, 0.9], odd = [0.1, 0.1, 0.1], origin = [0, 0, 0], size = 0.4 } }
    material.cat = { texture = "cat", ambient = 0.5, diffuse = 0.5 }
    material.flower = { texture = "flower", ambient = 0.5, diffuse = 0.5 }
    material.tiles = { texture = "tiles", ambient = 0.4, diffuse = 0.6 }
    material.red = { color = [0.9, 0.2, 0.2], ambient = 0.2, diffuse = 0.8, specular = 0.6, shininess = 30 }
    material.mirror = { color = [0.2, 0.2, 0.2], ambient = 0.1, diffuse = 0.2, reflection = 0.8 }
"#;

/// A photograph and nothing else, seen so small that its detail is finer than the pixels.
fn texture() -> Scene {
    support::scene(&format!(
        r#"{STAGE}
        object = [
            {{ material = "cat", shape.quad = {{ corner = [-4, -2, 0], edges = [[8, 0, 0], [0, 8, 0]] }} }},
            {{ material = "flower", shape.sphere = {{ center = [0, 1, 3], radius = 1 }} }},
        ]"#
    ))
}

/// A ball of many small triangles, as a mesh is, on tiles that get smaller than a pixel, beside a mirror.
fn triangles() -> Scene {
    let mut objects = String::new();
    let (rings, around) = (24_u32, 36_u32);
    let point = |i: u32, j: u32| {
        let (t, p) = (
            std::f64::consts::PI * f64::from(i) / f64::from(rings),
            std::f64::consts::TAU * f64::from(j) / f64::from(around),
        );
        format!("[{}, {}, {}]", t.sin() * p.cos() - 1.0, 1.0 + t.cos(), 2.0 + t.sin() * p.sin())
    };
    for i in 0..rings {
        for j in 0..around {
            let [a, b, c, d] = [point(i, j), point(i, j + 1), point(i + 1, j + 1), point(i + 1, j)];
            if i > 0 {
                let _ = writeln!(
                    objects,
                    "{{ material = \"red\", shape.triangle = {{ vertices = [{a}, {b}, {c}] }} }},"
                );
            }
            if i + 1 < rings {
                let _ = writeln!(
                    objects,
                    "{{ material = \"red\", shape.triangle = {{ vertices = [{a}, {c}, {d}] }} }},"
                );
            }
        }
    }
    support::scene(&format!(
        r#"{STAGE}
        object = [
            {objects}
            {{ material = "tiles", shape.quad = {{ corner = [-40, 0, 8], edges = [[80, 0, 0], [0, 0, -80]] }} }},
            {{ material = "mirror", shape.sphere = {{ center = [1.5, 1, 1], radius = 1 }} }},
        ]"#
    ))
}

/// Oracle: 256 rays in each pixel at places that none of the modes use. Half of the truth is the least that may be said, and
/// within one and a half times is what most must be.
#[test]
fn what_is_said_of_the_error_is_true() {
    let scenes = [
        ("assignment", load_builtin("assignment").expect("a scene")),
        ("spheres", load_builtin_of("spheres", Some(300)).expect("a scene")),
        ("texture", texture()),
        ("triangles", triangles()),
    ];
    let (mut all, mut close, mut low) = (0, 0, Vec::new());
    let mut report = String::new();
    for (name, scene) in scenes {
        let truth = rendered(&scene, mode("sobol:256")).film;
        for aa in ["none", "grid:2", "grid:3", "grid:4", "adaptive:16", "adaptive:4", "adaptive:1"]
        {
            let rendering = rendered(&scene, mode(aa));
            let error = rmse(&rendering.film, &truth);
            let ratio = rendering.estimated_rmse.expect("an estimate") / error;
            let _ = writeln!(report, "{name:12} {aa:12} {error:7.3} {ratio:6.2}");
            all += 1;
            close += usize::from((1.0 / 1.5..=1.5).contains(&ratio));
            if ratio < 0.5 {
                low.push((name, aa, ratio));
            }
        }
    }
    assert!(low.is_empty(), "{low:?}\n{report}");
    assert!(close * 10 >= all * 9, "{close} of {all}\n{report}");
}

/// A part of a picture is that part of the picture, in every mode.
#[test]
fn a_part_is_that_of_the_whole() {
    let scene = load_builtin("assignment").expect("a scene");
    let tile = whitted::film::Tile { x0: 13, y0: 30, x1: 41, y1: 72 };
    for aa in ["none", "grid:2", "adaptive:4", "adaptive:0,20"] {
        let whole = rendered(&scene, mode(aa)).film;
        let options = RenderOptions {
            size: Some([SIDE; 2]),
            aa: mode(aa),
            crop: Some(tile),
            ..Default::default()
        };
        let part = support::rendering(&scene, &options).film;
        assert_eq!((part.width(), part.height()), (28, 42));
        for (x, y) in (0..42).flat_map(|y| (0..28).map(move |x| (x, y))) {
            assert_eq!(part.pixel(x, y), whole.pixel(x + 13, y + 30), "{aa}: {x}, {y}");
        }
    }
}

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
