//! Rays a second through spheres and through a mesh: from a camera, to a light, and random ones.
//!
//! `traversal/<rays>/<geometry>`, and `traversal/camera_<instructions>/spheres:1e4`; one element is one ray. Before
//! anything is timed, the number of hits is compared with that of an independent program (Embree) on the same geometry
//! and rays. `WHITTED_BENCH_LARGE=1` adds a million spheres and a mesh of a million triangles.

#[allow(dead_code, reason = "shared with the other benches")]
mod stress;

use std::{hint::black_box, ops::ControlFlow};

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use stress::Geometry;
use whitted::{
    accel::{Accel, Isa},
    geometry::Ray,
};

/// A name, what makes the geometry, and how many of the camera's, the shadow and the random rays hit.
type Case = (&'static str, fn() -> Geometry, [usize; 3]);

const SMALL: [Case; 4] = [
    ("spheres:1e3", || stress::spheres(1_000), [203_999, 88_683, 284_067]),
    ("spheres:1e4", || stress::spheres(10_000), [205_346, 82_472, 280_135]),
    ("spheres:1e5", || stress::spheres(100_000), [205_400, 85_051, 278_838]),
    ("icos:1000:1", || stress::icospheres(1_000, 1), [196_056, 83_369, 267_851]),
];

const LARGE: [Case; 2] = [
    ("spheres:1e6", || stress::spheres(1_000_000), [204_957, 84_475, 279_091]),
    ("icos:1000:3", || stress::icospheres(1_000, 3), [203_476, 88_327, 283_011]),
];

fn hits(accel: &Accel, rays: &[Ray]) -> usize {
    rays.iter().filter(|ray| accel.nearest(ray, f64::INFINITY).is_some()).count()
}

fn blocked(accel: &Accel, rays: &[Ray]) -> usize {
    let stop = |_, _| ControlFlow::Break(());
    rays.iter().filter(|ray| accel.is_blocked(ray, 1.0, |_| true, stop)).count()
}

/// Asserts that two counts are equal up to one in `share`.
fn check(name: &str, found: usize, expected: usize, share: usize) {
    let tolerance = expected / share;
    assert!(found.abs_diff(expected) <= tolerance, "{name}: {found} hits instead of {expected}");
}

fn traversal(c: &mut Criterion) {
    let mut group = c.benchmark_group("traversal");
    group.sample_size(10);
    let large = if std::env::var_os("WHITTED_BENCH_LARGE").is_some() { &LARGE[..] } else { &[] };
    for (name, geometry, [camera_hits, shadow_hits, random_hits]) in SMALL.iter().chain(large) {
        let Geometry { shapes, bounds } = geometry();
        let accel = Accel::build(shapes);
        let camera = stress::camera();
        let shadow = stress::shadow(&accel);
        let random = stress::random(&bounds, 1_000_000);
        check(name, hits(&accel, &camera), *camera_hits, 50_000);
        // The reference skips the first thousandth of a shadow ray, which hides short chords of the smallest spheres.
        check(name, blocked(&accel, &shadow), *shadow_hits, 150);
        check(name, hits(&accel, &random), *random_hits, 50_000);
        for (rays, list, count) in [
            ("camera", &camera, hits as fn(&Accel, &[Ray]) -> usize),
            ("shadow", &shadow, blocked),
            ("random", &random, hits),
        ] {
            group.throughput(Throughput::Elements(list.len() as u64));
            let id = BenchmarkId::new(rays, name);
            group.bench_with_input(id, list, |b, list| b.iter(|| black_box(count(&accel, list))));
        }
    }
    group.finish();
}

/// What the instructions that are detected gain over the portable ones.
fn instructions(c: &mut Criterion) {
    let mut group = c.benchmark_group("traversal");
    group.sample_size(10);
    let camera = stress::camera();
    group.throughput(Throughput::Elements(camera.len() as u64));
    for isa in Isa::ALL.into_iter().filter(|isa| isa.is_available()) {
        let accel = Accel::with_isa(stress::spheres(10_000).shapes, isa);
        let id = BenchmarkId::new(format!("camera_{isa:?}"), "spheres:1e4");
        group.bench_function(id, |b| b.iter(|| black_box(hits(&accel, &camera))));
    }
    group.finish();
}

criterion_group!(benches, traversal, instructions);
criterion_main!(benches);
