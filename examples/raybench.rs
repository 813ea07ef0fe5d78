//! The ray-query benchmark of docs/stress.md, in the words of `benches/peers/raybench.cpp`: a line of CSV a measurement.
//!
//! `cargo run --release --example raybench -- spheres:1e5 [REPEATS]`, or `icos:1000:3`, or `obj:FILE`. One thread, except
//! for the build; the best of the repeats. With `--features leaf-study` it also counts the tests that a ray takes.
#![allow(clippy::print_stdout, reason = "its output is a table")]

#[path = "../benches/stress/mod.rs"]
#[allow(dead_code, reason = "shared with the other benches")]
mod stress;

use std::{ops::ControlFlow, time::Instant};

use glam::Vec3;
use stress::{Geometry, SIDE};
use whitted::{
    accel::Accel,
    geometry::{
        Ray,
        lanes::{HitLanes, RayLanes, Vectors},
    },
};

fn main() {
    let mut arguments = std::env::args().skip(1);
    let what = arguments.next().expect("spheres:N, icos:N:LEVEL or obj:FILE");
    let repeats = arguments.next().map_or(5, |text| text.parse().expect("a number of repeats"));
    let bench = Bench { what, repeats };
    bench.builds();
    bench.queries();
}

/// What is measured, and how often.
struct Bench {
    what: String,
    repeats: usize,
}

impl Bench {
    fn print(&self, measure: &str, value: f64, unit: &str, hits: usize, sum: f64) {
        let what = &self.what;
        println!("whitted,{what},robust,{measure},{value:.6},{unit},{hits},{sum:.9},0");
    }

    /// Builds of the tree, by two threads and by one.
    fn builds(&self) {
        for threads in [2, 1] {
            let pool =
                rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            let build = || {
                let Geometry { shapes, .. } = geometry(&self.what);
                let work = || Accel::build(shapes);
                pool.install(
                    || if threads == 1 { timed(work).0 } else { timed_by_the_wall(work).0 },
                )
            };
            let best = (0..self.repeats.min(3)).map(|_| build()).fold(f64::INFINITY, f64::min);
            let measure = format!("build_{threads}thread{}", if threads == 1 { "" } else { "s" });
            self.print(&measure, best * 1e3, "ms", geometry(&self.what).shapes.len(), 0.0);
        }
    }

    /// Queries of rays from a camera, one by one and together, from what they hit to a light, and of random ones.
    fn queries(&self) {
        let Geometry { shapes, bounds } = geometry(&self.what);
        let accel = Accel::build(shapes);
        let camera = stress::camera();
        let single = in_single_precision(&camera);
        self.rate(camera.len(), &|| nearest(&accel, &single), "camera_intersect1");
        let tiles = in_tiles(&camera);
        self.rate(camera.len(), &|| nearest_in_tiles(&accel, &tiles), "camera_coherent");
        let shadow = stress::shadow(&accel);
        self.rate(shadow.len(), &|| (blocked(&accel, &shadow), 0.0), "shadow_occluded1");
        let random = in_single_precision(&stress::random(&bounds, 1_000_000));
        self.rate(random.len(), &|| nearest(&accel, &random), "random_intersect1");
    }

    /// The best rate of a query of so many rays, which gives the hits and the sum of their distances.
    fn rate(&self, rays: usize, query: &dyn Fn() -> (usize, f64), measure: &str) {
        let runs: Vec<_> = (0..self.repeats).map(|_| timed(query)).collect();
        let seconds = runs.iter().map(|run| run.0).fold(f64::INFINITY, f64::min);
        let (hits, sum) = runs[0].1;
        self.print(measure, rays as f64 / seconds * 1e-6, "Mrays/s", hits, sum);
        #[cfg(feature = "leaf-study")]
        print_counts(measure, rays, query);
    }
}

fn nearest(accel: &Accel, rays: &[[Vec3; 2]]) -> (usize, f64) {
    let rays = rays.iter().map(|[origin, dir]| Ray::new(origin.as_dvec3(), dir.as_dvec3()));
    let hits = rays.filter_map(|ray| accel.nearest(&ray, f64::INFINITY));
    hits.fold((0, 0.0), |(count, sum), hit| (count + 1, sum + hit.t))
}

fn nearest_in_tiles(accel: &Accel, tiles: &[[Vectors; 2]]) -> (usize, f64) {
    let mut hits = HitLanes::NONE;
    tiles.iter().fold((0, 0.0), |(all, sum), [origin, dir]| {
        let rays = RayLanes { origin, dir, from: None, used: u64::MAX };
        accel.nearest_packet(&rays, &mut hits);
        let found = hits.t.iter().filter(|t| t.is_finite());
        found.fold((all, sum), |(all, sum), t| (all + 1, sum + t))
    })
}

fn blocked(accel: &Accel, rays: &[Ray]) -> usize {
    let is_blocked =
        |ray: &&Ray| accel.is_blocked(ray, 1.0, |_| true, |_, _| ControlFlow::Break(()));
    rays.iter().filter(is_blocked).count()
}

/// The tests that a ray takes.
#[cfg(feature = "leaf-study")]
fn print_counts(measure: &str, rays: usize, query: &dyn Fn() -> (usize, f64)) {
    use whitted::accel::study::{COUNTED, Leaves, set_leaves, take_counts};
    set_leaves(Leaves::Counted);
    take_counts();
    query();
    set_leaves(Leaves::Robust);
    for (name, count) in COUNTED.iter().zip(take_counts()).filter(|(_, count)| *count > 0) {
        println!("{measure}: {:.3} x {name}", count as f64 / rays as f64);
    }
}

/// The seconds of this thread's processor time that `work` takes, which other programs disturb less, where the system tells.
fn timed<T>(work: impl FnOnce() -> T) -> (f64, T) {
    let Some(started) = thread_seconds() else { return timed_by_the_wall(work) };
    let result = work();
    (thread_seconds().map_or(f64::NAN, |now| now - started), result)
}

fn thread_seconds() -> Option<f64> {
    std::thread::yield_now(); // brings the account up to date
    let times = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    times.split_whitespace().next()?.parse::<f64>().ok().map(|nanoseconds| nanoseconds * 1e-9)
}

fn timed_by_the_wall<T>(work: impl FnOnce() -> T) -> (f64, T) {
    let started = Instant::now();
    let result = work();
    (started.elapsed().as_secs_f64(), result)
}

fn geometry(what: &str) -> Geometry {
    let number = |text: &str| text.parse::<f64>().expect("a number") as usize;
    match what.split_once(':').expect("a kind and a number or file") {
        ("spheres", count) => stress::spheres(number(count)),
        ("icos", rest) => {
            let (count, level) = rest.split_once(':').expect("icos:N:LEVEL");
            stress::icospheres(number(count), number(level))
        }
        ("obj", file) => stress::mesh(&std::fs::read_to_string(file).expect("a model")),
        _ => panic!("spheres:N, icos:N:LEVEL or obj:FILE"),
    }
}

/// Rays in free space, whose numbers single precision has, in as little memory as the other programs take for theirs.
fn in_single_precision(rays: &[Ray]) -> Vec<[Vec3; 2]> {
    rays.iter().map(|ray| [ray.origin.as_vec3(), ray.dir.as_vec3()]).collect()
}

/// The camera's rays in squares of 8 × 8: origins and directions.
fn in_tiles(rays: &[Ray]) -> Vec<[Vectors; 2]> {
    let corners = (0..SIDE / 8).flat_map(|j| (0..SIDE / 8).map(move |i| (8 * i, 8 * j)));
    let tile = |(x, y): (usize, usize)| {
        let mut tile = [Vectors::ZERO, Vectors::ZERO];
        for k in 0..64 {
            let ray: &Ray = &rays[(y + k / 8) * SIDE + x + k % 8];
            tile[0].set(k, ray.origin);
            tile[1].set(k, ray.dir);
        }
        tile
    };
    corners.map(tile).collect()
}
