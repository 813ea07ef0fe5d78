//! The time to arrange primitives: `build/accel/<geometry>`; one element is one primitive.
//!
//! Besides the stress scenes, those on which a builder may take quadratic time: equal boxes, and boxes in a row.

#[allow(dead_code, reason = "shared with the other benches")]
mod stress;

use std::hint::black_box;

use criterion::{BatchSize, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::DVec3;
use whitted::{
    accel::Accel,
    geometry::{Shape, Sphere},
};

fn row(count: u32, step: f64) -> Vec<Shape> {
    let sphere = |k| Sphere::try_new(DVec3::X * f64::from(k) * step, 0.5).expect("a sphere").into();
    (0..count).map(sphere).collect()
}

fn build(c: &mut Criterion) {
    let mut group = c.benchmark_group("build");
    group.sample_size(10);
    for (name, shapes) in [
        ("spheres:1e3", stress::spheres(1_000).shapes),
        ("spheres:1e4", stress::spheres(10_000).shapes),
        ("spheres:1e5", stress::spheres(100_000).shapes),
        ("icos:1000:1", stress::icospheres(1_000, 1).shapes),
        ("identical:2e4", row(20_000, 0.0)),
        ("row:2e4", row(20_000, 1.0)),
    ] {
        group.throughput(Throughput::Elements(shapes.len() as u64));
        group.bench_with_input(BenchmarkId::new("accel", name), &shapes, |b, shapes| {
            b.iter_batched(
                || shapes.clone(),
                |shapes| black_box(Accel::build(shapes)),
                BatchSize::LargeInput,
            );
        });
    }
    group.finish();
}

criterion_group!(benches, build);
criterion_main!(benches);
