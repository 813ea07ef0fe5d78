//! The geometry and the rays of the ray-query benchmark: spheres or meshes in a box, and camera, shadow and random rays.

use std::{collections::HashMap, f64::consts::TAU, sync::Arc};

use glam::DVec3;
use whitted::{
    accel::Accel,
    geometry::{
        Bounds, Mesh, Ray, Shape, Sphere,
        mesh::{Attributes, has_area},
    },
};

/// Pixels along each side of the camera's picture.
pub(crate) const SIDE: usize = 600;

/// The point light of the shadow rays.
pub(crate) const LIGHT: DVec3 = DVec3::new(30.0, 40.0, -10.0);

/// SplitMix64.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    fn uniform(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// What is to be traced.
pub(crate) struct Geometry {
    /// The primitives.
    pub(crate) shapes: Vec<Shape>,
    /// Where random rays start.
    pub(crate) bounds: Bounds,
}

const BOX: Bounds =
    Bounds { min: DVec3::new(-40.0, -14.0, -190.0), max: DVec3::new(40.0, 40.0, -60.0) };

fn single(v: DVec3) -> DVec3 {
    v.as_vec3().as_dvec3()
}

fn centers(count: usize) -> (Vec<DVec3>, f64) {
    let mut random = Random(1);
    let centers = (0..count)
        .map(|_| {
            let x = -40.0 + 80.0 * random.uniform();
            let y = -14.0 + 54.0 * random.uniform();
            let z = -190.0 + 130.0 * random.uniform();
            random.uniform(); // the material
            single(DVec3::new(x, y, z))
        })
        .collect();
    (centers, f64::from((1.35 * (1000.0 / count as f64).sqrt()) as f32))
}

/// `count` spheres.
pub(crate) fn spheres(count: usize) -> Geometry {
    let (centers, radius) = centers(count);
    let sphere = |c: &DVec3| Sphere::try_new(*c, radius).expect("a sphere").into();
    Geometry { shapes: centers.iter().map(sphere).collect(), bounds: BOX }
}

/// `count` spheres, each an icosahedron divided `level` times.
pub(crate) fn icospheres(count: usize, level: usize) -> Geometry {
    let (centers, radius) = centers(count);
    let (corners, faces) = icosphere(level);
    let vertices =
        centers.iter().flat_map(|c| corners.iter().map(move |v| single(*c + *v * radius)));
    let starts = (0..count).map(|k| k * corners.len());
    let triangles =
        starts.flat_map(|start| faces.iter().map(move |f| f.map(|k| (start + k) as u32)));
    Geometry { shapes: faces_of(vertices.collect(), triangles.collect()), bounds: BOX }
}

/// The triangles of a mesh.
fn faces_of(vertices: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> Vec<Shape> {
    let mesh = Mesh::try_new(vertices, triangles, Attributes::default()).expect("a mesh");
    Arc::new(mesh).faces().map(Shape::from).collect()
}

fn icosphere(level: usize) -> (Vec<DVec3>, Vec<[usize; 3]>) {
    let g = f64::midpoint(1.0, 5.0_f64.sqrt());
    let corners = [
        [-1.0, g, 0.0],
        [1.0, g, 0.0],
        [-1.0, -g, 0.0],
        [1.0, -g, 0.0],
        [0.0, -1.0, g],
        [0.0, 1.0, g],
        [0.0, -1.0, -g],
        [0.0, 1.0, -g],
        [g, 0.0, -1.0],
        [g, 0.0, 1.0],
        [-g, 0.0, -1.0],
        [-g, 0.0, 1.0],
    ];
    let mut vertices: Vec<DVec3> =
        corners.iter().map(|c| DVec3::from_array(*c).normalize()).collect();
    let mut faces = vec![
        [0, 11, 5],
        [0, 5, 1],
        [0, 1, 7],
        [0, 7, 10],
        [0, 10, 11],
        [1, 5, 9],
        [5, 11, 4],
        [11, 10, 2],
        [10, 7, 6],
        [7, 1, 8],
        [3, 9, 4],
        [3, 4, 2],
        [3, 2, 6],
        [3, 6, 8],
        [3, 8, 9],
        [4, 9, 5],
        [2, 4, 11],
        [6, 2, 10],
        [8, 6, 7],
        [9, 8, 1],
    ];
    for _ in 0..level {
        let mut middles = HashMap::new();
        let mut middle = |a: usize, b: usize| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                vertices.push(((vertices[a] + vertices[b]) / 2.0).normalize());
                vertices.len() - 1
            })
        };
        faces = faces
            .iter()
            .flat_map(|&[a, b, c]| {
                let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
                [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
            })
            .collect();
    }
    (vertices, faces)
}

/// The rays of the camera, row by row.
pub(crate) fn camera() -> Vec<Ray> {
    let ray = |i: usize, j: usize| {
        let x = -10.0 + 20.0 * (i as f64 + 0.5) / SIDE as f64;
        let y = 10.0 - 20.0 * (j as f64 + 0.5) / SIDE as f64;
        Ray::new(DVec3::ZERO, single(DVec3::new(x, y, -40.0).normalize()))
    };
    (0..SIDE * SIDE).map(|k| ray(k % SIDE, k / SIDE)).collect()
}

/// From each hit of the camera's rays to the light; the end of each is 1.
pub(crate) fn shadow(accel: &Accel) -> Vec<Ray> {
    let from = |ray: &Ray| {
        let hit = accel.nearest(ray, f64::INFINITY)?;
        let surface = accel.shape(hit.primitive).surface(ray, &hit);
        let dir = LIGHT - surface.point;
        // The light does not reach the inside of a solid: such a ray is one to the other side of its own surface.
        Some(surface.leave(&hit, dir, dir.dot(surface.normal) < 0.0))
    };
    camera().iter().filter_map(from).collect()
}

/// `count` rays from anywhere within `bounds` to anywhere.
pub(crate) fn random(bounds: &Bounds, count: usize) -> Vec<Ray> {
    let mut random = Random(7);
    let mut ray = || {
        let u = DVec3::new(random.uniform(), random.uniform(), random.uniform());
        let origin = single(bounds.min + bounds.extent() * u);
        let c = 2.0 * random.uniform() - 1.0;
        let (sin, cos) = (TAU * random.uniform()).sin_cos();
        let s = (1.0 - c * c).sqrt();
        Ray::new(origin, single(DVec3::new(s * cos, s * sin, c)))
    };
    (0..count).map(|_| ray()).collect()
}

/// The mesh of an OBJ file's `v` and `f` lines, made to fit a box about (0, 0, −100) with a largest side of 40.
pub(crate) fn mesh(text: &str) -> Geometry {
    let (mut vertices, mut faces) = (Vec::new(), Vec::new());
    for line in text.lines() {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => {
                let x: Vec<f64> = words.map(|word| word.parse().expect("a coordinate")).collect();
                vertices.push(DVec3::new(x[0], x[1], x[2]));
            }
            Some("f") => {
                let index = |word: &str| word.split('/').next().expect("a corner").parse::<u32>();
                let corners: Vec<u32> =
                    words.map(|word| index(word).expect("an index") - 1).collect();
                faces.extend(corners[1..].windows(2).map(|w| [corners[0], w[0], w[1]]));
            }
            _ => {}
        }
    }
    let box_of = Bounds::of_points(vertices.iter().copied());
    let fit =
        |v: &DVec3| single((*v - box_of.center()) * (40.0 / box_of.size()) + DVec3::Z * -100.0);
    let vertices: Vec<DVec3> = vertices.iter().map(fit).collect();
    let has_area = |face: &[u32; 3]| has_area(&face.map(|k| vertices[k as usize]));
    faces.retain(has_area);
    let bounds = Bounds::of_points(vertices.iter().copied());
    Geometry { shapes: faces_of(vertices, faces), bounds }
}
