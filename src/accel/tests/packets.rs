//! A packet answers what its rays answer one by one.

use std::ops::ControlFlow;

use glam::{DVec2, DVec3, Vec3};

use super::{
    bits, crossings,
    scenes::{KINDS, Random, awkward, quad, shape_of, sphere},
};
use crate::{
    accel::{
        Accel, Isa,
        packet::{BlockedPacket, NearestPacket},
    },
    geometry::{
        Crossing, Hit, Ray, Shape, Surface,
        lanes::{Departures, HitLanes, LANES, MetLanes, RayLanes, SurfaceLanes, Vectors, lanes},
    },
};

/// Lanes, spread over all there are as far as that is possible, for so many rays.
fn spread(count: usize) -> Vec<usize> {
    (0..count).map(|k| k * (LANES / count) + (k * 5) % (LANES / count)).collect()
}

fn bits_of(used: &[usize]) -> u64 {
    used.iter().fold(0, |all, lane| all | 1 << lane)
}

/// A beam of `count` rays from `origin` around `axis`, so wide at distance 1.
fn beam(random: &mut Random, origin: DVec3, axis: DVec3, width: f64, count: usize) -> Vec<Ray> {
    (0..count).map(|_| Ray::new(origin, axis + random.direction() * width)).collect()
}

/// Checks the packet of `rays`, and that of the rays from where they hit to where they came from.
fn check(name: &str, accel: &Accel, rays: &[Ray]) -> usize {
    let single: Vec<Option<Hit>> =
        rays.iter().map(|ray| accel.nearest(ray, f64::INFINITY)).collect();
    let used = spread(rays.len());
    // What is in the other lanes must not matter.
    let mut nothing = Vectors::ZERO;
    (0..LANES).for_each(|k| nothing.set(k, DVec3::splat([f64::NAN, 1e300, 0.0, -1.0][k % 4])));
    let (mut origin, mut dir) = (nothing.clone(), nothing.clone());
    for (lane, ray) in used.iter().zip(rays) {
        origin.set(*lane, ray.origin);
        dir.set(*lane, ray.dir);
    }
    let mut hits = HitLanes::NONE;
    let rays_out = RayLanes { origin: &origin, dir: &dir, from: None, used: bits_of(&used) };
    accel.nearest_packet(&rays_out, &mut hits);
    assert_eq!(hits.found() & !bits_of(&used), 0, "{name}: a hit of no ray");
    for (k, (lane, expected)) in used.iter().zip(&single).enumerate() {
        let found = (hits.t[*lane] < f64::INFINITY).then(|| hits.get(*lane));
        assert_eq!(
            bits(found),
            bits(*expected),
            "{name}, ray {k} of {}: {:?}",
            rays.len(),
            rays[k]
        );
    }

    let target = rays[0].origin;
    let (mut start, mut way) = (nothing.clone(), nothing);
    let (mut hits, mut surfaces) = (HitLanes::NONE, SurfaceLanes::NONE);
    let mut back: Vec<(usize, Ray)> = Vec::new();
    for (lane, (ray, hit)) in used.iter().zip(rays.iter().zip(&single)) {
        let Some(hit) = hit else { continue };
        let shape = accel.shape(hit.primitive);
        let surface: Surface = shape.surface(ray, hit);
        let inside = surface.is_met_from_inside(ray.dir);
        let mut leaving = surface.leave(hit, target - surface.point, inside);
        leaving.dir = target - leaving.origin;
        hits.set(*lane, hit);
        surfaces.set(*lane, shape, &surface, ray.dir);
        start.set(*lane, leaving.origin);
        way.set(*lane, leaving.dir);
        back.push((*lane, leaving));
    }
    check_surfaces(accel, &rays_out, &hits, &surfaces);
    let from = Some(Departures { hits: &hits, surfaces: &surfaces });
    let asked = back.iter().fold(0, |all, (lane, _)| all | 1 << lane);
    let rays_back = RayLanes { origin: &start, dir: &way, from, used: asked };
    for opaque in [|_: u32| false, |number: u32| number.is_multiple_of(5), |_: u32| true] {
        let mut found = vec![Vec::new(); LANES];
        let visit = |lane: usize, primitive, crossing: Crossing| {
            found[lane].push((primitive, crossing.t.to_bits(), crossing.face));
            ControlFlow::Continue(())
        };
        let blocked = accel.blocked_packet(&rays_back, target, opaque, visit);
        assert_eq!(blocked & !asked, 0, "{name}: a shadow of no ray");
        for (lane, ray) in &back {
            let expected = accel.is_blocked(ray, 1.0, opaque, |_, _| ControlFlow::Continue(()));
            assert_eq!(blocked >> lane & 1 != 0, expected, "{name}, shadow {lane}: {ray:?}");
            if !expected {
                found[*lane].sort_unstable();
                let all = crossings(|visit| accel.any_crossing(ray, 1.0, visit));
                assert_eq!(found[*lane], all, "{name}, shadow {lane}: {ray:?}");
            }
        }
    }
    back.len()
}

/// Checks that surfaces found in lanes are those found one by one.
fn check_surfaces(accel: &Accel, rays: &RayLanes, hits: &HitLanes, expected: &SurfaceLanes) {
    let mut open = rays.used & hits.found();
    // What other surfaces have left in the lanes must not matter.
    let left = (Vec3::splat(f32::NAN), DVec2::splat(f64::NAN));
    let mut found =
        SurfaceLanes { tint: [left.0; LANES], uv: [left.1; LANES], ..SurfaceLanes::NONE };
    while open != 0 {
        let shape = accel.shape(hits.primitive[open.trailing_zeros() as usize]);
        let same = hits.alike(open);
        open &= !same;
        let (origin, dir) = (rays.origin.clone(), rays.dir.clone());
        let met = MetLanes { origin, rest: Vectors::ZERO, dir, t: hits.t };
        if shape.surface_lanes(&met, same, true, &mut found) {
            for k in lanes(same) {
                let bits = |all: &SurfaceLanes| {
                    let vectors = [&all.point, &all.local, &all.facing, &all.start];
                    (
                        vectors.map(|v| v.get(k).to_array().map(f64::to_bits)),
                        all.uv[k].to_array().map(f64::to_bits),
                        all.tint[k].to_array().map(f32::to_bits),
                        all.is_inside(k),
                    )
                };
                assert_eq!(bits(&found), bits(expected), "{shape:?}: {:?}", rays.ray(k));
            }
        }
    }
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

/// Oracle: the single rays. Packets from afar must be traced as such, though some of their rays pass the scene by, and
/// so must the shadows that end there.
#[test]
fn packets_from_afar_agree_with_single_rays() {
    let mut random = Random(4096);
    let mut scenes = awkward();
    for count in [1, 9, 1000] {
        let mixed = (0..count).map(|k| {
            let (center, size) = (random.point(), 0.5 / f64::from(count).cbrt());
            shape_of(k as usize % KINDS, center, size, &mut random)
        });
        scenes.push(("mixed", mixed.collect::<Vec<Shape>>()));
        // A floor outside the tree, on which shadow rays start from afar.
        let low = DVec3::splat(-1e5).with_y(-3.0);
        let floor = quad(low, DVec3::Z * 2e5, DVec3::X * 2e5);
        let balls = (0..count).map(|_| sphere(random.point(), 0.5 / f64::from(count).cbrt()));
        scenes.push(("floor", balls.chain([floor]).collect()));
    }
    let (mut hits, mut whole, mut asked) = (0, 0, 0);
    for (name, shapes) in &scenes {
        for isa in Isa::ALL.into_iter().filter(|isa| isa.is_available()) {
            let accel = Accel::with_isa(shapes.clone(), isa);
            let (center, size) = (accel.bounds().center(), accel.bounds().size());
            let size = if *name == "floor" { 2.0 } else { size };
            for distance in [1.1, 3.0, 30.0, 1e4, 1e9] {
                // The widest passes by on all sides.
                for width in [1e-3, 0.03, 0.1, 2.0] {
                    for axis in [random.direction(), DVec3::NEG_Z, DVec3::new(1.0, 1e-3, 0.0)] {
                        let center = if *name == "floor" { DVec3::ZERO } else { center };
                        let goal = center + random.point() * (size / 4.0);
                        let origin = goal - axis * (distance * size);
                        let rays = beam(&mut random, origin, axis, width / distance, 64);
                        hits += check(name, &accel, &rays);
                        if accel.tree.is_some() && width < 0.1 && distance < 1e5 {
                            asked += 1;
                            whole += usize::from(is_traced_whole(&accel, &rays));
                        }
                    }
                }
            }
        }
    }
    assert!(hits > 20_000, "{hits} rays hit");
    assert!(whole * 10 > asked * 9, "{whole} of {asked} packets were traced as packets");
}

/// Oracle: the single rays. Shadow rays that keep together in four places are traced in parts, all of them.
#[test]
fn wide_shadows_are_traced_in_parts() {
    let mut random = Random(4);
    let balls = (0..1000).map(|_| sphere(random.point(), 0.05));
    let accel = Accel::build(balls.collect());
    let target = DVec3::new(0.1, -0.2, 3.0);
    let corners = [(-0.6, -0.6), (-0.6, 0.6), (0.6, -0.6), (0.6, 0.6)];
    let (mut origin, mut dir) = (Vectors::ZERO, Vectors::ZERO);
    for k in 0..LANES {
        let (x, y) = corners[k % 4];
        let start = DVec3::new(x, y, -2.0) + random.direction() * 0.05;
        origin.set(k, start);
        dir.set(k, target - start);
    }
    let rays = &RayLanes { origin: &origin, dir: &dir, from: None, used: u64::MAX };
    let go_on = |_: usize, _: u32, _: Crossing| ControlFlow::Continue(());
    let (opaque, visit) = (&|_: u32| true, &mut { go_on });
    let (blocked, alone) =
        accel.instructions.run(BlockedPacket { accel: &accel, rays, target, opaque, visit });
    assert_eq!(alone, 0, "rays by themselves");
    let is_blocked =
        |k: usize| accel.is_blocked(&rays.ray(k), 1.0, opaque, |_, _| ControlFlow::Continue(()));
    let expected = (0..LANES).fold(0, |all, k| all | u64::from(is_blocked(k)) << k);
    assert_eq!(blocked, expected);
    assert!((8..56).contains(&blocked.count_ones()), "{blocked:b}");
}

/// Whether the rays are traced together rather than one by one.
pub(super) fn is_traced_whole(accel: &Accel, all: &[Ray]) -> bool {
    let (mut origin, mut dir, mut hits) = (Vectors::ZERO, Vectors::ZERO, HitLanes::NONE);
    for (k, ray) in all.iter().enumerate() {
        origin.set(k, ray.origin);
        dir.set(k, ray.dir);
    }
    let rays = &RayLanes { origin: &origin, dir: &dir, from: None, used: u64::MAX };
    accel.instructions.run(NearestPacket { accel, rays, hits: &mut hits })
}
