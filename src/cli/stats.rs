//! The statistics file: one JSON object whose keys are always all there.

use serde::Serialize;
use whitted::film::Film;
use whitted::render::{RayCounts, Rendering};
use whitted::scene::Scene;

use super::memory;

/// What a render was and what it took.
#[derive(Debug, Serialize)]
pub(crate) struct Statistics<'a> {
    scene: &'a str,
    width: u32,
    height: u32,
    threads: usize,
    aa: String,
    depth: u32,
    primitives: usize,
    lights: usize,
    seconds: Seconds,
    rays: Rays,
    bvh: Bvh,
    samples_per_pixel: Samples,
    error: Error,
    peak_memory_bytes: Option<u64>,
    version: &'static str,
}

/// Wall-clock time of each step, in seconds.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct Seconds {
    pub(crate) load: f64,
    pub(crate) build: f64,
    pub(crate) render: f64,
    pub(crate) write: f64,
    pub(crate) total: f64,
}

#[derive(Debug, Serialize)]
struct Rays {
    camera: u64,
    reflected: u64,
    refracted: u64,
    transmitted: u64,
    shadow: u64,
    camera_hit: u64,
}

#[derive(Debug, Serialize)]
struct Bvh {
    nodes: usize,
    bytes: usize,
}

#[derive(Debug, PartialEq, Serialize)]
struct Samples {
    min: u32,
    mean: f64,
    max: u32,
}

/// Root-mean-square errors in levels of 255, where they are known.
#[derive(Debug, Serialize)]
struct Error {
    estimated_rmse: Option<f64>,
    measured_rmse: Option<f64>,
    /// The squared error for each ray at which pixels stopped, if the goal was an error.
    squared_per_ray: Option<f32>,
    /// Whether the error wanted, or the time limit, was kept; if there was one.
    goal_reached: Option<bool>,
}

/// What is known of the error beside the rendering itself.
pub(crate) struct Errors {
    /// Against the reference.
    pub(crate) measured: Option<f64>,
    /// If there was a goal.
    pub(crate) is_goal_reached: Option<bool>,
}

impl<'a> Statistics<'a> {
    pub(crate) fn new(
        scene: &'a Scene,
        mode: String,
        rendering: &Rendering,
        errors: &Errors,
        seconds: Seconds,
    ) -> Self {
        let RayCounts { camera, reflected, refracted, transmitted, shadow, camera_hit } =
            rendering.rays;
        let bvh = scene.bvh_stats();
        Self {
            scene: scene.name(),
            width: rendering.film.width(),
            height: rendering.film.height(),
            threads: rendering.threads,
            aa: mode,
            depth: rendering.depth,
            primitives: scene.primitive_count(),
            lights: scene.light_count(),
            seconds,
            rays: Rays { camera, reflected, refracted, transmitted, shadow, camera_hit },
            bvh: Bvh { nodes: bvh.nodes, bytes: bvh.bytes },
            samples_per_pixel: Samples::of(&rendering.film),
            error: Error {
                estimated_rmse: rendering.estimated_rmse,
                measured_rmse: errors.measured,
                squared_per_ray: rendering.outcome.per_ray,
                goal_reached: errors.is_goal_reached,
            },
            peak_memory_bytes: memory::peak(),
            version: env!("CARGO_PKG_VERSION"),
        }
    }

    /// The object as indented JSON text with a line end.
    pub(crate) fn to_json(&self) -> serde_json::Result<String> {
        serde_json::to_string_pretty(self).map(|text| text + "\n")
    }
}

impl Samples {
    /// Over all pixels; zeros for a film without any.
    fn of(film: &Film) -> Self {
        let samples = film.samples();
        let sum: u64 = samples.iter().copied().map(u64::from).sum();
        Self {
            min: samples.iter().copied().min().unwrap_or(0),
            mean: sum as f64 / samples.len().max(1) as f64,
            max: samples.iter().copied().max().unwrap_or(0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use whitted::Rgb;
    use whitted::film::Tile;

    #[test]
    fn samples_per_pixel_are_counted_over_the_film() {
        let mut film = Film::new(4, 1);
        let tile = Tile { x0: 0, y0: 0, x1: 4, y1: 1 };
        film.blit(&tile, &[Rgb::ZERO; 4], &[4, 4, 64, 8]);
        assert_eq!(Samples::of(&film), Samples { min: 4, mean: 20.0, max: 64 });
        assert_eq!(Samples::of(&Film::new(0, 3)), Samples { min: 0, mean: 0.0, max: 0 });
    }
}
