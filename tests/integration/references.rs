//! The assignment scene and the spheres against pictures and ray counts of independent programs.

use std::path::Path;

use image::RgbImage;
use whitted::{
    aa::AntiAliasing,
    film::{Difference, encode::to_srgb8, metrics::read_png_rgb8},
    render::{RayCounts, RenderOptions, Rendering},
    scene::load_builtin,
};

use super::support::rendering;

fn assignment(aa: AntiAliasing) -> Rendering {
    let scene = load_builtin("assignment").expect("a built-in scene");
    rendering(&scene, &RenderOptions { aa, ..Default::default() })
}

/// `path` is that of the other picture in the repository.
fn difference(rendering: &Rendering, path: &str) -> Difference {
    let film = &rendering.film;
    let ours = RgbImage::from_raw(film.width(), film.height(), to_srgb8(film))
        .expect("three bytes a pixel");
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    Difference::between(&ours, &read_png_rgb8(path).expect("a reference picture"))
        .expect("equal sizes")
}

/// Panics unless `count` is within 0.1 % of the published one.
fn assert_count(count: u64, published: u64, what: &str) {
    assert!(
        count.abs_diff(published) * 1000 <= published,
        "{what}: {count} instead of {published}"
    );
}

fn assert_counts(rays: &RayCounts, [traced, shadow]: [u64; 2]) {
    assert_count(rays.camera + rays.reflected + rays.refracted + rays.transmitted, traced, "rays");
    assert_count(rays.shadow, shadow, "shadow rays");
}

/// Oracle: POV-Ray's picture, and the counts on which two other programs agree.
#[test]
fn one_ray_per_pixel() {
    let rendering = assignment(AntiAliasing::None);
    let difference = difference(&rendering, "tests/references/assignment-1-ray.png");
    assert!(difference.rmse <= 1.5, "{difference:?}");
    assert!(difference.mean <= 0.1, "{difference:?}");
    assert!(difference.share_over_8 <= 0.005, "{difference:?}");
    assert_counts(&rendering.rays, [450_941, 780_810]);
    assert_eq!(rendering.rays.camera_hit, 360_000); // floor and wall fill the picture
}

/// Oracle: POV-Ray's picture.
#[test]
fn sixteen_rays_per_pixel() {
    let rendering = assignment(AntiAliasing::Grid { side: 4 });
    let to_reference = difference(&rendering, "tests/references/assignment-4x4-rays.png");
    assert!(to_reference.rmse <= 1.5, "{to_reference:?}");
}

/// Oracle: POV-Ray's picture with sixteen rays in each pixel, which is itself off by a level. And the README shows what its first
/// command makes: `whitted render -o docs/pictures/assignment.png` makes its picture again.
#[test]
fn rays_where_the_picture_needs_them() {
    let rendering = assignment(AntiAliasing::default());
    let to_shown = difference(&rendering, "docs/pictures/assignment.png");
    assert!(to_shown.worst.levels <= 1, "{to_shown:?}");
    let to_reference = difference(&rendering, "tests/references/assignment-4x4-rays.png");
    assert!(to_reference.rmse <= 2.0, "{to_reference:?}");
}

/// Oracle: the counts on which two other programs agree.
#[test]
fn four_rays_per_pixel() {
    let rendering = assignment(AntiAliasing::Grid { side: 2 });
    assert_counts(&rendering.rays, [1_803_828, 3_123_555]);
    assert!(rendering.film.samples().iter().all(|&samples| samples == 4));
}

/// Oracle: the description says that level 6 is the deepest reached, and that with 5 hardly a pixel differs.
#[test]
fn level_six_is_the_deepest() {
    let scene = load_builtin("assignment").expect("a built-in scene");
    let at = |depth| {
        let options =
            RenderOptions { aa: AntiAliasing::None, depth: Some(depth), ..Default::default() };
        rendering(&scene, &options)
    };
    let [five, six, seven] = [5, 6, 7].map(at);
    assert_eq!(six.rays, seven.rays);
    assert_eq!(six.film.pixels(), seven.film.pixels());
    let differing =
        five.film.pixels().iter().zip(six.film.pixels()).filter(|(a, b)| a != b).count();
    assert!((1..=20).contains(&differing), "{differing} pixels");
}

/// Oracle: the published counts, which a program that tests every sphere with every ray meets as closely.
#[test]
fn a_thousand_spheres() {
    let scene = load_builtin("spheres").expect("a built-in scene");
    let options = RenderOptions { aa: AntiAliasing::None, ..Default::default() };
    let rays = rendering(&scene, &options).rays;
    let traced = rays.camera + rays.reflected + rays.refracted + rays.transmitted;
    for (count, published) in [(traced, 439_835), (rays.shadow, 593_798_u64)] {
        let off = count.abs_diff(published);
        assert!(off * 100_000 <= published, "{count} instead of {published}");
    }
}
