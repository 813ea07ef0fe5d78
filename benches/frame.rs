//! What a picture takes, and how that grows with the objects. An element is a pixel.

use std::time::Duration;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use whitted::{
    aa::AntiAliasing,
    render::{RenderOptions, render},
    scene::load_builtin_of,
};

const SIDE: u32 = 600;

fn frames(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("frame");
    group.sample_size(10).warm_up_time(Duration::from_millis(500));
    group.throughput(Throughput::Elements(u64::from(SIDE * SIDE)));
    let options = RenderOptions { aa: AntiAliasing::None, ..Default::default() };
    let mut frame = |id: BenchmarkId, name: &str, objects: Option<u32>| {
        let scene = load_builtin_of(name, objects).expect("a scene");
        group.bench_with_input(id, &options, |bencher, options| {
            bencher.iter(|| render(&scene, options, &|_| ()).expect("threads start"));
        });
    };
    frame(BenchmarkId::from_parameter("assignment"), "assignment", None);
    for objects in [1_000, 10_000, 100_000, 1_000_000] {
        frame(BenchmarkId::new("spheres", objects), "spheres", Some(objects));
    }
    group.finish();
}

criterion_group!(benches, frames);
criterion_main!(benches);
