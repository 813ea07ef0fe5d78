//! What a model file holds, and what was odd about it.

use crate::{geometry::Bounds, scene::warning::Warning};

/// The contents of a model file, as counted before anything was dropped or repaired.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelReport {
    /// The file.
    pub path: String,
    /// Vertex positions.
    pub positions: usize,
    /// Texture coordinates.
    pub texcoords: usize,
    /// Normals.
    pub normals: usize,
    /// Faces of three corners or more.
    pub faces: usize,
    /// The sum of corners − 2 over the faces.
    pub triangles: usize,
    /// The corners of the largest face.
    pub max_corners: usize,
    /// The sum over the faces of the lengths of their vector areas.
    pub area: f64,
    /// The box about all positions that faces use.
    pub bounds: Bounds,
    /// Whether the faces close a space, each edge being used once in either direction.
    pub closed: bool,
    /// How many edges keep it from being closed.
    pub open_edges: usize,
    /// Some of these edges, for the user to look at.
    pub open_examples: Vec<OpenEdge>,
    /// Triangles in the tree: what is left after repairs.
    pub kept_triangles: usize,
    /// Objects.
    pub objects: usize,
    /// Groups.
    pub groups: usize,
    /// Points and polylines, which rays do not meet.
    pub polylines: usize,
    /// Positions that no face uses.
    pub unused_positions: usize,
    /// Faces that were left out because they have no area.
    pub degenerate_faces: usize,
    /// Faces that were left out because there was the same before.
    pub duplicate_faces: usize,
    /// The names of the materials, in order of first use.
    pub materials: Vec<String>,
    /// The pictures that these materials wear.
    pub textures: Vec<TextureReport>,
    /// What was odd.
    pub warnings: Vec<Warning>,
}

/// A picture that a material library names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TextureReport {
    /// Its name in the library.
    pub name: String,
    /// The material that wears it.
    pub material: String,
    /// Whether it is there and can be read.
    pub found: bool,
}

/// An edge that is not between two faces of the same orientation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OpenEdge {
    /// The line of a face that has it.
    pub line: u32,
    /// Its ends.
    pub from: [f64; 3],
    /// Its ends.
    pub to: [f64; 3],
    /// How many faces use it.
    pub uses: u32,
}
