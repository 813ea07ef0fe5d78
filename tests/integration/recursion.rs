//! How deep the recursion goes.

use whitted::{
    aa::AntiAliasing,
    render::{RayCounts, RenderOptions},
};

use super::support::{rendering, scene};

/// The rays of one pixel that looks into the nearer of two parallel mirrors.
fn between_mirrors(reflection: f64, depth: u32, cutoff: f64) -> RayCounts {
    let scene = scene(&format!(
        r#"
        resolution = [1, 1]
        depth = {depth}
        cutoff = {cutoff}
        background = [0, 0, 0]
        camera = {{ eye = [0, 0, 0], look_at = [0, 0, -1], up = [0, 1, 0], vertical_fov = 1 }}
        material.mirror = {{ reflection = {reflection} }}
        [[object]]
        material = "mirror"
        shape.quad = {{ corner = [-1, -1, -3], edges = [[2, 0, 0], [0, 2, 0]] }}
        [[object]]
        material = "mirror"
        shape.quad = {{ corner = [-1, -1, 4], edges = [[0, 2, 0], [2, 0, 0]] }}
        "#
    ));
    rendering(&scene, &RenderOptions { aa: AntiAliasing::None, ..Default::default() }).rays
}

/// Oracle: the ray meets a mirror at every level, so level n is reached by n − 1 reflections; a recursion that used the call
/// stack would overflow it.
#[test]
fn a_hundred_thousand_bounces_end() {
    assert_eq!(between_mirrors(1.0, 100_000, 0.0).reflected, 99_999);
}

/// Oracle: 0.5^6 = 0.0156 is above a cut-off of 0.01, 0.5^7 is below.
#[test]
fn a_cutoff_drops_what_counts_too_little() {
    assert_eq!(between_mirrors(0.5, 100, 0.01).reflected, 6);
    assert_eq!(between_mirrors(0.5, 100, 0.0).reflected, 99);
}
