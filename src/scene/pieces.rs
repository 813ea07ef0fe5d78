//! The pieces of a mesh: its triangles that hang together, through edges or single corners.

use glam::{DMat3, DVec3};

use super::{disjoint::DisjointSets, obj::weld::weld};
use crate::geometry::Mesh;

/// A straight line and the distance from it within which a piece lies.
pub(crate) type Rod = ([DVec3; 2], f64);

/// Turns of the line towards the longest direction of a piece; one that is much longer than wide takes two or three.
const TURNS: usize = 8;

/// The pieces of a mesh, each in the rod about it. Corners at the same place are the same corner.
pub(super) fn rods(mesh: &Mesh) -> Vec<Rod> {
    let vertices = mesh.vertices();
    let corners = weld(vertices);
    let mut piece_of = pieces(mesh, &corners);
    let mut pieces = Vec::new();
    for vertex in 0..vertices.len() {
        let first = piece_of[vertex] as usize;
        // Every piece is named by its first vertex.
        if first == vertex {
            piece_of[vertex] = pieces.len() as u32;
            pieces.push(Piece::at(vertices[vertex]));
        } else {
            piece_of[vertex] = piece_of[first];
        }
        // A corner that faces have a vertex each for counts once.
        if corners[vertex] as usize == vertex {
            pieces[piece_of[vertex] as usize].add(vertices[vertex]);
        }
    }
    for piece in &mut pieces {
        piece.turn();
    }
    for (vertex, piece) in vertices.iter().zip(&piece_of) {
        pieces[*piece as usize].reach(*vertex);
    }
    pieces.iter().map(Piece::rod).collect()
}

/// The first vertex of each vertex's piece; `corners` are the first ones in the same places.
fn pieces(mesh: &Mesh, corners: &[u32]) -> Vec<u32> {
    let mut sets = DisjointSets::of_links(corners);
    for [a, b, c] in mesh.triangles() {
        sets.join(*a, *b);
        sets.join(*a, *c);
    }
    (0..corners.len() as u32).map(|vertex| sets.find(vertex)).collect()
}

/// What is known of a piece; lengths are from its first vertex.
struct Piece {
    origin: DVec3,
    count: f64,
    sum: DVec3,
    /// Sums of products of coordinates.
    products: DMat3,
    direction: DVec3,
    /// The part of the line beside which vertices lie, from the middle.
    from: f64,
    to: f64,
    /// The largest squared distance from the line.
    square: f64,
}

impl Piece {
    fn at(origin: DVec3) -> Self {
        let (sum, products, direction) = (DVec3::ZERO, DMat3::ZERO, DVec3::X);
        Self { origin, count: 0.0, sum, products, direction, from: 0.0, to: 0.0, square: 0.0 }
    }

    fn add(&mut self, vertex: DVec3) {
        let p = vertex - self.origin;
        self.count += 1.0;
        self.sum += p;
        self.products += DMat3::from_cols(p * p.x, p * p.y, p * p.z);
    }

    fn middle(&self) -> DVec3 {
        self.sum / self.count
    }

    /// Turns the line to the direction in which the vertices spread most.
    fn turn(&mut self) {
        let m = self.middle();
        let spread =
            self.products * (1.0 / self.count) - DMat3::from_cols(m * m.x, m * m.y, m * m.z);
        let longest =
            |a: DVec3, b: DVec3| if b.length_squared() > a.length_squared() { b } else { a };
        self.direction = longest(longest(spread.x_axis, spread.y_axis), spread.z_axis);
        for _ in 0..TURNS {
            self.direction =
                (spread * self.direction.normalize_or(DVec3::X)).normalize_or(DVec3::X);
        }
    }

    /// Lengthens and widens the rod until it holds the vertex.
    fn reach(&mut self, vertex: DVec3) {
        let p = vertex - self.origin - self.middle();
        let along = p.dot(self.direction);
        self.from = self.from.min(along);
        self.to = self.to.max(along);
        self.square = self.square.max((p - self.direction * along).length_squared());
    }

    fn rod(&self) -> Rod {
        let middle = self.origin + self.middle();
        ([self.from, self.to].map(|t| middle + self.direction * t), self.square.sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::mesh::Attributes;

    /// The twelve triangles of a box, each with corners of its own.
    fn bar(center: DVec3, edges: [DVec3; 3]) -> Vec<DVec3> {
        let corner = |k: usize| {
            let half = |bit: usize| if k >> bit & 1 == 0 { -0.5 } else { 0.5 };
            center + edges[0] * half(0) + edges[1] * half(1) + edges[2] * half(2)
        };
        let sides =
            [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];
        let triangles = sides.into_iter().flat_map(|[a, b, c, d]| [a, b, c, a, c, d]);
        triangles.map(corner).collect()
    }

    /// Oracle: boxes whose axes and half diagonals are known.
    #[test]
    fn boxes_are_pieces_with_their_axes() {
        let long = DVec3::new(3.0, -2.0, 6.0) / 7.0;
        let (u, v) = long.any_orthonormal_pair();
        let bars = [
            (DVec3::new(5.0, 1.0, -3.0), long, 20.0, 0.3),
            (DVec3::new(-40.0, 1e3, 2.0), DVec3::Y, 1.0, 0.001),
            (DVec3::ZERO, v, 4.0, 0.5),
        ];
        let mut vertices = Vec::new();
        for (center, along, length, width) in bars {
            let (a, b) = if along == long { (u, v) } else { along.any_orthonormal_pair() };
            vertices.extend(bar(center, [along * length, a * width, b * width]));
        }
        let triangles = (0..vertices.len() as u32 / 3).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]);
        let triangles = triangles.collect();
        let mesh = Mesh::try_new(vertices, triangles, Attributes::default()).expect("a mesh");
        let rods = rods(&mesh);
        assert_eq!(rods.len(), bars.len());
        for (([a, b], radius), (center, along, length, width)) in rods.into_iter().zip(bars) {
            assert!((radius / (width * 0.5_f64.sqrt()) - 1.0).abs() < 1e-3, "{radius} {width}");
            assert!((a.distance(b) / length - 1.0).abs() < 1e-3, "{a} {b} {length}");
            assert!((a.midpoint(b) - center).length() < 1e-3 * length);
            assert!(((b - a).dot(along).abs() / length - 1.0).abs() < 1e-3);
        }
    }
}
