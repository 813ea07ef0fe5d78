//! What a scene holds, for whoever asks about it rather than renders it.

use super::{
    Parts, SceneError, Warning,
    nff::NffCounts,
    open::{LoadOptions, gather},
    parts::CameraPlan,
};
use crate::{
    color::Rgb,
    geometry::{Bounds, Shape},
    light::Light,
};

/// The names that a scene's text gives.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Names {
    /// The materials.
    pub materials: Vec<String>,
    /// The textures that are pictures: their names, and the files.
    pub pictures: Vec<(String, String)>,
    /// The files of the models.
    pub models: Vec<String>,
}

/// The contents of a scene.
#[derive(Clone, Debug)]
pub struct SceneReport {
    /// The scene's name.
    pub name: String,
    /// Width and height of the picture in pixels.
    pub resolution: [u32; 2],
    /// The deepest level of recursion.
    pub depth: u32,
    /// Where it is seen from.
    pub camera: CameraPlan,
    /// The colour of a ray that hits nothing, in linear light.
    pub background: Rgb,
    /// The lights.
    pub lights: Vec<Light>,
    /// The kinds of shapes that rays meet, and how many there are of each.
    pub shapes: Vec<(&'static str, usize)>,
    /// The smallest box about everything.
    pub bounds: Bounds,
    /// How many materials there are.
    pub materials: usize,
    /// What the scene's text calls its parts; empty for formats without names.
    pub names: Names,
    /// The entities of an NFF file.
    pub entities: Option<NffCounts>,
    /// What was odd.
    pub warnings: Vec<Warning>,
}

/// What the scene `name`, built in or a file, holds.
///
/// # Errors
/// Those of [`load`](fn@super::load).
pub fn inspect_scene(name: &str) -> Result<SceneReport, SceneError> {
    let found = gather(name, &LoadOptions::default())?;
    let parts = found.parts;
    parts.camera.camera()?;
    Ok(SceneReport {
        name: found.name,
        resolution: parts.resolution,
        depth: parts.depth,
        camera: parts.camera,
        background: parts.background,
        shapes: shapes(&parts),
        bounds: parts.bounds(),
        materials: parts.materials.len(),
        lights: parts.lights,
        names: found.names,
        entities: found.entities,
        warnings: found.sources.warnings,
    })
}

fn kind(shape: &Shape) -> &'static str {
    match shape {
        Shape::Sphere(_) => "spheres",
        Shape::Cylinder(_) => "cylinders",
        Shape::Cone(_) => "cones",
        Shape::Quad(_) => "quads",
        Shape::Triangle(_) => "triangles",
        Shape::Polygon(_) => "polygons",
        Shape::Face(_) => "faces",
        Shape::Inward(s) => kind(s.shape()),
    }
}

/// The kinds of shapes and their numbers, those that there are.
fn shapes(parts: &Parts) -> Vec<(&'static str, usize)> {
    let mut counts: Vec<(&str, usize)> =
        ["spheres", "cylinders", "cones", "quads", "triangles", "polygons", "faces"]
            .map(|kind| (kind, 0))
            .into();
    for shape in &parts.shapes {
        counts.iter_mut().filter(|(name, _)| *name == kind(shape)).for_each(|(_, n)| *n += 1);
    }
    let faces: usize = parts.meshes.iter().map(|part| part.mesh.triangles().len()).sum();
    counts.iter_mut().filter(|(name, _)| *name == "faces").for_each(|(_, n)| *n += faces);
    counts.retain(|(_, count)| *count > 0);
    counts
}
