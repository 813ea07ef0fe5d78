//! What `whitted inspect` says of a scene.

use std::{collections::BTreeMap, fmt::Write};

use serde::Serialize;
use whitted::scene::{SceneReport, nff::NffCounts};

use super::inspect::{JsonWarning, json_warnings};

#[derive(Serialize)]
struct Json<'a> {
    scene: &'a str,
    resolution: [u32; 2],
    depth: u32,
    primitives: usize,
    shapes: BTreeMap<&'a str, usize>,
    bounds: [[f64; 3]; 2],
    materials: usize,
    material_names: &'a [String],
    textures: Vec<JsonTexture<'a>>,
    models: &'a [String],
    lights: usize,
    light_positions: Vec<[f64; 3]>,
    camera: JsonCamera,
    background: [f32; 3],
    entities: Option<BTreeMap<&'static str, u32>>,
    warnings: Vec<JsonWarning<'a>>,
}

#[derive(Serialize)]
struct JsonTexture<'a> {
    name: &'a str,
    file: &'a str,
    found: bool,
}

#[derive(Serialize)]
struct JsonCamera {
    eye: [f64; 3],
    look_at: [f64; 3],
    up: [f64; 3],
    vertical_fov: f64,
}

fn primitives(report: &SceneReport) -> usize {
    report.shapes.iter().map(|(_, count)| count).sum()
}

fn entities(counts: &NffCounts) -> [(&'static str, u32); 8] {
    [
        ("spheres", counts.spheres),
        ("cones", counts.cones),
        ("cylinders", counts.cylinders),
        ("polygons", counts.polygons),
        ("patches", counts.patches),
        ("max_corners", counts.max_corners),
        ("lights", counts.lights),
        ("surfaces", counts.surfaces),
    ]
}

pub(super) fn json(report: &SceneReport) -> serde_json::Result<String> {
    let camera = &report.camera;
    let pictures = report.names.pictures.iter();
    let json = Json {
        scene: &report.name,
        resolution: report.resolution,
        depth: report.depth,
        primitives: primitives(report),
        shapes: report.shapes.iter().copied().collect(),
        bounds: [report.bounds.min.to_array(), report.bounds.max.to_array()],
        materials: report.materials,
        material_names: &report.names.materials,
        // A scene without one of its pictures is an error.
        textures: pictures.map(|(name, file)| JsonTexture { name, file, found: true }).collect(),
        models: &report.names.models,
        lights: report.lights.len(),
        light_positions: report.lights.iter().map(|light| light.position.to_array()).collect(),
        camera: JsonCamera {
            eye: camera.eye.to_array(),
            look_at: camera.look_at.to_array(),
            up: camera.up.to_array(),
            vertical_fov: camera.vertical_fov,
        },
        background: report.background.to_array(),
        entities: report.entities.as_ref().map(|counts| entities(counts).into()),
        warnings: json_warnings(&report.warnings),
    };
    serde_json::to_string_pretty(&json).map(|text| text + "\n")
}

pub(super) fn text(report: &SceneReport) -> Result<String, std::fmt::Error> {
    let mut out = String::new();
    let [width, height] = report.resolution;
    let camera = &report.camera;
    writeln!(out, "{}", report.name)?;
    writeln!(out, "picture      {width}x{height} pixels, depth {}", report.depth)?;
    writeln!(
        out,
        "camera       from {} to {}, {:.4} degrees high",
        camera.eye, camera.look_at, camera.vertical_fov
    )?;
    if let Some(counts) = &report.entities {
        let counts = entities(counts).map(|(name, count)| {
            format!("{count} {}", name.replace("max_corners", "corners at most"))
        });
        writeln!(out, "entities     {}", counts.join(", "))?;
    }
    writeln!(out, "primitives   {}", primitives(report))?;
    for (kind, count) in &report.shapes {
        writeln!(out, "  {count} {kind}")?;
    }
    writeln!(out, "bounds       {} to {}", report.bounds.min, report.bounds.max)?;
    writeln!(out, "materials    {}", report.materials)?;
    for material in &report.names.materials {
        writeln!(out, "material     {material}")?;
    }
    for (name, file) in &report.names.pictures {
        writeln!(out, "texture      {name}: {file}, found")?;
    }
    for model in &report.names.models {
        writeln!(out, "model        {model}")?;
    }
    writeln!(out, "lights       {}", report.lights.len())?;
    for light in &report.lights {
        writeln!(out, "  at {}, intensity {}", light.position, light.intensity)?;
    }
    for warning in &report.warnings {
        writeln!(out, "warning      {warning}")?;
    }
    Ok(out)
}
