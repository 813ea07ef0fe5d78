//! Anti-aliasing on functions whose average over each pixel is known in closed form, and on scenes against converged pictures.

mod functions;
mod goals;
mod pictures;
mod scenes;
mod specks;
mod thin;

use glam::DVec2;
use whitted::{
    Rgb,
    aa::{AntiAliasing, Sample, levels::levels},
    film::Tile,
    render::{Goal, Picture, Sampler, picture},
};

/// What is seen: brightness, and what tells one side of an edge from the other.
pub(super) type Seen = (f64, u32);

/// A function of the place for a scene.
struct Function<'a>(&'a (dyn Fn(DVec2) -> Seen + Sync));

impl Sampler for Function<'_> {
    fn sample(&mut self, places: &[DVec2], samples: &mut Vec<Sample>) {
        samples.extend(places.iter().map(|place| {
            let (brightness, signature) = (self.0)(*place);
            Sample { color: Rgb::splat(brightness as f32), signature, rays: 1, ..Sample::default() }
        }));
    }
}

pub(super) fn mode(text: &str) -> AntiAliasing {
    text.parse().unwrap_or_else(|error| panic!("{error}"))
}

/// The picture, `side` pixels wide and high, of a function.
pub(super) fn picture_of(
    function: &(dyn Fn(DVec2) -> Seen + Sync),
    side: u32,
    aa: &str,
    goal: Goal,
) -> Picture {
    let all = Tile { x0: 0, y0: 0, x1: side, y1: side };
    picture(&all, side, mode(aa), goal, &|| Function(function), &|_| ())
}

/// How far a picture is from the truth.
#[derive(Debug)]
pub(super) struct Found {
    /// Root mean square, in levels of 255.
    pub(super) rmse: f64,
    /// The mean of linear light too much.
    pub(super) bias: f64,
    /// Estimated error over true error.
    pub(super) ratio: f64,
    /// Rays per pixel.
    pub(super) rays: f64,
}

/// Compares with the averages, row by row, in linear light.
pub(super) fn found(picture: &Picture, truth: &[f64]) -> Found {
    let n = truth.len() as f64;
    let (mut square, mut bias) = (0.0, 0.0);
    for (color, truth) in picture.colors.iter().zip(truth) {
        let off = levels(*color).x - levels(Rgb::splat(*truth as f32)).x;
        square += f64::from(off * off);
        bias += f64::from(color.x) - truth;
    }
    let rmse = (square / n).sqrt();
    let rays = picture.samples.iter().copied().map(f64::from).sum::<f64>() / n;
    Found { rmse, bias: bias / n, ratio: picture.estimated_rmse() / rmse, rays }
}
