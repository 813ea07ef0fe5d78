//! What stands between hits and a light.

use std::ops::ControlFlow;

use glam::DVec3;

use super::signature::{hash, light_word};
use crate::{
    color::Rgb,
    geometry::{Crossing, lanes::RayLanes},
    light::Light,
    scene::Scene,
};

/// The transmissive surfaces that shadow rays cross.
#[derive(Debug, Default)]
pub(super) struct Passed {
    /// The lane, the distance, the primitive.
    crossings: Vec<(usize, f64, u32)>,
    /// The lanes that have any.
    lanes: u64,
}

impl Passed {
    /// The lanes whose rays cross any.
    pub(super) fn lanes(&self) -> u64 {
        self.lanes
    }

    /// What arrives of a light in a lane: its intensity times the transmissions of all surfaces crossed, without
    /// refraction; and what stands for it in signatures. `None` if nothing does.
    #[inline(always)]
    pub(super) fn arriving(&self, scene: &Scene, light: &Light, lane: usize) -> Option<(Rgb, u32)> {
        let first = self.crossings.partition_point(|crossing| crossing.0 < lane);
        let own = self.crossings[first..].iter().take_while(|crossing| crossing.0 == lane);
        let (transmittance, passed) =
            own.fold((Rgb::ONE, 0_u32), |(transmittance, passed), (_, _, primitive)| {
                let transmission = scene.material(*primitive).transmission;
                (transmittance * transmission, passed.wrapping_add(hash(primitive + 1)))
            });
        let arrives = transmittance != Rgb::ZERO;
        arrives.then(|| (light.intensity * transmittance, light_word(light, passed)))
    }
}

/// The lanes whose rays, which have the light at `target` at `t = 1`, meet anything opaque; `passed` gets what those
/// that do not cross, in the order of lanes and distances.
#[inline(always)]
pub(super) fn cast(scene: &Scene, rays: &RayLanes, target: DVec3, passed: &mut Passed) -> u64 {
    let Passed { crossings, lanes } = passed;
    crossings.clear();
    *lanes = 0;
    let opaque = |primitive| scene.is_opaque(primitive);
    let visit = |lane: usize, primitive, crossing: Crossing| {
        *lanes |= 1 << lane;
        crossings.push((lane, crossing.t, primitive));
        ControlFlow::Continue(())
    };
    let blocked = scene.accel().blocked_packet(rays, target, opaque, visit);
    // A product rounds differently in another order, and the tree's order is not the scene's.
    if !crossings.is_empty() {
        crossings
            .sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)));
    }
    blocked
}
