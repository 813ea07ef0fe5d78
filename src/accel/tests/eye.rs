//! Meshes seen from one point: rays through their corners and edges, and points in their planes.

use std::ops::ControlFlow;

use glam::DVec3;

use super::{
    bits,
    packets::is_traced_whole,
    scenes::{Random, triangle},
};
use crate::{
    accel::{Accel, Isa, brute},
    geometry::{
        Ray, Shape,
        lanes::{HitLanes, LANES, RayLanes, Vectors},
    },
};

/// The corners of the triangles of a rough square of about the size 1 in `cells` × `cells` cells, about `center`.
fn rough(cells: usize, height: f64, center: DVec3, random: &mut Random) -> Vec<[DVec3; 3]> {
    let step = 1.0 / cells as f64;
    let heights: Vec<f64> = (0..(cells + 1).pow(2)).map(|_| height * random.signed()).collect();
    let at = |i: usize, j: usize| {
        center
            + DVec3::new(i as f64 * step - 0.5, j as f64 * step - 0.5, heights[i * (cells + 1) + j])
    };
    let cells = (0..cells).flat_map(|i| (0..cells).map(move |j| (i, j)));
    let halves = |(i, j)| {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        [[a, b, c], [a, c, d]]
    };
    cells.flat_map(halves).collect()
}

/// A point to aim at: in a triangle, on an edge, at a corner, or beside those by very little.
fn goal([a, b, c]: [DVec3; 3], random: &mut Random) -> DVec3 {
    let beside = random.direction() * [0.0, 1e-12, 1e-8, 1e-6, 1e-4][random.below(5)];
    let (u, v) = (random.signed().abs(), random.signed().abs());
    beside
        + match random.below(3) {
            0 => a + ((b - a) * u + (c - a) * v) * 0.5,
            1 => a + (b - a) * u,
            _ => c,
        }
}

/// Where to look from at a mesh about `center`: near it, in the plane of a triangle, at a corner, and from further and
/// further away.
fn eyes(mesh: &[[DVec3; 3]], center: DVec3, random: &mut Random) -> Vec<DVec3> {
    let [a, b, c] = mesh[random.below(mesh.len())];
    let mut eyes = vec![a + (b - a) * 30.0 + (c - a) * 20.0, a, (a + b + c) / 3.0];
    for distance in [0.01, 1.0, 2.0, 4.0, 7.9, 8.1, 15.0, 40.0, 1e4] {
        eyes.push(center + random.direction() * distance);
    }
    eyes
}

/// Asserts that the packet of rays from `eye` to `goals` finds what each ray meets first, and which are blocked on their way back.
pub(super) fn check(
    name: &str,
    shapes: &[Shape],
    accel: &Accel,
    eye: DVec3,
    goals: &[DVec3; LANES],
) -> bool {
    let (mut origin, mut dir, mut hits) = (Vectors::ZERO, Vectors::ZERO, HitLanes::NONE);
    let (mut start, mut way) = (Vectors::ZERO, Vectors::ZERO);
    let rays: Vec<Ray> = goals.iter().map(|goal| Ray::new(eye, goal - eye)).collect();
    // From beyond the goal, in one unit, to the eye.
    let back: Vec<Ray> = goals
        .iter()
        .map(|goal| {
            let start = eye + (goal - eye) * 1.25;
            Ray::new(start, eye - start)
        })
        .collect();
    for k in 0..LANES {
        origin.set(k, eye);
        dir.set(k, rays[k].dir);
        start.set(k, back[k].origin);
        way.set(k, back[k].dir);
    }
    let used = u64::MAX;
    accel.nearest_packet(&RayLanes { origin: &origin, dir: &dir, from: None, used }, &mut hits);
    for (k, ray) in rays.iter().enumerate() {
        let found = (hits.t[k] < f64::INFINITY).then(|| hits.get(k));
        let expected = brute::nearest(shapes, ray, f64::INFINITY);
        assert_eq!(bits(found), bits(expected), "{name} from {eye}: {ray:?}");
    }
    let stop = |_, _, _| ControlFlow::Break(());
    let back_lanes = RayLanes { origin: &start, dir: &way, from: None, used };
    for opaque in [true, false] {
        let blocked = accel.blocked_packet(&back_lanes, eye, |_| opaque, stop);
        for (k, ray) in back.iter().enumerate() {
            let expected = brute::any_crossing(shapes, ray, 1.0, |_, _| ControlFlow::Break(()));
            assert_eq!(blocked >> k & 1 != 0, expected, "{name} to {eye}: {ray:?}");
        }
    }
    is_traced_whole(accel, &rays)
}

/// Oracle: brute force in double precision.
#[test]
fn meshes_seen_from_a_point_are_those_of_brute_force() {
    let mut random = Random(2026);
    let (mut whole, mut all) = (0, 0);
    for (name, cells, height, center) in [
        ("flat", 16, 0.0, DVec3::ZERO),
        ("rough", 16, 0.03, DVec3::new(0.3, -0.2, 0.1)),
        ("spiky", 12, 0.2, DVec3::ZERO),
        ("far from the origin", 12, 0.05, DVec3::new(1e6, -3e6, 2e6)),
        ("one cell", 1, 0.2, DVec3::ZERO),
    ] {
        let mesh = rough(cells, height, center, &mut random);
        let shapes: Vec<Shape> = mesh.iter().map(|corners| triangle(*corners)).collect();
        for isa in Isa::ALL.into_iter().filter(|isa| isa.is_available()) {
            let accel = Accel::with_isa(shapes.clone(), isa);
            let eyes: Vec<DVec3> = (0..4).flat_map(|_| eyes(&mesh, center, &mut random)).collect();
            for eye in eyes {
                // A narrow beam: what is near one of the corners.
                let [middle, ..] = mesh[random.below(mesh.len())];
                let reach = 0.02 * (middle - eye).length();
                let near = |corners: &&[DVec3; 3]| (corners[0] - middle).length() < reach;
                let near: Vec<[DVec3; 3]> = mesh.iter().filter(near).copied().collect();
                if near.is_empty() {
                    continue;
                }
                let goals: [DVec3; LANES] =
                    std::array::from_fn(|_| goal(near[random.below(near.len())], &mut random));
                whole += usize::from(check(name, &shapes, &accel, eye, &goals));
                all += 1;
            }
        }
    }
    assert!(whole * 5 > all, "{whole} of {all} packets were traced as packets");
}
