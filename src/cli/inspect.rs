//! `whitted inspect`: what a file holds, what was repaired, what is missing.

use std::fmt::Write;

use anyhow::anyhow;
use serde::Serialize;
use whitted::scene::obj::{ModelReport, inspect_model};
use whitted::scene::{Warning, inspect_scene};

use super::args::InspectArgs;
use super::failure::{Failure, warn};
use super::{inspect_scene as scene, streams};

pub(crate) fn run(args: &InspectArgs) -> Result<(), Failure> {
    let is_model =
        args.file.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("obj"));
    if !is_model {
        let Some(name) = args.file.to_str() else {
            return Err(Failure::usage(anyhow!(
                "{}: the name of a scene must be UTF-8; rename it, or give - and redirect standard input from it",
                args.file.display()
            )));
        };
        let report = inspect_scene(name)?;
        let text = if args.json { scene::json(&report)? } else { scene::text(&report)? };
        streams::print(text.as_bytes())?;
        return warn(&report.warnings, args.strict, true);
    }
    let report = inspect_model(&args.file)?;
    let text = if args.json { json(&report)? } else { text(&report)? };
    streams::print(text.as_bytes())?;
    warn(&report.warnings, args.strict, true)
}

pub(super) fn json_warnings(warnings: &[Warning]) -> Vec<JsonWarning<'_>> {
    warnings
        .iter()
        .map(|Warning { file, line, message }| JsonWarning { file, line: *line, message })
        .collect()
}

#[derive(Serialize)]
struct Json<'a> {
    file: &'a str,
    positions: usize,
    texcoords: usize,
    normals: usize,
    faces: usize,
    triangles: usize,
    max_corners: usize,
    area: f64,
    bounds: [[f64; 3]; 2],
    closed: bool,
    open_edges: usize,
    open_edge_examples: Vec<JsonEdge>,
    kept_triangles: usize,
    objects: usize,
    groups: usize,
    polylines: usize,
    unused_positions: usize,
    degenerate_faces: usize,
    duplicate_faces: usize,
    materials: &'a [String],
    textures: Vec<JsonTexture<'a>>,
    warnings: Vec<JsonWarning<'a>>,
}

#[derive(Serialize)]
struct JsonEdge {
    line: u32,
    from: [f64; 3],
    to: [f64; 3],
    uses: u32,
}

#[derive(Serialize)]
struct JsonTexture<'a> {
    name: &'a str,
    material: &'a str,
    found: bool,
}

#[derive(Serialize)]
pub(super) struct JsonWarning<'a> {
    file: &'a str,
    line: u32,
    message: &'a str,
}

fn json(report: &ModelReport) -> serde_json::Result<String> {
    let json = Json {
        file: &report.path,
        positions: report.positions,
        texcoords: report.texcoords,
        normals: report.normals,
        faces: report.faces,
        triangles: report.triangles,
        max_corners: report.max_corners,
        area: report.area,
        bounds: [report.bounds.min.to_array(), report.bounds.max.to_array()],
        closed: report.closed,
        open_edges: report.open_edges,
        open_edge_examples: report
            .open_examples
            .iter()
            .map(|e| JsonEdge { line: e.line, from: e.from, to: e.to, uses: e.uses })
            .collect(),
        kept_triangles: report.kept_triangles,
        objects: report.objects,
        groups: report.groups,
        polylines: report.polylines,
        unused_positions: report.unused_positions,
        degenerate_faces: report.degenerate_faces,
        duplicate_faces: report.duplicate_faces,
        materials: &report.materials,
        textures: report
            .textures
            .iter()
            .map(|t| JsonTexture { name: &t.name, material: &t.material, found: t.found })
            .collect(),
        warnings: json_warnings(&report.warnings),
    };
    serde_json::to_string_pretty(&json).map(|text| text + "\n")
}

fn text(report: &ModelReport) -> Result<String, std::fmt::Error> {
    let mut out = String::new();
    let (min, max) = (report.bounds.min, report.bounds.max);
    writeln!(out, "{}", report.path)?;
    writeln!(out, "positions    {} ({} unused)", report.positions, report.unused_positions)?;
    writeln!(out, "texcoords    {}", report.texcoords)?;
    writeln!(out, "normals      {}", report.normals)?;
    writeln!(out, "faces        {}, of up to {} corners", report.faces, report.max_corners)?;
    writeln!(out, "triangles    {}, {} of them kept", report.triangles, report.kept_triangles)?;
    writeln!(
        out,
        "dropped      {} degenerate, {} duplicate faces",
        report.degenerate_faces, report.duplicate_faces
    )?;
    writeln!(out, "area         {}", report.area)?;
    writeln!(out, "bounds       {min} to {max}")?;
    if report.closed {
        writeln!(out, "closed       yes")?;
    } else {
        writeln!(
            out,
            "closed       no, {} edges are not between two faces that agree:",
            report.open_edges
        )?;
        for edge in &report.open_examples {
            let ([a, b, c], [d, e, f]) = (edge.from, edge.to);
            writeln!(
                out,
                "  line {}: ({a}, {b}, {c}) to ({d}, {e}, {f}), used {} times",
                edge.line, edge.uses
            )?;
        }
    }
    writeln!(
        out,
        "parts        {} objects, {} groups, {} points and polylines (left out)",
        report.objects, report.groups, report.polylines
    )?;
    for material in &report.materials {
        writeln!(out, "material     {material}")?;
    }
    for texture in &report.textures {
        let found = if texture.found { "found" } else { "missing" };
        writeln!(out, "texture      {} of {}: {found}", texture.name, texture.material)?;
    }
    for warning in &report.warnings {
        writeln!(out, "warning      {warning}")?;
    }
    Ok(out)
}
