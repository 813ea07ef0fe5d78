//! Random shapes and awkward scenes.

use std::sync::Arc;

use glam::{DVec3, Vec3};

use crate::geometry::{
    Cone, Cylinder, Ends, Inward, Mesh, Polygon, Quad, Shape, Sphere, Triangle, mesh::Attributes,
};

/// SplitMix64.
pub(super) struct Random(pub(super) u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    pub(super) fn below(&mut self, n: usize) -> usize {
        (self.next() % n as u64) as usize
    }

    /// From −1 to 1.
    pub(super) fn signed(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// In the cube [−1, 1]³.
    pub(super) fn point(&mut self) -> DVec3 {
        DVec3::new(self.signed(), self.signed(), self.signed())
    }

    /// A unit vector.
    pub(super) fn direction(&mut self) -> DVec3 {
        loop {
            let p = self.point();
            if (0.01..1.0).contains(&p.length()) {
                return p.normalize();
            }
        }
    }
}

pub(super) const KINDS: usize = 10;

pub(super) fn sphere(center: DVec3, radius: f64) -> Shape {
    Sphere::try_new(center, radius).expect("valid").into()
}

pub(super) fn triangle(corners: [DVec3; 3]) -> Shape {
    Triangle::try_new(corners).expect("valid").into()
}

pub(super) fn quad(corner: DVec3, e1: DVec3, e2: DVec3) -> Shape {
    Quad::try_new(corner, e1, e2).expect("valid").into()
}

/// The faces of a mesh, which bend the light if vertices have `normals`.
fn faces(vertices: Vec<DVec3>, triangles: Vec<[u32; 3]>, normals: Vec<Vec3>) -> Vec<Shape> {
    let attributes = Attributes { normals, ..Attributes::default() };
    let mesh = Mesh::try_new(vertices, triangles, attributes).expect("valid");
    Arc::new(mesh).faces().map(Shape::from).collect()
}

/// A shape of about `size` at `center`.
pub(super) fn shape_of(kind: usize, center: DVec3, size: f64, random: &mut Random) -> Shape {
    let ends = if random.below(2) == 0 { Ends::Open } else { Ends::Closed };
    let mut edge = || {
        let v = random.direction() * size;
        // Some along the axes, for flat boxes.
        if random.below(3) == 0 { DVec3::ZERO.with_x(size * random.signed()) } else { v }
    };
    let (a, b) = (edge(), edge());
    let b = if a.cross(b).length() > 0.1 * size * size { b } else { a.any_orthogonal_vector() };
    let shape = match kind {
        0 => return sphere(center, size),
        1 => return triangle([center, center + a, center + b]),
        2 => return quad(center, a, b),
        3 => Cylinder::try_new(center, center + a, size * 0.3, ends).map(Shape::from),
        4 => Cone::try_new(center, center + a, size * 0.3, ends).map(Shape::from),
        5 => Polygon::try_new(vec![center, center + a, center + a + b * 0.5, center + b])
            .map(Shape::from),
        // Slivers.
        6 => return triangle([center, center + a, center + a * 0.5 + b * 1e-6]),
        // The second face of a mesh, flat or smooth.
        7 | 8 => {
            let vertices = vec![center, center + a, center + b, center - a];
            let normals = if kind == 7 { vec![] } else { vec![Vec3::Y, Vec3::X, Vec3::Z, Vec3::X] };
            return faces(vertices, vec![[0, 2, 3], [2, 0, 1]], normals).remove(1);
        }
        _ => return Inward::new(shape_of(3 * random.below(2), center, size, random)).into(),
    };
    shape.expect("valid")
}

/// Scenes that are hard on a tree.
pub(super) fn awkward() -> Vec<(&'static str, Vec<Shape>)> {
    let at = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
    let square = |p: DVec3| quad(p, DVec3::X * 0.1, DVec3::Y * 0.1);
    let grid = |k: usize| at((k % 10) as f64 * 0.1, (k / 10) as f64 * 0.1, 0.0);
    let mesh = |k: usize| {
        let p = grid(k);
        [
            triangle([p, p + DVec3::X * 0.1, p + at(0.1, 0.1, 0.0)]),
            triangle([p, p + at(0.1, 0.1, 0.0), p + DVec3::Y * 0.1]),
        ]
    };
    // Ten squares by ten, which share their corners by index.
    let indexed = |normals: Vec<Vec3>| {
        let corner = |k: u32| at(f64::from(k % 11) * 0.1, f64::from(k / 11) * 0.1, 0.0);
        let corners = (0..10).flat_map(|j| (0..10).map(move |i| 11 * j + i));
        let halves = corners.flat_map(|k| [[k, k + 1, k + 12], [k, k + 12, k + 11]]);
        faces((0..121).map(corner).collect(), halves.collect(), normals)
    };
    let normal = |k: usize| Vec3::new((k as f32).sin(), (k as f32).cos(), 1.0).normalize();
    vec![
        ("identical spheres", vec![sphere(at(1.0, 2.0, 3.0), 0.5); 200]),
        ("identical triangles", vec![triangle([DVec3::X, DVec3::Y, DVec3::Z]); 200]),
        ("identical squares", vec![square(DVec3::ZERO); 100]),
        ("nested", (1..100).map(|k| sphere(DVec3::ZERO, f64::from(k) * 0.01)).collect()),
        ("nested by halves", (0..60).map(|k| sphere(DVec3::ZERO, 0.5_f64.powi(k))).collect()),
        (
            "halving row",
            (0..200)
                .map(|k| sphere(at(0.9_f64.powi(k), 0.0, 0.0), 0.05 * 0.9_f64.powi(k)))
                .collect(),
        ),
        ("flat grid of squares", (0..100).map(|k| square(grid(k))).collect()),
        ("flat mesh", (0..100).flat_map(mesh).collect()),
        ("indexed mesh", indexed(vec![])),
        ("indexed smooth mesh", indexed((0..121).map(normal).collect())),
        ("row", (0..500).map(|k| sphere(at(f64::from(k), 0.0, 0.0), 0.4)).collect()),
        (
            "one point",
            (0..100).map(|k| sphere(at(5.0, 5.0, 5.0), 1e-9 * f64::from(1 + k % 3))).collect(),
        ),
        (
            "far from the origin",
            (0..100).map(|k| sphere(grid(k as usize) * 10.0 + 1e12, 0.25)).collect(),
        ),
        ("tiny", (0..100).map(|k| sphere(grid(k as usize) * 1e-30, 3e-32)).collect()),
        (
            "all scales",
            (0..60)
                .map(|k| sphere(at(10.0_f64.powi(k - 30), 1.0, 0.0), 10.0_f64.powi(k - 31)))
                .collect(),
        ),
    ]
}
