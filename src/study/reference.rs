//! Converged pictures, kept from study to study.

use std::{
    fs,
    num::NonZeroUsize,
    path::{Path, PathBuf},
};

use glam::Vec3;

use super::{StudyError, files::file_name};
use crate::{
    Rgb,
    aa::{AntiAliasing, levels::levels},
    film::{Film, WholeFile},
    render::{RenderOptions, render},
    scene::Scene,
};

/// A picture with so many rays in each pixel that its own error is small against what it is compared with.
#[derive(Clone, Debug)]
pub struct Reference {
    pixels: Vec<Rgb>,
}

impl Reference {
    /// The converged picture of a scene at its own depth, read from `folder` or rendered and put there.
    ///
    /// # Errors
    /// It cannot be rendered or written.
    pub fn of(
        scene: &Scene,
        name: &str,
        size: [u32; 2],
        rays: u32,
        threads: Option<NonZeroUsize>,
        folder: &Path,
    ) -> Result<Self, StudyError> {
        let path = Self::path(scene, name, size, rays, folder);
        if let Some(reference) = Self::read(&path, size) {
            return Ok(reference);
        }
        let file = WholeFile::prepare(path)?;
        let aa = AntiAliasing::Sequence { count: rays };
        let options = RenderOptions { size: Some(size), aa, threads, ..RenderOptions::default() };
        let reference = Self::of_film(&render(scene, &options, &|_| ())?.film);
        file.commit(|writer| {
            reference
                .pixels
                .iter()
                .flat_map(Rgb::to_array)
                .try_for_each(|c| writer.write_all(&c.to_le_bytes()))
        })?;
        Ok(reference)
    }

    /// A film that has converged.
    pub fn of_film(film: &Film) -> Self {
        Self { pixels: film.pixels().to_vec() }
    }

    /// The file: its name tells scene, size, depth, rays and the program's version apart, whatever the scene is called.
    fn path(
        scene: &Scene,
        name: &str,
        [width, height]: [u32; 2],
        rays: u32,
        folder: &Path,
    ) -> PathBuf {
        let name = file_name(name);
        let (hash, depth) = (&scene.hash()[..16], scene.depth());
        let version = env!("CARGO_PKG_VERSION");
        folder.join(format!("{name}-{hash}-{width}x{height}-{depth}-{rays}-{version}.f32"))
    }

    /// What is in the file, if it has the length that it should.
    fn read(path: &Path, [width, height]: [u32; 2]) -> Option<Self> {
        let bytes = fs::read(path).ok()?;
        let numbers: Vec<f32> =
            bytes.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect();
        let pixels: Vec<Rgb> = numbers.chunks_exact(3).map(Rgb::from_slice).collect();
        let count = u64::from(width) * u64::from(height);
        (bytes.len() as u64 == 12 * count).then_some(Self { pixels })
    }

    /// The root mean square difference of all channels of a film, and the largest, in levels of 255 before rounding.
    pub fn error_of(&self, film: &Film) -> (f64, f64) {
        let (mut sum, mut worst) = (0.0, 0.0_f32);
        for difference in self.differences(film) {
            sum += f64::from(difference.length_squared()) / 3.0;
            worst = worst.max(difference.abs().max_element());
        }
        ((sum / self.pixels.len().max(1) as f64).sqrt(), f64::from(worst))
    }

    /// The root mean square difference of each pixel's channels, row by row.
    pub fn errors_of_pixels(&self, film: &Film) -> Vec<f32> {
        self.differences(film).map(|d| (d.length_squared() / 3.0).sqrt()).collect()
    }

    fn differences(&self, film: &Film) -> impl Iterator<Item = Vec3> {
        film.pixels().iter().zip(&self.pixels).map(|(a, b)| levels(*a) - levels(*b))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::load_builtin;

    /// Oracle: a picture without pixels cannot be rendered, but that is not what is found first.
    #[test]
    fn a_file_that_cannot_be_written_is_found_before_anything_is_rendered() {
        let scene = load_builtin("assignment").expect("a scene");
        let folder = tempfile::tempdir().expect("a folder");
        let reference = |folder: &Path| Reference::of(&scene, "a", [0, 0], 4, None, folder);
        let render = reference(folder.path());
        assert!(matches!(render, Err(StudyError::Render(_))), "{render:?}");
        let file = reference(&folder.path().join("none"));
        assert!(matches!(file, Err(StudyError::File(_))), "{file:?}");
    }
}
