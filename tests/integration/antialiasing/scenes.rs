//! Scenes against converged pictures: is what a render says of its error true? Some of these scenes were never looked at when
//! the constants of the estimate were chosen.

use std::fmt::Write;

use whitted::{
    aa::{AntiAliasing, levels::levels},
    film::Film,
    render::{RenderOptions, Rendering},
    scene::{Scene, load_builtin, load_builtin_of},
};

use super::{super::support, mode};

pub(super) const SIDE: u32 = 72;

pub(super) fn rendered(scene: &Scene, aa: AntiAliasing) -> Rendering {
    support::rendering(scene, &RenderOptions { size: Some([SIDE; 2]), aa, ..Default::default() })
}

pub(super) fn rmse(a: &Film, b: &Film) -> f64 {
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

/// Oracle: 256 rays in each pixel, at places of which the modes use sixteen at most. Half of the truth is the least that
/// may be said, twice the most, and within one and a half times is what most must be.
#[test]
fn what_is_said_of_the_error_is_true() {
    let scenes = [
        ("assignment", load_builtin("assignment").expect("a scene")),
        ("spheres", load_builtin_of("spheres", Some(300)).expect("a scene")),
        ("texture", texture()),
        ("triangles", triangles()),
    ];
    let (mut all, mut close, mut far) = (0, 0, Vec::new());
    let mut report = String::new();
    for (name, scene) in scenes {
        let truth = rendered(&scene, mode("sobol:256")).film;
        for aa in [
            "none",
            "grid:2",
            "grid:3",
            "grid:4",
            "adaptive:16",
            "adaptive:4",
            "adaptive:1",
            "sobol:1",
            "sobol:2",
            "sobol:4",
            "sobol:16",
        ] {
            let rendering = rendered(&scene, mode(aa));
            let error = rmse(&rendering.film, &truth);
            let ratio = rendering.estimated_rmse.expect("an estimate") / error;
            let _ = writeln!(report, "{name:12} {aa:12} {error:7.3} {ratio:6.2}");
            all += 1;
            close += usize::from((1.0 / 1.5..=1.5).contains(&ratio));
            if !(0.5..=2.0).contains(&ratio) {
                far.push((name, aa, ratio));
            }
        }
    }
    assert!(far.is_empty(), "{far:?}\n{report}");
    assert!(close * 10 >= all * 9, "{close} of {all}\n{report}");
}

/// A part of a picture is that part of the picture, in every mode; also of things so many that what is sampled together
/// depends on how much there is to sample.
#[test]
fn a_part_is_that_of_the_whole() {
    let tile = whitted::film::Tile { x0: 13, y0: 30, x1: 41, y1: 72 };
    let modes = ["none", "grid:2", "adaptive:4", "adaptive:0,20"];
    let scenes = [("assignment", None), ("spheres", Some(10_000))];
    for ((name, objects), aa) in scenes.into_iter().flat_map(|scene| modes.map(|aa| (scene, aa))) {
        let scene = load_builtin_of(name, objects).expect("a scene");
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
            assert_eq!(part.pixel(x, y), whole.pixel(x + 13, y + 30), "{name} {aa}: {x}, {y}");
        }
    }
}
