//! Pictures by the classical rules, for comparing ray counts with the figures of other programs.
//!
//! 513 × 513 eye rays go through the corners of the pixels of a picture of 512 × 512; a pixel is the mean of its
//! corners.

use std::{num::NonZeroUsize, time::Instant};

use glam::{DVec2, Vec3};
use rayon::prelude::*;

pub use crate::trace::classic::CLASSIC_DEPTH;
use crate::{
    color::Rgb,
    film::{Film, Tile},
    render::{Outcome, RayCounts, RenderError, Rendering, pool},
    scene::Scene,
    trace::classic::ClassicTracer,
};

/// The width and height of the picture.
pub const CLASSIC_SIZE: u32 = 512;

/// Renders `scene` by the classical rules.
///
/// # Errors
/// The threads cannot be started.
pub fn render_classic(
    scene: &Scene,
    threads: Option<NonZeroUsize>,
) -> Result<Rendering, RenderError> {
    let started = Instant::now();
    let pool = pool(threads)?;
    let view = scene.camera().view(CLASSIC_SIZE, CLASSIC_SIZE);
    let rows: Vec<(Vec<Rgb>, RayCounts)> = pool.install(|| {
        (0..=CLASSIC_SIZE)
            .into_par_iter()
            .map(|row| {
                let mut tracer = ClassicTracer::new(scene);
                let corner = |column: u32| {
                    let ray = view.ray(DVec2::new(f64::from(column), f64::from(row)));
                    tracer.radiance(ray).clamp(Vec3::ZERO, Vec3::ONE)
                };
                let colors = (0..=CLASSIC_SIZE).map(corner).collect();
                (colors, tracer.counts())
            })
            .collect()
    });
    let mut film = Film::new(CLASSIC_SIZE, CLASSIC_SIZE);
    for (y, pair) in (0..).zip(rows.windows(2)) {
        let [(upper, _), (lower, _)] = pair else { continue };
        let mean = |k: usize| (upper[k] + upper[k + 1] + lower[k] + lower[k + 1]) / 4.0;
        let colors: Vec<Rgb> = (0..CLASSIC_SIZE as usize).map(mean).collect();
        let tile = Tile { x0: 0, y0: y, x1: CLASSIC_SIZE, y1: y + 1 };
        film.blit(&tile, &colors, &vec![4; colors.len()]);
    }
    let rays = rows.iter().fold(RayCounts::default(), |sum, (_, counts)| sum + *counts);
    let seconds = started.elapsed().as_secs_f64();
    Ok(Rendering {
        estimated_rmse: None,
        outcome: Outcome::default(),
        film,
        rays,
        threads: pool.current_num_threads(),
        seconds,
        depth: CLASSIC_DEPTH,
    })
}
