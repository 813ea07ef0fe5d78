//! Highlights narrower than a pixel, of which samples beside them show nothing: where spheres have them is known from
//! the scene.

use std::{
    f64::consts::{LN_2, PI},
    ops::ControlFlow,
};

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::{
    hints::{Glint, Marks, samples},
    thin,
};
use crate::{
    camera::View,
    geometry::{Ray, Shape, Sphere},
    light::Light,
    scene::Scene,
};

/// Wider highlights than this, in pixels, are seen by samples beside them.
const WIDEST: f64 = 0.8;
/// Samples in a square as wide as a highlight.
const WITHIN: f64 = 4.0;
/// The least light that a highlight adds to a pixel: a level of 255, if the pixel is black.
const LEAST: f64 = 1.0 / (12.92 * 255.0);
/// How much longer than wide a highlight is taken to be at most.
const LONGEST: f64 = 4.0;
/// Halvings of the angle between eye and light, seen from the centre of a sphere: to less than a thousandth.
const STEPS: usize = 12;

/// Notes the highlights on spheres that are narrower than a pixel, seen by the camera and not in the shadow of anything
/// opaque; returns whether there are any, in the picture or beside it.
pub(super) fn mark_highlights(scene: &Scene, view: &View, marks: &mut Marks) -> bool {
    let of_primitive = |primitive: u32| {
        let Shape::Sphere(sphere) = scene.shape(primitive) else { return Vec::new() };
        let depth = view.depth(sphere.center());
        // Thin spheres are sampled anyway.
        let is_thin = 2.0 * sphere.radius() <= thin::WIDEST * view.pixel() * depth;
        if depth <= -sphere.radius() || is_thin || !(scene.material(primitive).specular > 0.0) {
            return Vec::new();
        }
        let narrow = |light: &Light| {
            let highlight = Highlight::of(scene, view, primitive, sphere, light)?;
            is_seen(scene, view, primitive, highlight.middle, light).then_some(highlight)
        };
        scene.lights().iter().filter_map(narrow).collect()
    };
    let primitives = (0..scene.primitive_count() as u32).into_par_iter();
    // In the order of the primitives, on which sums depend.
    let highlights: Vec<Highlight> = primitives.flat_map_iter(of_primitive).collect();
    for Highlight { ends, reach, glint, .. } in &highlights {
        marks.note(*ends, *reach, |known| known.glint = known.glint.and(*glint));
    }
    !highlights.is_empty()
}

/// A highlight narrower than a pixel.
struct Highlight {
    middle: DVec3,
    /// The ends of its longer axis on the film, less its half width, which is `reach`; in pixels.
    ends: [DVec2; 2],
    reach: f64,
    glint: Glint,
}

impl Highlight {
    /// The highlight of a light on a sphere, if there is one, narrow but bright enough.
    ///
    /// On the way s along the surface the mirror direction turns off the light by 2x, where x is s (1/r + (1/e + 1/l)/2)
    /// with the distances e and l of eye and light, and cosⁿ 2x is about exp(-2nx²). So a highlight is half as bright as
    /// its middle at x = √(ln 2 / 2n). If w is the way there, its light is that of the middle on an area of πw²/ln 2; of
    /// one that is brighter than white, p times, that of white on 1 + ln p times the area. Seen at an angle it is as
    /// much narrower one way as it is longer the other.
    fn of(
        scene: &Scene,
        view: &View,
        primitive: u32,
        sphere: &Sphere,
        light: &Light,
    ) -> Option<Self> {
        let material = scene.material(primitive);
        let (middle, cosine) = mirror_point(sphere, view.eye(), light.position)?;
        let [to_eye, to_light] = [view.eye(), light.position].map(|from| from - middle);
        let bend = 1.0 / sphere.radius()
            + f64::midpoint(to_eye.length().recip(), to_light.length().recip());
        let half_width = (LN_2 / (2.0 * material.shininess)).sqrt() / bend;
        let (_, pixel) = view.place(middle)?;
        let reach = half_width / pixel;
        let peak = f64::from(material.specular * light.intensity.max_element());
        let brightest = if peak > 1.0 { 1.0 + peak.ln() } else { peak };
        let added = brightest * PI / LN_2 * reach * reach;
        if !(2.0 * reach <= WIDEST && added >= LEAST) {
            return None;
        }
        let across = to_eye.cross(to_light).normalize_or_zero();
        let longer = across * (half_width * ((1.0 / cosine).min(LONGEST) - 1.0));
        let (from, _) = view.place(middle - longer)?;
        let (to, _) = view.place(middle + longer)?;
        let glint = Glint { light: added as f32, samples: samples(WITHIN / (4.0 * reach * reach)) };
        Some(Self { middle, ends: [from, to], reach, glint })
    }
}

/// The point of a sphere that mirrors a light to the eye, and the cosine of the angle there; none if there is no such
/// point, as when one of them is inside.
///
/// It is between the two, where both are seen at the same angle to the normal: halving finds it.
fn mirror_point(sphere: &Sphere, eye: DVec3, light: DVec3) -> Option<(DVec3, f64)> {
    let (center, radius) = (sphere.center(), sphere.radius());
    if [eye, light].iter().any(|point| point.distance(center) <= radius) {
        return None;
    }
    let [mut on_side_of_eye, mut on_side_of_light] =
        [eye, light].map(|point| (point - center).normalize());
    let (mut middle, mut cosine) = (center, 0.0);
    for _ in 0..STEPS {
        let normal = (on_side_of_eye + on_side_of_light).try_normalize()?;
        middle = center + normal * radius;
        let [of_eye, of_light] = [eye, light].map(|point| normal.dot((point - middle).normalize()));
        if of_eye > of_light {
            on_side_of_eye = normal;
        } else {
            on_side_of_light = normal;
        }
        cosine = of_eye.min(of_light);
    }
    (cosine > 0.0).then_some((middle, cosine))
}

/// Whether the eye sees a point of a primitive, and nothing opaque is between that and a light.
fn is_seen(scene: &Scene, view: &View, primitive: u32, point: DVec3, light: &Light) -> bool {
    let ray = Ray::new(view.eye(), (point - view.eye()).normalize());
    let hit = scene.accel().nearest(&ray, f64::INFINITY);
    hit.filter(|hit| hit.primitive == primitive).is_some_and(|hit| {
        let surface = scene.surface(&ray, &hit);
        let ray = surface.leave(&hit, light.position - surface.beside(false), false);
        let opaque = |primitive| scene.is_opaque(primitive);
        !scene.accel().is_blocked(&ray, 1.0, opaque, |_, _| ControlFlow::Continue(()))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::random::SplitMix64;

    /// Oracle: the law of reflection, for lights and eyes near and far, on one side or on both.
    #[test]
    fn mirror_points_send_lights_to_the_eye() {
        let mut random = SplitMix64::new(8);
        let mut point =
            |far: f64| DVec3::from_array(std::array::from_fn(|_| random.uniform() - 0.5)) * far;
        let (mut found, mut opposite) = (0, 0);
        for k in 0..600 {
            let (center, far) = (point(1.0), if k % 2 == 0 { 40.0 } else { 3.0 });
            let (eye, light) = (center + point(far), center + point(far));
            let sphere = Sphere::try_new(center, 0.3).expect("a sphere");
            if eye.distance(center).min(light.distance(center)) < 0.31 {
                continue;
            }
            let Some((middle, cosine)) = mirror_point(&sphere, eye, light) else {
                // Then the two do not see the same side: between them there is no point that both see.
                let (a, b) = ((eye - center).normalize(), (light - center).normalize());
                let sees = |p: DVec3, n: DVec3| n.dot(p - center) > 0.3;
                let both = (0..=100).any(|k| {
                    let n = a.lerp(b, f64::from(k) / 100.0).normalize();
                    sees(eye, n) && sees(light, n)
                });
                assert!(!both, "{eye} {light}");
                opposite += 1;
                continue;
            };
            found += 1;
            let (normal, dir) = ((middle - center) / 0.3, (middle - eye).normalize());
            let mirrored = dir - normal * 2.0 * dir.dot(normal);
            let off = mirrored.angle_between(light - middle);
            assert!((normal.length() - 1.0).abs() < 1e-12 && off < 0.05, "{eye} {light}: {off}");
            assert!((cosine + dir.dot(normal)).abs() < 0.05, "{eye} {light}: {cosine}");
        }
        assert!(found > 300 && opposite > 5, "{found} {opposite}");
        let sphere = Sphere::try_new(DVec3::ZERO, 1.0).expect("a sphere");
        for (eye, light) in [(0.5, 9.0), (9.0, 0.5), (9.0, -9.0)] {
            assert_eq!(mirror_point(&sphere, DVec3::Z * eye, DVec3::Z * light), None);
        }
    }
}
