//! From the statements of an OBJ file to a mesh: what is double or has no area is left out, what is missing is made.

use std::collections::HashSet;

use glam::{DVec3, Vec2, Vec3};

use super::{
    Model, ModelError, closed,
    materials::{Library, default_material},
    normals::{self, Mixed, NumberMap},
    parse::{NONE, Obj, Tally},
    report::ModelReport,
    weld::{mix, weld},
};
use crate::{
    color::from_srgb,
    geometry::{
        Bounds, Mesh,
        mesh::{Attributes, has_area},
        triangulate::{Triangulator, vector_area},
    },
    material::Material,
    scene::warning::Warning,
};

/// A model on its way from statements to triangles.
#[derive(Debug)]
pub(super) struct Builder<'a> {
    path: &'a str,
    obj: Obj,
    library: Library,
    /// The vector areas of the faces.
    areas: Vec<DVec3>,
    /// The first position with the same coordinates.
    first: Vec<u32>,
    /// Whether a face becomes triangles.
    kept: Vec<bool>,
    /// How many normals are the file's own.
    given_normals: usize,
    degenerate: Tally,
    duplicate: Tally,
    /// Corners that were given twice in a row.
    repeated: Tally,
}

impl<'a> Builder<'a> {
    pub(super) fn new(path: &'a str, obj: Obj, library: Library) -> Result<Self, ModelError> {
        let first = weld(&obj.positions);
        let mut builder = Self {
            path,
            areas: Vec::with_capacity(obj.len()),
            first,
            kept: Vec::with_capacity(obj.len()),
            given_normals: obj.normals.len(),
            degenerate: Tally::default(),
            duplicate: Tally::default(),
            repeated: Tally::default(),
            obj,
            library,
        };
        builder.sort_out();
        if builder.kept.contains(&true) {
            Ok(builder)
        } else {
            Err(ModelError::NoArea { path: path.to_owned() })
        }
    }

    /// Measures every face and decides which are kept.
    fn sort_out(&mut self) {
        let mut seen: HashSet<u64, std::hash::BuildHasherDefault<Mixed>> = HashSet::default();
        seen.reserve(self.obj.len());
        let mut points = Vec::new();
        let mut outline = Vec::new();
        for face in 0..self.obj.len() {
            let corners = &self.obj.corners[self.obj.face(face)];
            let line = self.obj.lines[face];
            points.clear();
            points.extend(corners.iter().map(|c| self.obj.positions[*c as usize]));
            let area = vector_area(&points);
            self.areas.push(area);
            outline.clear();
            outline.extend(corners.iter().map(|c| self.first[*c as usize]));
            outline.dedup();
            while outline.len() > 1 && outline.first() == outline.last() {
                outline.pop();
            }
            let is_degenerate = outline.len() < 3 || !spans_area(&points, area);
            if !is_degenerate && outline.len() < corners.len() {
                self.repeated.add(line);
            }
            let kept = if is_degenerate {
                self.degenerate.add(line);
                false
            } else if seen.insert(outline_key(&outline)) {
                true
            } else {
                self.duplicate.add(line);
                false
            };
            self.kept.push(kept);
        }
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
        let (open_edges, open_examples) = closed::open_edges(obj, &self.first, &self.kept);
        ModelReport {
            path: self.path.to_owned(),
            positions: obj.positions.len(),
            texcoords: obj.texcoords.len(),
            normals: obj.normals.len(),
            faces: obj.len(),
            triangles: sides.clone().map(|sides| sides - 2).sum(),
            max_corners: sides.max().unwrap_or(0),
            area: self.areas.iter().map(|area| area.length()).sum(),
            bounds: Bounds::of_points(used().map(|(p, _)| *p)),
            closed: open_edges == 0,
            open_edges,
            open_examples,
            kept_triangles: 0,
            objects: obj.tallies.objects.count as usize,
            groups: obj.tallies.groups.count as usize,
            polylines: obj.tallies.lines.count as usize,
            unused_positions: obj.positions.len() - used().count(),
            degenerate_faces: self.degenerate.count as usize,
            duplicate_faces: self.duplicate.count as usize,
            materials: obj.materials.iter().map(|(name, _)| name.clone()).collect(),
            textures: self.library.textures.clone(),
            warnings: Vec::new(),
        }
    }

    /// The model, repaired.
    pub(super) fn model(mut self) -> Result<Model, ModelError> {
        let mut warnings = std::mem::take(&mut self.library.warnings);
        let materials = self.materials(&mut warnings);
        self.warn_of_repairs(&mut warnings);
        let wanted = self.wanting_normals();
        if wanted.contains(&true) {
            normals::complete(&mut self.obj, &self.areas, &self.first, &wanted);
        }
        self.first = Vec::new();
        let has_colors = !self.obj.colors.is_empty();
        let (corners, material_of, [torn, turned]) = self.triangles(&materials);
        if corners.is_empty() {
            return Err(ModelError::NoArea { path: self.path.to_owned() });
        }
        if torn.count > 0 {
            let message = format!(
                "filled {} only in part, as the outline crosses itself{}",
                faces(torn),
                first(torn)
            );
            warnings.push(self.warning(torn, message));
        }
        if turned.count > 0 {
            let message = format!(
                "turned {} over, whose normals point to the back{}",
                faces(turned),
                first(turned)
            );
            warnings.push(self.warning(turned, message));
        }
        let mesh = self.mesh(corners, has_colors)?;
        warnings.sort_by(|a, b| (&a.file, a.line).cmp(&(&b.file, b.line)));
        Ok(Model { mesh, materials: materials.list, material_of, warnings })
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
        let t = self.degenerate;
        warn(t, format!("dropped {} without area{}", faces(t), first(t)));
        let t = self.duplicate;
        warn(t, format!("dropped {} given before{}", faces(t), first(t)));
        let t = self.repeated;
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
        let lacks = |corner: usize| match obj.corner_normals.get(corner) {
            None | Some(&NONE) => true,
            Some(&normal) => obj.normals[normal as usize] == Vec3::ZERO,
        };
        (0..obj.len()).map(|face| self.kept[face] && obj.face(face).any(lacks)).collect()
    }

    /// The triangles as places in the lists of corners, and their materials; and the faces that are not wholly filled, and
    /// those that were turned over.
    fn triangles(&self, materials: &Materials) -> (Vec<[u32; 3]>, Vec<u32>, [Tally; 2]) {
        let obj = &self.obj;
        let mut triangulator = Triangulator::default();
        let (mut triangles, mut material_of) = (Vec::new(), Vec::new());
        let room = obj.corners.len().saturating_sub(2 * obj.len());
        triangles.reserve_exact(room);
        material_of.reserve_exact(room);
        let (mut torn, mut turned) = (Tally::default(), Tally::default());
        let mut points = Vec::new();
        for (k, section) in obj.sections.iter().enumerate() {
            let end = obj.sections.get(k + 1).map_or(obj.len(), |next| next.first_face as usize);
            let [textured, bare] = match section.material {
                NONE => [0, 0],
                number => materials.of[number as usize],
            };
            for face in (section.first_face as usize..end).filter(|face| self.kept[*face]) {
                let range = obj.face(face);
                let has_uv = !obj.corner_texcoords.is_empty()
                    && obj.corner_texcoords[range.clone()].iter().all(|t| *t != NONE);
                let material = if has_uv { textured } else { bare };
                points.clear();
                points
                    .extend(obj.corners[range.clone()].iter().map(|c| obj.positions[*c as usize]));
                let cut = triangulator.cut(&points);
                if points.len() > 4 && is_torn(&points, cut, self.areas[face]) {
                    torn.add(obj.lines[face]);
                }
                let is_turned = self.is_turned(face);
                if is_turned {
                    turned.add(obj.lines[face]);
                }
                for triangle in cut {
                    if has_area(&triangle.map(|c| points[c as usize])) {
                        let [a, b, c] = *triangle;
                        let triangle = if is_turned { [a, c, b] } else { [a, b, c] };
                        triangles.push(triangle.map(|c| range.start as u32 + c));
                        material_of.push(material);
                    }
                }
            }
        }
        (triangles, material_of, [torn, turned])
    }

    /// Whether the normals that the file gives to a face point to its back.
    fn is_turned(&self, face: usize) -> bool {
        let obj = &self.obj;
        let range = obj.face(face);
        let Some(normals) = obj.corner_normals.get(range) else {
            return false;
        };
        let given =
            normals.iter().filter_map(|n| obj.normals[..self.given_normals].get(*n as usize));
        given.map(|n| n.as_dvec3()).sum::<DVec3>().dot(self.areas[face]) < 0.0
    }

    /// The mesh of triangles of corners: corners that agree in position, surface coordinates and normal become one vertex.
    fn mesh(self, mut triangles: Vec<[u32; 3]>, has_colors: bool) -> Result<Mesh, ModelError> {
        let obj = self.obj;
        let mut vertices = Vertices::new(&obj);
        for corner in triangles.iter_mut().flatten() {
            *corner = vertices.place(&obj, *corner as usize);
        }
        let keys = vertices.keys;
        let is_colored = has_colors;
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
            tints: if is_colored { tints(&obj.colors, &keys) } else { Vec::new() },
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

/// Whether the triangles of a polygon leave out some of its area.
fn is_torn(points: &[DVec3], cut: &[[u32; 3]], area: DVec3) -> bool {
    let part = |t: &[u32; 3]| vector_area(&t.map(|c| points[c as usize])).length();
    cut.iter().map(part).sum::<f64>() < 0.999 * area.length()
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

/// Whether a polygon has an area that is not only rounding.
fn spans_area(points: &[DVec3], area: DVec3) -> bool {
    if let &[a, b, c] = points {
        return has_area(&[a, b, c]);
    }
    area != DVec3::ZERO
        || points.windows(3).any(|w| matches!(*w, [a, b, c] if has_area(&[a, b, c])))
}

/// A number for the outline of a face that is the same wherever it begins and whichever way round it goes.
fn outline_key(outline: &[u32]) -> u64 {
    let count = outline.len();
    let start = (0..count).min_by_key(|k| outline[*k]).unwrap_or(0);
    let (next, last) = (outline[(start + 1) % count], outline[(start + count - 1) % count]);
    let mut key = count as u64;
    for k in 0..count {
        let corner = if next <= last { start + k } else { start + count - k };
        key = mix(key ^ u64::from(outline[corner % count])).wrapping_add(key << 1);
    }
    key
}

/// The vertices that differ in position, surface coordinates or normal.
struct Vertices {
    keys: Vec<[u32; 3]>,
    /// The first vertex at each position.
    at: Vec<u32>,
    /// The next vertex at the same position.
    next: Vec<u32>,
    /// Where a position has too many to go through them.
    crowded: NumberMap<Vec<u32>>,
}

/// The longest list of vertices of one position that is searched one by one.
const CROWD: usize = 16;

impl Vertices {
    fn new(obj: &Obj) -> Self {
        let at = vec![NONE; obj.positions.len()];
        Self { keys: Vec::new(), at, next: Vec::new(), crowded: NumberMap::default() }
    }

    /// The vertex of a corner.
    fn place(&mut self, obj: &Obj, corner: usize) -> u32 {
        let attribute = |list: &[u32]| list.get(corner).copied().unwrap_or(NONE);
        let p = obj.corners[corner];
        let key = [p, attribute(&obj.corner_texcoords), attribute(&obj.corner_normals)];
        let mut vertex = self.at[p as usize];
        for _ in 0..CROWD {
            if vertex == NONE {
                return self.add(key);
            }
            if self.keys[vertex as usize] == key {
                return vertex;
            }
            vertex = self.next[vertex as usize];
        }
        let hash = mix(mix(u64::from(key[0]) << 32 | u64::from(key[1])) ^ u64::from(key[2]));
        let known = self.crowded.entry(hash).or_default();
        if let Some(vertex) = known.iter().find(|v| self.keys[**v as usize] == key) {
            return *vertex;
        }
        known.push(self.keys.len() as u32);
        self.keys.push(key);
        self.next.push(NONE);
        self.keys.len() as u32 - 1
    }

    fn add(&mut self, key: [u32; 3]) -> u32 {
        let vertex = self.keys.len() as u32;
        self.keys.push(key);
        self.next.push(self.at[key[0] as usize]);
        self.at[key[0] as usize] = vertex;
        vertex
    }
}
