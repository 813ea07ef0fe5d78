//! Highlights narrower than a pixel, of which samples beside them show nothing: where spheres have them is known from the
//! scene.

use std::f64::consts::{LN_2, PI};

use glam::DVec3;

use super::foretold::{Glint, Marks, samples};
use crate::{
    camera::View,
    geometry::{Shape, Sphere},
    scene::Scene,
};

/// Wider highlights than this, in pixels, are seen by samples beside them.
const WIDEST: f64 = 0.8;
/// Samples in a square as wide as a highlight.
const WITHIN: f64 = 4.0;
/// The least light, in the brightest channel, that a highlight adds to a pixel: a level of 255.
const LEAST: f32 = 1.0 / 255.0;
/// Steps towards the point of a sphere that mirrors a light to the eye; each mends all but about r/d of what is left,
/// for a radius r and the distance d of the nearer of the two.
const STEPS: usize = 6;

/// Notes the highlights of all lights on all spheres that are narrower than a pixel, hidden, in shadow, or not.
///
/// Where the normal is x off the direction half way between eye and light, the mirror direction is 2x off the light,
/// and cosⁿ 2x is about exp(-2nx²). So a highlight is half as bright as its middle at x = √(ln 2 / 2n), which is the
/// distance w on the film, and its light is that of the middle on an area of πw²/ln 2. Seen at an angle it is as much
/// narrower one way as it is longer the other.
///
/// Returns whether there are any, in the picture or beside it.
pub(super) fn mark_highlights(scene: &Scene, view: &View, marks: &mut Marks) -> bool {
    let mut has_any = false;
    for primitive in 0..scene.primitive_count() as u32 {
        let material = scene.material(primitive);
        let Shape::Sphere(sphere) = scene.shape(primitive) else { continue };
        if !(material.specular > 0.0) {
            continue;
        }
        let half_width = sphere.radius() * (LN_2 / (2.0 * material.shininess)).sqrt();
        for light in scene.lights() {
            let middle = mirror_point(sphere, view.eye(), light.position);
            let Some((place, pixel)) = middle.and_then(|middle| view.place(middle)) else {
                continue;
            };
            let (reach, peak) =
                (half_width / pixel, material.specular * light.intensity.max_element());
            let glint = Glint {
                light: peak * (PI / LN_2 * reach * reach) as f32,
                samples: samples(WITHIN / (4.0 * reach * reach)),
            };
            if 2.0 * reach <= WIDEST && glint.light >= LEAST {
                marks.note([place; 2], reach, |known| known.glint = known.glint.and(glint));
                has_any = true;
            }
        }
    }
    has_any
}

/// The point of a sphere where the normal is half way between the directions to the eye and to a light, which is where
/// it mirrors one to the other; none if one of them is inside.
fn mirror_point(sphere: &Sphere, eye: DVec3, light: DVec3) -> Option<DVec3> {
    let (center, radius) = (sphere.center(), sphere.radius());
    if [eye, light].iter().any(|point| point.distance(center) <= radius) {
        return None;
    }
    let half_way =
        |from: DVec3| ((eye - from).normalize() + (light - from).normalize()).try_normalize();
    (0..STEPS).try_fold(center, |point, _| Some(center + half_way(point)? * radius))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::random::SplitMix64;

    /// Oracle: the law of reflection.
    #[test]
    fn mirror_points_send_lights_to_the_eye() {
        let mut random = SplitMix64::new(8);
        let mut point = || DVec3::from_array(std::array::from_fn(|_| random.uniform() - 0.5));
        for _ in 0..200 {
            let (center, eye, light) = (point(), point() * 40.0, point() * 60.0);
            let sphere = Sphere::try_new(center, 0.3).expect("a sphere");
            let at = |point: DVec3| point.distance(center) > 1.5;
            if !(at(eye) && at(light)) {
                continue;
            }
            let middle = mirror_point(&sphere, eye, light).expect("eye and light are outside");
            let (normal, dir) = ((middle - center) / 0.3, (middle - eye).normalize());
            let mirrored = dir - normal * 2.0 * dir.dot(normal);
            let off = mirrored.angle_between(light - middle);
            assert!((normal.length() - 1.0).abs() < 1e-12 && off < 0.02, "{eye} {light}: {off}");
        }
        let sphere = Sphere::try_new(DVec3::ZERO, 1.0).expect("a sphere");
        assert_eq!(mirror_point(&sphere, DVec3::Z * 0.5, DVec3::Z * 9.0), None);
        assert_eq!(mirror_point(&sphere, DVec3::Z * 9.0, DVec3::Z * 0.5), None);
    }
}
