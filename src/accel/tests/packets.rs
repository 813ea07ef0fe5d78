//! A packet answers what its rays answer one by one.

use std::ops::ControlFlow;

use glam::DVec3;

use super::{
    bits, crossings,
    scenes::{KINDS, Random, awkward, shape_of},
};
use crate::{
    accel::{Accel, Isa},
    geometry::{Hit, Ray, Shape},
};

/// A beam of `count` rays from `origin` around `axis`, so wide at distance 1.
fn beam(random: &mut Random, origin: DVec3, axis: DVec3, width: f64, count: usize) -> Vec<Ray> {
    (0..count).map(|_| Ray::new(origin, axis + random.direction() * width)).collect()
}

/// Checks the packet of `rays`, and that of the rays from where they hit to where they came from.
fn check(name: &str, accel: &Accel, rays: &[Ray]) -> usize {
    let single: Vec<Option<Hit>> =
        rays.iter().map(|ray| accel.nearest(ray, f64::INFINITY)).collect();
    let mut hits = vec![None; rays.len()];
    accel.nearest_packet(rays, &mut hits);
    for (k, (found, expected)) in hits.iter().zip(&single).enumerate() {
        assert_eq!(
            bits(*found),
            bits(*expected),
            "{name}, ray {k} of {}: {:?}",
            rays.len(),
            rays[k]
        );
    }

    let target = rays[0].origin;
    let back: Vec<Ray> = rays
        .iter()
        .zip(&single)
        .filter_map(|(ray, hit)| {
            let hit = hit.as_ref()?;
            let surface = accel.shape(hit.primitive).surface(ray, hit);
            let to_target = target - surface.point;
            let mut back = surface.leave(hit, to_target, to_target.dot(surface.normal) < 0.0);
            back.dir = target - back.origin;
            Some(back)
        })
        .collect();
    for opaque in [|_: u32| false, |number: u32| number.is_multiple_of(5), |_: u32| true] {
        let mut found = vec![Vec::new(); back.len()];
        let mut blocked = vec![false; back.len()];
        let visit = |k: u32, primitive, crossing: crate::geometry::Crossing| {
            found[k as usize].push((primitive, crossing.t.to_bits(), crossing.face));
            ControlFlow::Continue(())
        };
        accel.is_blocked_packet(&back, target, opaque, visit, &mut blocked);
        for (k, ray) in back.iter().enumerate() {
            let expected = accel.is_blocked(ray, 1.0, opaque, |_, _| ControlFlow::Continue(()));
            assert_eq!(blocked[k], expected, "{name}, shadow {k}: {ray:?}");
            if !expected {
                found[k].sort_unstable();
                let all = crossings(|visit| accel.any_crossing(ray, 1.0, visit));
                assert_eq!(found[k], all, "{name}, shadow {k}: {ray:?}");
            }
        }
    }
    back.len()
}

/// Oracle: the single rays, which the other tests compare with brute force.
#[test]
fn packets_agree_with_single_rays() {
    let mut random = Random(64);
    let mut scenes = awkward();
    for count in [1, 7, 8, 9, 65, 1000] {
        let mixed = (0..count).map(|k| {
            let (center, size) = (random.point(), 0.5 / f64::from(count).cbrt());
            shape_of(k as usize % KINDS, center, size, &mut random)
        });
        scenes.push(("mixed", mixed.collect::<Vec<Shape>>()));
    }
    let mut hits = 0;
    for (name, shapes) in &scenes {
        for isa in Isa::ALL.into_iter().filter(|isa| isa.is_available()) {
            let accel = Accel::with_isa(shapes.clone(), isa);
            for width in [1e-9, 1e-3, 0.03, 0.3, 3.0] {
                for count in [1, 8, 13, 64] {
                    for axis in [random.direction(), DVec3::NEG_Z, DVec3::X] {
                        let origin = random.point() - axis * 1.5 * (random.signed() + 1.0);
                        hits += check(name, &accel, &beam(&mut random, origin, axis, width, count));
                    }
                }
            }
        }
    }
    assert!(hits > 5_000, "{hits} rays hit");
}
