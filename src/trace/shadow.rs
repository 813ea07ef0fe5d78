//! How much of a light arrives through what stands between.

use std::ops::ControlFlow;

use crate::{color::Rgb, geometry::Ray, scene::Scene};

/// Asks for shadows; each worker has its own.
#[derive(Debug)]
pub(super) struct Shadows<'a> {
    scene: &'a Scene,
    /// The transmissive surfaces on the way, by distance: scratch that is kept from ray to ray.
    passed: Vec<(f64, u32)>,
}

impl<'a> Shadows<'a> {
    pub(super) fn new(scene: &'a Scene) -> Self {
        Self { scene, passed: Vec::new() }
    }

    /// The part of each channel that arrives from a light at `t = 1`: 0 behind anything opaque, and the product of the
    /// transmissions of all surfaces crossed, without refraction.
    pub(super) fn transmittance(&mut self, ray: &Ray) -> Rgb {
        let (scene, passed) = (self.scene, &mut self.passed);
        passed.clear();
        let is_dark = scene.accel().any_crossing(ray, 1.0, |primitive, crossing| {
            if scene.material(primitive).is_transmissive() {
                passed.push((crossing.t, primitive));
                ControlFlow::Continue(())
            } else {
                ControlFlow::Break(())
            }
        });
        if is_dark {
            return Rgb::ZERO;
        }
        // A product rounds differently in another order, and the tree's order is not the scene's.
        passed.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        passed.iter().map(|(_, primitive)| scene.material(*primitive).transmission).product()
    }
}
