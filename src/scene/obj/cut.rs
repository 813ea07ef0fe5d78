//! Faces into triangles of corners.

use std::ops::Range;

use glam::DVec3;
use rayon::prelude::*;

use super::{
    faces::blocks,
    lists::{NONE, Obj, Tally},
};
use crate::geometry::{
    mesh::has_area,
    triangulate::{Triangulator, vector_area},
};

/// The triangles of the faces of a model.
#[derive(Debug, Default)]
pub(super) struct Triangles {
    /// Places in the lists of corners.
    pub(super) corners: Vec<[u32; 3]>,
    /// The material of each.
    pub(super) material_of: Vec<u32>,
    /// Faces that are not wholly filled.
    pub(super) torn: Tally,
    /// Faces that were turned over.
    pub(super) turned: Tally,
}

/// The triangles of the `kept` faces; `materials` are those of faces with and without surface coordinates for each
/// material of the file, and the first `given_normals` normals are the file's own.
pub(super) fn triangles(
    obj: &Obj,
    kept: &[bool],
    materials: &[[u32; 2]],
    given_normals: usize,
) -> Triangles {
    let cutter = Cutter { obj, kept, materials, given_normals };
    let parts: Vec<Triangles> = blocks(obj)
        .map_init(Triangulator::default, |triangulator, faces| cutter.cut(triangulator, faces))
        .collect();
    let mut all = Triangles::default();
    let count = parts.iter().map(|part| part.corners.len()).sum();
    all.corners.reserve_exact(count);
    all.material_of.reserve_exact(count);
    for part in parts {
        all.corners.extend(part.corners);
        all.material_of.extend(part.material_of);
        all.torn.join(part.torn);
        all.turned.join(part.turned);
    }
    all
}

struct Cutter<'a> {
    obj: &'a Obj,
    kept: &'a [bool],
    materials: &'a [[u32; 2]],
    given_normals: usize,
}

impl Cutter<'_> {
    fn cut(&self, triangulator: &mut Triangulator, faces: Range<usize>) -> Triangles {
        let obj = self.obj;
        let mut found = Triangles::default();
        let mut points = Vec::new();
        for (section, faces) in obj.sections_of(faces) {
            let [textured, bare] = match section.material {
                NONE => [0, 0],
                number => self.materials[number as usize],
            };
            for face in faces.filter(|face| self.kept[*face]) {
                let range = obj.face(face);
                let has_uv = !obj.corner_texcoords.is_empty()
                    && obj.corner_texcoords[range.clone()].iter().all(|t| *t != NONE);
                points.clear();
                points
                    .extend(obj.corners[range.clone()].iter().map(|c| obj.positions[*c as usize]));
                let cut = triangulator.cut(&points);
                let area = vector_area(&points);
                if points.len() > 4 && is_torn(&points, cut, area) {
                    found.torn.add(obj.lines[face]);
                }
                let is_turned = self.is_turned(range.clone(), area);
                if is_turned {
                    found.turned.add(obj.lines[face]);
                }
                for triangle in cut {
                    if has_area(&triangle.map(|c| points[c as usize])) {
                        let [a, b, c] = *triangle;
                        let triangle = if is_turned { [a, c, b] } else { [a, b, c] };
                        found.corners.push(triangle.map(|c| range.start as u32 + c));
                        found.material_of.push(if has_uv { textured } else { bare });
                    }
                }
            }
        }
        found
    }

    /// Whether the normals that the file gives to the corners of a face point to its back.
    fn is_turned(&self, corners: Range<usize>, area: DVec3) -> bool {
        let obj = self.obj;
        let Some(normals) = obj.corner_normals.get(corners) else {
            return false;
        };
        let given =
            normals.iter().filter_map(|n| obj.normals[..self.given_normals].get(*n as usize));
        given.map(|n| n.as_dvec3()).sum::<DVec3>().dot(area) < 0.0
    }
}

/// Whether the triangles of a polygon leave out some of its area.
fn is_torn(points: &[DVec3], cut: &[[u32; 3]], area: DVec3) -> bool {
    let part = |t: &[u32; 3]| vector_area(&t.map(|c| points[c as usize])).length();
    cut.iter().map(part).sum::<f64>() < 0.999 * area.length()
}
