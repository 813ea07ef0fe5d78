//! What the anti-aliasing modes cost as objects become more. An element is a pixel; `whitted study` puts the errors beside the times.

use std::time::Duration;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use whitted::{
    aa::AntiAliasing,
    render::{RenderOptions, render},
    scene::load_builtin_of,
};

const SIDE: u32 = 128;

fn modes(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("antialiasing");
    group.sample_size(10).warm_up_time(Duration::from_millis(500));
    group.measurement_time(Duration::from_secs(2));
    group.throughput(Throughput::Elements(u64::from(SIDE * SIDE)));
    for objects in [10, 1_000, 10_000, 100_000, 1_000_000] {
        let scene = load_builtin_of("spheres", Some(objects)).expect("a scene");
        for mode in ["none", "grid:2", "grid:4", "adaptive:16", "adaptive:4"] {
            let aa: AntiAliasing = mode.parse().expect("a mode");
            let options = RenderOptions { size: Some([SIDE; 2]), aa, ..Default::default() };
            let id = BenchmarkId::new(mode, objects);
            group.bench_with_input(id, &options, |bencher, options| {
                bencher.iter(|| render(&scene, options, &|_| ()).expect("threads start"));
            });
        }
    }
    group.finish();
}

criterion_group!(benches, modes);
criterion_main!(benches);
