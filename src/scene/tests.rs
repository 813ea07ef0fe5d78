//! A ray reaches every primitive through the tree, and finds there what trying all of them finds.

use std::ops::ControlFlow;

use glam::DVec3;

use super::load_builtin;
use crate::{
    accel::brute,
    geometry::{Crossing, Ray, Shape},
    math::random::SplitMix64,
};

/// Adds a crossing to a list, bit for bit.
fn note(crossed: &mut Vec<(u32, u8, u64)>, primitive: u32, crossing: Crossing) -> ControlFlow<()> {
    crossed.push((primitive, crossing.face, crossing.t.to_bits()));
    ControlFlow::Continue(())
}

/// Oracle: brute force. Two million questions: the nearest hit of a random ray and, from where it hits or ends, what
/// lies on the way to a light.
#[test]
fn the_tree_of_the_assignment_agrees_with_brute_force() {
    let scene = load_builtin("assignment").expect("a built-in scene");
    let shapes: Vec<Shape> = (0..17).map(|number| scene.shape(number).clone()).collect();
    assert_eq!(scene.primitive_count(), shapes.len());
    let mut random = SplitMix64::new(17);
    let bounds = scene.accel().bounds();
    let mut point =
        || bounds.min + bounds.extent() * DVec3::from_array([0; 3].map(|_| random.uniform()));
    let mut hits = 0;
    for number in 0..1_000_000 {
        let (origin, target) = (point(), point());
        let ray = Ray::new(origin, target - origin);
        let hit = scene.accel().nearest(&ray, f64::INFINITY);
        assert_eq!(hit, brute::nearest(&shapes, &ray, f64::INFINITY), "ray {number}: {ray:?}");

        let light = scene.lights()[number % 2].position;
        let shadow = match hit {
            Some(hit) => {
                hits += 1;
                let surface = scene.surface(&ray, &hit);
                let to_light = light - surface.point;
                surface.leave(&hit, to_light, surface.normal.dot(to_light) < 0.0)
            }
            None => Ray::new(ray.origin, light - ray.origin),
        };
        let (mut by_tree, mut by_all) = (Vec::new(), Vec::new());
        scene.accel().any_crossing(&shadow, 1.0, |primitive, crossing| {
            note(&mut by_tree, primitive, crossing)
        });
        brute::any_crossing(&shapes, &shadow, 1.0, |primitive, crossing| {
            note(&mut by_all, primitive, crossing)
        });
        by_tree.sort_unstable();
        by_all.sort_unstable();
        assert_eq!(by_tree, by_all, "shadow {number}: {shadow:?}");
    }
    assert!((200_000..900_000).contains(&hits), "{hits} rays hit");
}
