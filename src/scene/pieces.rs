//! The pieces of a scene: its triangles, parallelograms and polygons that hang together, through edges or single corners.

use glam::{DMat3, DVec3};

use super::{disjoint::DisjointSets, obj::weld::weld};
use crate::geometry::{Brick, Mesh, Shape};

/// Turns of a line towards the longest direction of a piece; one that is much longer than wide takes two or three.
const TURNS: usize = 8;

/// The pieces of a mesh, each in the brick about it. Corners at the same place are the same corner.
pub(super) fn of_mesh(mesh: &Mesh) -> Vec<Brick> {
    let triangles = mesh.triangles();
    let edges = triangles.iter().flat_map(|[a, b, c]| [[*a, *b], [*a, *c]]);
    bricks(mesh.vertices(), edges)
}

/// The same of all flat shapes but the triangles of meshes.
pub(super) fn of_flat<'a>(shapes: impl Iterator<Item = &'a Shape>) -> Vec<Brick> {
    let (mut vertices, mut edges) = (Vec::new(), Vec::new());
    for shape in shapes.filter(|shape| shape.is_flat_alone()) {
        let first = vertices.len();
        shape.for_each_point(|p| vertices.push(p));
        edges.extend((first + 1..vertices.len()).map(|k| [first as u32, k as u32]));
    }
    bricks(&vertices, edges.into_iter())
}

/// The pieces of which `edges` join the vertices.
fn bricks(vertices: &[DVec3], edges: impl Iterator<Item = [u32; 2]>) -> Vec<Brick> {
    let corners = weld(vertices);
    let mut piece_of = pieces(&corners, edges);
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
    pieces.iter().map(Piece::brick).collect()
}

/// The first vertex of each vertex's piece; `corners` are the first ones in the same places.
fn pieces(corners: &[u32], edges: impl Iterator<Item = [u32; 2]>) -> Vec<u32> {
    let mut sets = DisjointSets::of_links(corners);
    for [a, b] in edges {
        sets.join(a, b);
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
    /// Unit vectors at right angles, the direction in which it is longest first.
    directions: [DVec3; 3],
    /// The least and the largest extent in these directions, from the middle.
    low: DVec3,
    high: DVec3,
}

impl Piece {
    fn at(origin: DVec3) -> Self {
        let (sum, products) = (DVec3::ZERO, DMat3::ZERO);
        let (low, high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        Self { origin, count: 0.0, sum, products, directions: DVec3::AXES, low, high }
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

    /// Turns the directions to those in which the vertices spread most.
    fn turn(&mut self) {
        let m = self.middle();
        let spread =
            self.products * (1.0 / self.count) - DMat3::from_cols(m * m.x, m * m.y, m * m.z);
        let first = longest_of(&spread, |v| v).unwrap_or(DVec3::X);
        let second = longest_of(&spread, |v| v.reject_from_normalized(first))
            .unwrap_or_else(|| first.any_orthonormal_vector());
        self.directions = [first, second, first.cross(second)];
    }

    /// Lengthens and widens the brick until it holds the vertex.
    fn reach(&mut self, vertex: DVec3) {
        let p = vertex - self.origin - self.middle();
        let along = DVec3::from(self.directions.map(|direction| p.dot(direction)));
        self.low = self.low.min(along);
        self.high = self.high.max(along);
    }

    fn brick(&self) -> Brick {
        let (center, half) = ((self.high + self.low) / 2.0, (self.high - self.low) / 2.0);
        let [u, v, w] = self.directions;
        let off = u * center.x + v * center.y + w * center.z;
        let middle = self.origin + self.middle() + off;
        Brick { middle, halves: [u * half.x, v * half.y, w * half.z] }
    }
}

/// The unit vector along which `spread` is largest, of the directions that `within` leaves. None if it leaves nothing of it.
fn longest_of(spread: &DMat3, within: impl Fn(DVec3) -> DVec3) -> Option<DVec3> {
    let longer = |a: DVec3, b: DVec3| if b.length_squared() > a.length_squared() { b } else { a };
    let columns = [spread.x_axis, spread.y_axis, spread.z_axis].map(&within);
    let mut direction = longer(longer(columns[0], columns[1]), columns[2]).try_normalize()?;
    for _ in 0..TURNS {
        direction = within(*spread * direction).try_normalize()?;
    }
    within(direction).try_normalize()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Quad, Sphere, Triangle, mesh::Attributes};

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

    /// Oracle: boxes whose places and edges are known.
    #[test]
    fn boxes_are_pieces_with_their_axes() {
        let long = DVec3::new(3.0, -2.0, 6.0) / 7.0;
        let (u, v) = long.any_orthonormal_pair();
        let bars = [
            (DVec3::new(5.0, 1.0, -3.0), long, [20.0, 0.3, 0.1]),
            (DVec3::new(-40.0, 1e3, 2.0), DVec3::Y, [1.0, 0.6, 0.001]),
            (DVec3::ZERO, v, [4.0, 0.5, 0.02]),
        ];
        let mut vertices = Vec::new();
        for (center, along, [length, width, height]) in bars {
            let (a, b) = if along == long { (u, v) } else { along.any_orthonormal_pair() };
            vertices.extend(bar(center, [along * length, a * width, b * height]));
        }
        let triangles = (0..vertices.len() as u32 / 3).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]);
        let triangles = triangles.collect();
        let mesh = Mesh::try_new(vertices, triangles, Attributes::default()).expect("a mesh");
        let bricks = of_mesh(&mesh);
        assert_eq!(bricks.len(), bars.len());
        for (brick, (center, along, [length, width, height])) in bricks.into_iter().zip(bars) {
            let [a, b, c] = brick.halves.map(|half| half.length() * 2.0);
            assert!((a / length - 1.0).abs() < 1e-3, "{a} {length}");
            assert!((b / width - 1.0).abs() < 1e-3, "{b} {width}");
            assert!((c / height - 1.0).abs() < 1e-3, "{c} {height}");
            assert!((brick.middle - center).length() < 1e-3 * length);
            assert!((brick.halves[0].dot(along).abs() / length - 0.5).abs() < 1e-3);
        }
    }

    /// Oracle: what shares a corner, counted by hand, and the sides of a rectangle; a sphere is no piece.
    #[test]
    fn flat_shapes_that_share_corners_are_one_piece() {
        let quad = |corner: DVec3, a: DVec3, b: DVec3| {
            Shape::from(Quad::try_new(corner, a, b).expect("a quad"))
        };
        let far = DVec3::new(50.0, -7.0, 3.0);
        let corners = [far, far + DVec3::X, far + DVec3::Z];
        let shapes = [
            quad(DVec3::ZERO, DVec3::X * 4.0, DVec3::Y),
            Sphere::try_new(DVec3::ZERO, 1.0).expect("a sphere").into(),
            Triangle::try_new(corners).expect("a triangle").into(),
            quad(DVec3::X * 4.0, DVec3::X * 5.0, DVec3::Y),
        ];
        let bricks = of_flat(shapes.iter());
        assert_eq!(bricks.len(), 2);
        let Brick { middle, halves: [a, b, c] } = bricks[0];
        assert!(middle.distance(DVec3::new(4.5, 0.5, 0.0)) < 1e-9, "{middle}");
        assert!((a.length() - 4.5).abs() < 0.02 && (b.length() - 0.5).abs() < 0.1, "{a} {b}");
        assert!(c.length() < 1e-9, "{c}");
    }
}
