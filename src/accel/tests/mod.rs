//! Every answer is that of the brute-force reference, to the bit, with any instructions.

mod edge_on;
mod eye;
mod lanes;
mod packets;
pub(super) mod pictures;
mod scenes;

use std::ops::ControlFlow;

use glam::DVec3;

use super::{
    Accel, Isa, MAX_DEPTH, Preset, brute,
    node::{Child, Content},
};
use crate::geometry::{Bounds, Crossing, Hit, Ray, Shape};
use scenes::{KINDS, Random, shape_of};

/// All crossings, in an order that does not depend on the search.
fn crossings(
    any: impl FnOnce(&mut dyn FnMut(u32, Crossing) -> ControlFlow<()>) -> bool,
) -> Vec<(u32, u64, u8)> {
    let mut found = Vec::new();
    let stopped = any(&mut |primitive, crossing| {
        found.push((primitive, crossing.t.to_bits(), crossing.face));
        ControlFlow::Continue(())
    });
    assert!(!stopped);
    found.sort_unstable();
    found
}

fn bits(hit: Option<Hit>) -> Option<(u64, u32, u8)> {
    hit.map(|h| (h.t.to_bits(), h.primitive, h.face))
}

/// Asserts that `rays` find what the reference finds; returns how many hit anything.
fn check(name: &str, shapes: &[Shape], rays: &[Ray]) -> usize {
    let mut hits = 0;
    for isa in Isa::ALL.into_iter().filter(|isa| isa.is_available()) {
        let accel = Accel::with_isa(shapes.to_vec(), isa);
        assert_eq!(accel.isa(), isa);
        hits += check_built(name, &accel, shapes, rays);
    }
    hits
}

/// The same of one arrangement of `shapes`.
fn check_built(name: &str, accel: &Accel, shapes: &[Shape], rays: &[Ray]) -> usize {
    let (mut hits, isa) = (0, accel.isa());
    assert_eq!(accel.len(), shapes.len());
    for (k, ray) in rays.iter().enumerate() {
        let expected = brute::nearest(shapes, ray, f64::INFINITY);
        let found = accel.nearest(ray, f64::INFINITY);
        assert_eq!(bits(found), bits(expected), "{name}, {isa:?}, ray {k}: {ray:?}");
        hits += usize::from(expected.is_some());
        let middle = expected.map_or(1.0, |hit| hit.t);
        for end in [middle, middle.next_up(), middle * 1.5, f64::INFINITY] {
            let found = accel.nearest(ray, end);
            let expected = brute::nearest(shapes, ray, end);
            assert_eq!(bits(found), bits(expected), "{name}, {isa:?}, ray {k} to {end}");
            let found = crossings(|visit| accel.any_crossing(ray, end, visit));
            let expected = crossings(|visit| brute::any_crossing(shapes, ray, end, visit));
            assert_eq!(found, expected, "{name}, {isa:?}, ray {k} to {end}");
            let stops = |n: u32| n % 3 == 1;
            let expected = expected.iter().any(|(n, ..)| stops(*n));
            let blocked = accel.is_blocked(ray, end, stops, |_, _| ControlFlow::Continue(()));
            assert_eq!(blocked, expected, "{name}, {isa:?}, ray {k} to {end}");
        }
    }
    hits
}

/// Rays at and about `shapes`, and from their surfaces.
fn rays(random: &mut Random, shapes: &[Shape], count: usize) -> Vec<Ray> {
    let bounds = shapes.iter().map(Shape::bounds).reduce(Bounds::union);
    let (center, size) = bounds.map_or((DVec3::ZERO, 1.0), |b| (b.center(), b.size()));
    let mut rays = Vec::new();
    for k in 0..count {
        let target = match shapes.get(random.below(shapes.len().max(1))) {
            Some(shape) => {
                let b = shape.bounds();
                b.center() + random.point() * b.extent() * 0.6
            }
            None => random.point(),
        };
        let origin = center + random.point() * size * [0.5, 1.0, 4.0, 1e3, 1e6][k % 5];
        rays.push(Ray::new(origin, (target - origin) * [1.0, 1e-3, 1e9][k % 3]));
        rays.push(axis_ray(random, target, size));
    }
    let mut leaving = Vec::new();
    for ray in &rays {
        if let Some(hit) = brute::nearest(shapes, ray, f64::INFINITY) {
            let surface = shapes[hit.primitive as usize].surface(ray, &hit);
            let dir = random.direction();
            let inward = dir.dot(surface.normal) < 0.0;
            leaving.push(surface.leave(&hit, dir, inward));
        }
    }
    rays.extend(leaving);
    rays
}

/// A ray along an axis, the zeros of its direction of either sign.
fn axis_ray(random: &mut Random, target: DVec3, size: f64) -> Ray {
    let axis = random.below(3);
    let zero = |k: usize| if k == 0 { 0.0 } else { -0.0 };
    let mut dir = DVec3::new(zero(random.below(2)), zero(random.below(2)), zero(random.below(2)));
    dir[axis] = if random.below(2) == 0 { 1.0 } else { -1.0 };
    let mut origin = target;
    origin[axis] -= dir[axis] * size * 2.0;
    Ray::new(origin, dir)
}

#[test]
fn random_scenes_of_every_kind_and_size() {
    for kind in 0..=KINDS {
        for count in [0, 1, 2, 7, 8, 9, 63, 64, 65, 1000] {
            let mut random = Random(1 + count as u64);
            let size = if count > 100 { 0.05 } else { 0.3 };
            let shapes: Vec<Shape> = (0..count)
                .map(|k| {
                    let kind = if kind == KINDS { k % KINDS } else { kind };
                    let center = random.point();
                    shape_of(kind, center, size, &mut random)
                })
                .collect();
            let rays = rays(&mut random, &shapes, if count > 100 { 60 } else { 40 });
            let hits = check(&format!("{count} of kind {kind}"), &shapes, &rays);
            assert!(
                count == 0 || kind == 6 || hits * 10 > rays.len(),
                "{count} of kind {kind}: {hits} hits"
            );
        }
    }
}

#[test]
fn identical_nested_and_flat_scenes() {
    let mut random = Random(5);
    for (name, shapes) in scenes::awkward() {
        let rays = rays(&mut random, &shapes, 60);
        check(name, &shapes, &rays);
    }
}

/// Oracle: the reference; the rays pass spheres at their rim.
#[test]
fn tangent_rays() {
    let mut random = Random(9);
    let shapes: Vec<Shape> = (0..300)
        .map(|k| {
            let center = random.point();
            scenes::sphere(center, [0.1, 0.01, 1e-4][k % 3])
        })
        .collect();
    let mut rays = Vec::new();
    for shape in &shapes {
        let Shape::Sphere(sphere) = shape else { continue };
        for miss in [-1e-3, -1e-6, -1e-9, 0.0, 1e-9, 1e-6, 1e-3] {
            let dir = if random.below(3) == 0 { DVec3::X } else { random.direction() };
            let side = dir.cross(random.direction()).normalize();
            let point = sphere.center() + side * (sphere.radius() * (1.0 + miss));
            rays.push(Ray::new(point - dir * [0.1, 2.0, 1e4][random.below(3)], dir));
        }
    }
    check("tangents", &shapes, &rays);
}

/// Oracle: the reference; from so far that the rounding of the origin alone is larger than a primitive.
#[test]
fn rays_from_far_away() {
    let mut random = Random(11);
    let shapes: Vec<Shape> = (0..200)
        .map(|k| {
            let center = random.point();
            shape_of(k % KINDS, center, 0.1, &mut random)
        })
        .collect();
    for distance in [3.0, 1e3, 1e6, 1e8, 1e9, 1e12, 1e15] {
        let rays: Vec<Ray> = (0..100)
            .map(|k| {
                let dir = if k % 4 == 0 { DVec3::NEG_Z } else { random.direction() };
                Ray::new(random.point() - dir * distance, dir)
            })
            .collect();
        let hits = check(&format!("from {distance:e}"), &shapes, &rays);
        assert!(hits > 20, "from {distance:e}: {hits}");
    }
}

#[test]
fn a_planet_with_pebbles() {
    const R: f64 = 6.4e6;
    let mut random = Random(13);
    let mut shapes = Vec::new();
    for _ in 0..500 {
        let p = random.point() * DVec3::new(1.0, 0.0, 1.0);
        shapes.push(scenes::sphere(p + DVec3::Y * 1e-3, 1e-3));
    }
    let mut rays = rays(&mut random, &shapes, 100);
    shapes.push(scenes::sphere(DVec3::new(0.0, -R, 0.0), R));
    for k in 0..200 {
        let target = random.point() * DVec3::new(1.0, 0.0, 1.0);
        let eye = DVec3::new(0.3, 2.0, 3.0) * [1.0, 1e-2, 1e3, 1e7][k % 4];
        rays.push(Ray::new(eye, target - eye));
    }
    assert!(Accel::build(shapes.clone()).outside().len() == 1, "the planet is not in the tree");
    assert!(check("planet", &shapes, &rays) > 200);
}

#[test]
fn extreme_rays_are_answered() {
    let mut random = Random(17);
    let shapes: Vec<Shape> = (0..50).map(|_| scenes::sphere(random.point(), 0.2)).collect();
    let mut rays = Vec::new();
    for x in [0.0, -0.0, 5e-324, 1e-310, 1e-100, 1e100, 1e308, f64::INFINITY, f64::NAN] {
        rays.push(Ray::new(DVec3::new(0.1, 0.1, -3.0), DVec3::new(0.0, 0.0, x)));
        rays.push(Ray::new(DVec3::new(0.1, x, -3.0), DVec3::new(0.0, 0.0, 1.0)));
        rays.push(Ray::new(DVec3::new(0.1, 0.1, -3.0), DVec3::new(x, 0.1, 1.0)));
    }
    check("extreme", &shapes, &rays);
    let accel = Accel::build(shapes);
    for end in [f64::NAN, -1.0, 0.0, -f64::INFINITY] {
        assert_eq!(accel.nearest(&rays[1], end), None, "to {end}");
    }
}

#[test]
fn numbers_stay_with_their_shapes() {
    let mut random = Random(19);
    let shapes: Vec<Shape> = (0..500)
        .map(|k| {
            let center = random.point();
            shape_of(k % KINDS, center, 0.1, &mut random)
        })
        .collect();
    let accel = Accel::build(shapes.clone());
    for (number, shape) in (0..).zip(&shapes) {
        assert_eq!(accel.shape(number), shape);
    }
}

/// The number of nodes on the longest way down, counted by walking them all.
fn depth(accel: &Accel) -> usize {
    let Some(tree) = &accel.tree else { return 0 };
    let (mut todo, mut deepest) = (vec![(tree.root, 1)], 0);
    while let Some((child, depth)) = todo.pop() {
        if child == Child::NONE {
            continue;
        }
        if let Content::Node(k) = child.content() {
            deepest = deepest.max(depth);
            todo.extend(tree.nodes[k].children.map(|child| (child, depth + 1)));
        }
    }
    deepest
}

/// Oracle: the reference. obvhs alone takes seconds to minutes for these, and makes a tree as deep as there are primitives; here it makes
/// a flat one, which need not be balanced.
#[test]
fn equal_boxes_and_rows_give_flat_trees() {
    for step in [DVec3::ZERO, DVec3::X, DVec3::ONE] {
        let shapes: Vec<Shape> =
            (0..20_000).map(|k| scenes::sphere(step * f64::from(k), 0.5)).collect();
        let accel = Accel::with_depth(shapes.clone(), Preset::Auto, usize::MAX);
        assert_eq!(accel.inside, 20_000);
        assert!((5..=MAX_DEPTH).contains(&depth(&accel)), "{step}: {}", depth(&accel));
        for k in [0, 1, 100, 19_999] {
            let center = step * f64::from(k);
            for dir in [DVec3::Z, DVec3::new(0.1, -0.2, 0.9), DVec3::new(1.0, 1.0, 0.9)] {
                let ray = Ray::new(center - dir * 5.0, dir);
                let expected = brute::nearest(&shapes, &ray, f64::INFINITY);
                assert!(expected.is_some(), "{step}, {k}: {dir}");
                let found = accel.nearest(&ray, f64::INFINITY);
                assert_eq!(bits(found), bits(expected), "{step}, {k}: {dir}");
            }
        }
    }
}

/// Oracle: the reference; a tree that is too deep whatever its depth is replaced by a balanced one.
#[test]
fn the_balanced_tree_finds_the_same() {
    let mut random = Random(23);
    for kinds in [1, KINDS] {
        let shapes: Vec<Shape> = (0..300)
            .map(|k| {
                let center = random.point();
                shape_of(k % kinds, center, 0.1, &mut random)
            })
            .collect();
        let usual = Accel::build(shapes.clone());
        let mut balanced = Accel::with_depth(shapes.clone(), Preset::Auto, 0);
        assert!(balanced.numbers != usual.numbers, "another tree");
        assert!((2..=9).contains(&depth(&balanced)), "depth {}", depth(&balanced));
        let rays = rays(&mut random, &shapes, 100);
        let mut hits = 0;
        for isa in Isa::ALL.into_iter().filter(|isa| isa.is_available()) {
            balanced.set_isa(isa);
            hits += check_built(&format!("balanced, {kinds} kinds"), &balanced, &shapes, &rays);
        }
        assert!(hits * 10 > rays.len(), "{hits} hits");
    }
}
