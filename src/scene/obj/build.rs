//! From the statements of an OBJ file to a mesh: what is double or has no area is left out, what is missing is made.

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use super::{
    Model, ModelError, closed,
    cut::triangles,
    faces::Faces,
    lists::{Obj, Tally},
    materials::{Library, default_material},
    normals,
    report::ModelReport,
    vertices::Vertices,
    weld::weld,
};
use crate::{
    color::from_srgb,
    geometry::{Bounds, Mesh, mesh::Attributes, triangulate::vector_area},
    material::Material,
    scene::warning::Warning,
};

/// A model on its way from statements to triangles.
#[derive(Debug)]
pub(super) struct Builder<'a> {
    path: &'a str,
    obj: Obj,
    library: Library,
    /// The first position with the same coordinates.
    first: Vec<u32>,
    faces: Faces,
}

impl<'a> Builder<'a> {
    pub(super) fn new(path: &'a str, obj: Obj, library: Library) -> Result<Self, ModelError> {
        let first = weld(&obj.positions);
        let faces = Faces::sort_out(&obj, &first);
        if !faces.kept.contains(&true) {
            return Err(ModelError::NoArea { path: path.to_owned() });
        }
        Ok(Self { path, obj, library, first, faces })
    }

    /// What the file holds; what is known only after building is left empty.
    pub(super) fn report(&self) -> ModelReport {
        let obj = &self.obj;
        let mut is_used = vec![false; obj.positions.len()];
        for corner in &obj.corners {
            is_used[*corner as usize] = true;
        }
        let used = || obj.positions.iter().zip(&is_used).filter(|(_, used)| **used);
        let sides = (0..obj.len()).map(|face| obj.face(face).len());
        let (open_edges, open_examples) = closed::open_edges(obj, &self.first, &self.faces.kept);
        ModelReport {
            path: self.path.to_owned(),
            positions: obj.positions.len(),
            texcoords: obj.texcoords.len(),
            normals: obj.normals.len(),
            faces: obj.len(),
            triangles: sides.clone().map(|sides| sides - 2).sum(),
            max_corners: sides.max().unwrap_or(0),
            area: self.area(),
            bounds: Bounds::of_points(used().map(|(p, _)| *p)),
            closed: open_edges == 0,
            open_edges,
            open_examples,
            kept_triangles: 0,
            objects: obj.tallies.objects.count as usize,
            groups: obj.tallies.groups.count as usize,
            polylines: obj.tallies.lines.count as usize,
            unused_positions: obj.positions.len() - used().count(),
            degenerate_faces: self.faces.degenerate.count as usize,
            duplicate_faces: self.faces.duplicate.count as usize,
            materials: obj.materials.iter().map(|(name, _)| name.clone()).collect(),
            textures: self.library.textures.clone(),
            warnings: Vec::new(),
        }
    }

    /// The sum of the lengths of the faces' vector areas.
    fn area(&self) -> f64 {
        let obj = &self.obj;
        let mut points = Vec::new();
        let area = |face: usize| {
            points.clear();
            points.extend(obj.corners[obj.face(face)].iter().map(|c| obj.positions[*c as usize]));
            vector_area(&points).length()
        };
        (0..obj.len()).map(area).sum()
    }

    /// The model, repaired.
    pub(super) fn model(mut self) -> Result<Model, ModelError> {
        let mut warnings = std::mem::take(&mut self.library.warnings);
        let materials = self.materials(&mut warnings);
        self.warn_of_repairs(&mut warnings);
        let given_normals = self.obj.normals.len();
        let wanted = self.wanting_normals();
        if wanted.contains(&true) {
            normals::complete(&mut self.obj, &self.first, &wanted);
        }
        drop((wanted, std::mem::take(&mut self.first)));
        let cut = triangles(&self.obj, &self.faces.kept, &materials.of, given_normals);
        if cut.corners.is_empty() {
            return Err(ModelError::NoArea { path: self.path.to_owned() });
        }
        if let t @ Tally { count: 1.., .. } = cut.torn {
            let message = format!(
                "filled {} only partly, because the outline crosses itself{}",
                faces(t),
                first(t)
            );
            warnings.push(self.warning(t, message));
        }
        if let t @ Tally { count: 1.., .. } = cut.turned {
            let message = format!("flipped {} whose normals point backwards{}", faces(t), first(t));
            warnings.push(self.warning(t, message));
        }
        warnings.sort_by(|a, b| (&a.file, a.line).cmp(&(&b.file, b.line)));
        let files = std::mem::take(&mut self.library.files);
        let mesh = self.mesh(cut.corners)?;
        Ok(Model { mesh, materials: materials.list, material_of: cut.material_of, warnings, files })
    }

    fn warning(&self, at: Tally, message: String) -> Warning {
        Warning { file: self.path.to_owned(), line: at.line, message }
    }

    /// The materials that are used, found or replaced.
    fn materials(&self, warnings: &mut Vec<Warning>) -> Materials {
        let plain = default_material(!self.obj.colors.is_empty());
        let mut materials = Materials { list: vec![plain], of: Vec::new() };
        let library = &self.library;
        if let (false, Some((_, line))) = (library.is_named, self.obj.materials.first()) {
            let message = "`usemtl`, but no `mtllib` names a material library; grey is used";
            warnings.push(self.warning(Tally { count: 1, line: *line }, message.to_owned()));
        }
        // A picture matters only where a face wears it; several materials may want the same.
        for (name, _) in
            self.obj.sections.iter().filter_map(|s| self.obj.materials.get(s.material as usize))
        {
            if let Some(missing) = library.missing_picture(name)
                && warnings.iter().all(|w| w.message != missing.message)
            {
                warnings.push(missing.clone());
            }
        }
        for (name, line) in &self.obj.materials {
            let Some((material, bare)) = library.material(name) else {
                // Without any library that was said already.
                if !library.is_empty() {
                    let message = format!("material `{name}` is not defined; grey is used");
                    warnings.push(self.warning(Tally { count: 1, line: *line }, message));
                }
                materials.of.push([0, 0]);
                continue;
            };
            let number = materials.list.len() as u32;
            materials.list.push(material);
            materials.of.push([number, number + u32::from(bare.is_some())]);
            materials.list.extend(bare);
        }
        materials
    }

    fn warn_of_repairs(&self, warnings: &mut Vec<Warning>) {
        let tallies = &self.obj.tallies;
        let mut warn = |tally: Tally, message: String| {
            if tally.count > 0 {
                warnings.push(self.warning(tally, message));
            }
        };
        let t = self.faces.degenerate;
        warn(t, format!("dropped {} without area{}", faces(t), first(t)));
        let t = self.faces.duplicate;
        warn(t, format!("dropped {} repeating an earlier one{}", faces(t), first(t)));
        let t = self.faces.repeated;
        warn(t, format!("repaired {} with a corner given twice{}", faces(t), first(t)));
        let t = tallies.short_faces;
        warn(t, format!("dropped {} of fewer than 3 corners{}", faces(t), first(t)));
        let t = tallies.bad_normals;
        warn(t, format!("replaced normals that are zero or not finite: {}{}", t.count, first(t)));
        let t = tallies.bad_texcoords;
        warn(
            t,
            format!("set texture coordinates to 0 that are not finite: {}{}", t.count, first(t)),
        );
        let t = tallies.free_form;
        warn(t, "left out free-form curves and surfaces, which are not supported".to_owned());
        let t = tallies.unknown;
        let word = &tallies.unknown_word;
        warn(t, format!("ignored unknown statements: {}, `{word}` here", t.count));
    }

    /// For every face, whether it is kept and lacks a usable normal somewhere.
    fn wanting_normals(&self) -> Vec<bool> {
        let obj = &self.obj;
        let kept = &self.faces.kept;
        let lacks = |face: usize| obj.face(face).any(|corner| obj.lacks_normal(corner));
        (0..obj.len()).into_par_iter().map(|face| kept[face] && lacks(face)).collect()
    }

    /// The mesh of triangles of corners: corners that agree in position, surface coordinates and normal become one
    /// vertex.
    fn mesh(self, mut triangles: Vec<[u32; 3]>) -> Result<Mesh, ModelError> {
        let mut obj = self.obj;
        (obj.ends, obj.lines) = (Vec::new(), Vec::new());
        let mut vertices = Vertices::new(&obj);
        for corner in triangles.iter_mut().flatten() {
            *corner = vertices.place(&obj, *corner as usize);
        }
        let keys = vertices.keys;
        let attributes = Attributes {
            normals: if obj.corner_normals.is_empty() {
                Vec::new()
            } else {
                keys.iter()
                    .map(|[_, _, n]| obj.normals.get(*n as usize).copied().unwrap_or(Vec3::ZERO))
                    .collect()
            },
            uvs: if obj.texcoords.is_empty() {
                Vec::new()
            } else {
                keys.iter()
                    .map(|[_, t, _]| obj.texcoords.get(*t as usize).copied().unwrap_or(Vec2::ZERO))
                    .collect()
            },
            tints: if obj.colors.is_empty() { Vec::new() } else { tints(&obj.colors, &keys) },
        };
        let points = keys.iter().map(|[p, _, _]| obj.positions[*p as usize]).collect();
        Mesh::try_new(points, triangles, attributes)
            .map_err(|source| ModelError::Mesh { path: self.path.to_owned(), source })
    }
}

/// The materials of a model, and for each that its file uses the one for faces with and without surface coordinates.
struct Materials {
    list: Vec<Material>,
    of: Vec<[u32; 2]>,
}

fn faces(tally: Tally) -> String {
    if tally.count == 1 { "1 face".to_owned() } else { format!("{} faces", tally.count) }
}

fn first(tally: Tally) -> &'static str {
    if tally.count == 1 { "" } else { " (the first is here)" }
}

/// Vertex colours, which some programs write from 0 to 255, as linear light.
fn tints(colors: &[Vec3], keys: &[[u32; 3]]) -> Vec<Vec3> {
    let largest = colors.iter().map(|c| c.max_element()).fold(0.0, f32::max);
    let unit = if largest > 1.0 { 255.0 } else { 1.0 };
    let tint = |c: Vec3| {
        let display = c.to_array().map(|c| f64::from((c / unit).clamp(0.0, 1.0)));
        from_srgb(display.map(|c| if c.is_nan() { 0.0 } else { c }))
    };
    keys.iter().map(|[p, _, _]| tint(colors[*p as usize])).collect()
}
