//! How much of a light arrives through what stands between.

use std::ops::ControlFlow;

use glam::DVec3;

use super::signature::hash;
use crate::{
    color::Rgb,
    geometry::{Crossing, Ray},
    scene::Scene,
};

/// The question how much of a light arrives at a hit, and the answer.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shadow {
    /// The asker's own number of the hit.
    pub(super) index: u32,
    /// The unit vector to the light, and the cosine of its angle to the normal.
    pub(super) to_light: DVec3,
    pub(super) cosine: f64,
    /// The part of each channel that arrives.
    pub(super) transmittance: Rgb,
    /// A hash of the transmissive surfaces on the way; zero if there are none.
    pub(super) passed: u32,
}

/// Asks for the shadows of a batch of hits; each worker has its own.
#[derive(Debug)]
pub(super) struct Shadows<'a> {
    scene: &'a Scene,
    questions: Vec<Shadow>,
    rays: Vec<Ray>,
    /// The transmissive surfaces on the way of each ray: the ray, the distance, the primitive.
    passed: Vec<(u32, f64, u32)>,
    /// Whether anything opaque is on the way of each ray.
    blocked: Vec<bool>,
}

impl<'a> Shadows<'a> {
    pub(super) fn new(scene: &'a Scene) -> Self {
        Self {
            scene,
            questions: Vec::new(),
            rays: Vec::new(),
            passed: Vec::new(),
            blocked: Vec::new(),
        }
    }

    pub(super) fn clear(&mut self) {
        self.questions.clear();
        self.rays.clear();
        self.passed.clear();
    }

    pub(super) fn len(&self) -> usize {
        self.rays.len()
    }

    /// Adds the question of hit `index`; `ray` has the light at `t = 1`.
    #[inline(always)]
    pub(super) fn push(&mut self, index: u32, ray: Ray, to_light: DVec3, cosine: f64) {
        self.rays.push(ray);
        self.questions.push(Shadow { index, to_light, cosine, transmittance: Rgb::ONE, passed: 0 });
    }

    /// Answers the questions: a transmittance of 0 behind anything opaque, and the product of the transmissions of all
    /// surfaces crossed, without refraction. The rays end in the light at `target`.
    pub(super) fn cast(&mut self, target: DVec3) -> &[Shadow] {
        let Self { scene, questions, rays, passed, blocked } = self;
        blocked.clear();
        blocked.resize(rays.len(), false);
        let opaque = |primitive| !scene.material(primitive).is_transmissive();
        let visit = |index, primitive, crossing: Crossing| {
            passed.push((index, crossing.t, primitive));
            ControlFlow::Continue(())
        };
        scene.accel().is_blocked_packet(rays, target, opaque, visit, blocked);
        for (question, _) in questions.iter_mut().zip(&*blocked).filter(|(_, blocked)| **blocked) {
            question.transmittance = Rgb::ZERO;
        }
        // A product rounds differently in another order, and the tree's order is not the scene's.
        passed.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)));
        for (index, _, primitive) in passed.iter() {
            let shadow = &mut questions[*index as usize];
            shadow.transmittance *= scene.material(*primitive).transmission;
            shadow.passed = shadow.passed.wrapping_add(hash(primitive + 1));
        }
        questions
    }
}
