//! Closed meshes, and rays through their edges and vertices: none may get in or out unseen.
//!
//! Oracle: the answer by construction. A point inside a closed convex mesh cannot be reached from outside, nor left,
//! without a hit; and no hit may be reported where a ray passes the mesh by.

use glam::DVec3;
use whitted::accel::brute;
use whitted::geometry::{Ray, Shape, Triangle};

use super::random::{Random, rays};
use super::subject::vector;

/// Corners and the triangles between them, counterclockwise seen from outside.
#[derive(Clone)]
struct Mesh {
    corners: Vec<DVec3>,
    faces: Vec<[usize; 3]>,
}

impl Mesh {
    fn cube() -> Self {
        let corners = (0..8)
            .map(|k| DVec3::new(f64::from(k & 1), f64::from(k >> 1 & 1), f64::from(k >> 2)))
            .map(|p| p * 2.0 - 1.0)
            .collect();
        let squares =
            [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let faces = squares.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
        Self { corners, faces }
    }

    /// An octahedron, each face cut in four, twice, about the unit sphere, on a grid of 2⁻¹².
    fn sphere() -> Self {
        let corners = [DVec3::X, DVec3::Y, DVec3::Z].iter().flat_map(|v| [*v, -*v]).collect();
        let mut faces = vec![];
        for (x, y, z) in (0..8).map(|k| (k & 1, k >> 1 & 1, k >> 2)) {
            let (a, b, c) = (x, 2 + y, 4 + z);
            faces.push(if (x + y + z) % 2 == 0 { [a, b, c] } else { [a, c, b] });
        }
        let mut mesh = Self { corners, faces };
        for _ in 0..2 {
            mesh = mesh.refined();
        }
        for corner in &mut mesh.corners {
            *corner = (*corner * 4096.0).round() / 4096.0;
        }
        mesh
    }

    fn refined(&self) -> Self {
        let mut corners = self.corners.clone();
        let mut middle = |a: usize, b: usize| {
            let point = (self.corners[a] + self.corners[b]).normalize();
            corners.iter().position(|c| *c == point).unwrap_or_else(|| {
                corners.push(point);
                corners.len() - 1
            })
        };
        let mut faces = vec![];
        for [a, b, c] in &self.faces {
            let (ab, bc, ca) = (middle(*a, *b), middle(*b, *c), middle(*c, *a));
            faces.extend([[*a, ab, ca], [*b, bc, ab], [*c, ca, bc], [ab, bc, ca]]);
        }
        Self { corners, faces }
    }

    fn map(&self, f: impl Fn(DVec3) -> DVec3) -> Self {
        Self { corners: self.corners.iter().map(|p| f(*p)).collect(), faces: self.faces.clone() }
    }

    fn shapes(&self) -> Vec<Shape> {
        let triangle = |face: &[usize; 3]| {
            Triangle::try_new(face.map(|k| self.corners[k])).expect("a triangle").into()
        };
        self.faces.iter().map(triangle).collect()
    }

    /// A corner, or a point of an edge up to rounding.
    fn target(&self, random: &mut Random) -> DVec3 {
        let [a, b, _] = random.pick(&self.faces).map(|k| self.corners[k]);
        match random.below(4) {
            0 => a,
            1 => (a + b) * 0.5,
            _ => a + (b - a) * random.unit(),
        }
    }
}

/// Sends `count` rays through edges and corners, from inside and outside, and returns how many got through.
fn leaks(name: &str, mesh: &Mesh, count: usize, middle: DVec3, spread: DVec3, seed: u64) -> usize {
    let shapes = mesh.shapes();
    let mut random = Random::new(seed);
    let mut leaks = 0;
    for k in 0..count {
        let target = mesh.target(&mut random);
        let inner = if k % 8 == 0 { middle } else { middle + random.in_cube() * spread };
        let out = target - inner;
        let (ray, end) = if k % 2 == 0 {
            (Ray::new(inner, out), f64::INFINITY)
        } else {
            // From outside through the target to the inner point, which is at t = 1.
            let origin = inner + out * random.between(1.5, 4.0);
            (Ray::new(origin, inner - origin), 1.0)
        };
        if brute::nearest(&shapes, &ray, end).is_none() {
            leaks += 1;
            if leaks == 1 {
                let (origin, dir) = (vector(ray.origin), vector(ray.dir));
                println!("{name} is left by Ray::new({origin}, {dir})");
            }
        }
    }
    println!("{name:<40} | {count:>8} | {leaks} out");
    leaks
}

/// Rays that pass a convex mesh by, near enough to its bounding ball, hit nothing.
fn false_hits(name: &str, mesh: &Mesh, count: usize, middle: DVec3, size: DVec3) -> usize {
    let shapes = mesh.shapes();
    let mut random = Random::new(21);
    let mut hits = 0;
    for _ in 0..count {
        // In a plane that supports the mesh, moved off by a millionth of its distance from the middle.
        let normal = random.direction() / size;
        let height = |p: DVec3| normal.dot(p - middle);
        let top = mesh.corners.iter().max_by(|p, q| height(**p).total_cmp(&height(**q)));
        let top = middle + (top.expect("a corner") - middle) * (1.0 + 1e-6);
        let dir = random.across(normal.normalize());
        let ray = Ray::new(top - dir * size.max_element() * random.between(-2.0, 2.0), dir);
        hits += usize::from(brute::nearest(&shapes, &ray, f64::INFINITY).is_some());
    }
    println!("{name:<40} | {count:>8} | {hits} false hits");
    hits
}

fn check(name: &str, mesh: &Mesh, count: usize) {
    let half = DVec3::splat(0.5);
    let mut bad = leaks(name, mesh, count, DVec3::ZERO, half, 17);
    bad += false_hits(name, mesh, count / 10, DVec3::ZERO, DVec3::ONE);
    // Flat as paper, and no rounding in it.
    let flat = DVec3::new(1.0, 2.0_f64.powi(-20), 1.0);
    let paper = mesh.map(|p| p * flat);
    bad +=
        leaks(&format!("{name}, flattened by 2^-20"), &paper, count, DVec3::ZERO, half * flat, 18);
    for k in [20, 30, 40] {
        let shift = DVec3::new(1.0, -1.0, 1.0) * 2.0_f64.powi(k);
        let moved = mesh.map(|p| p + shift);
        let name = format!("{name}, shifted by 2^{k}");
        // Inner points on the grid there is: at 2^40 that is 2^-12.
        bad += leaks(&name, &moved, count / 3, shift, half * 0.5, 19);
    }
    assert!(bad == 0, "{name}: {bad} rays got through");
}

#[test]
fn cube() {
    check("cube", &Mesh::cube(), rays(300_000));
}

#[test]
fn sphere() {
    let mesh = Mesh::sphere();
    assert_eq!((mesh.corners.len(), mesh.faces.len()), (66, 128));
    check("sphere of 128 triangles", &mesh, rays(30_000));
}

/// Axis rays through corners, along edges and in the planes of the faces, with zeros of both signs.
#[test]
fn cube_along_the_axes() {
    let mesh = Mesh::cube();
    let shapes = mesh.shapes();
    let mut random = Random::new(20);
    for _ in 0..rays(20_000) {
        let axis = random.below(3);
        let turn = |v: [f64; 3]| DVec3::from_array([0, 1, 2].map(|k| v[(k + axis) % 3]));
        let grid = |random: &mut Random| random.pick(&[-1.0, -0.5, 0.0, 0.5, 1.0, 0.25]);
        let (u, v) = (grid(&mut random), grid(&mut random));
        let zero = |random: &mut Random| random.sign() * 0.0;
        let dir = turn([zero(&mut random), zero(&mut random), random.sign()]);
        let origin = turn([u, v, 0.0]) - dir * 3.0;
        let hit = brute::nearest(&shapes, &Ray::new(origin, dir), f64::INFINITY);
        let inside = u.abs().max(v.abs()) < 1.0;
        assert!(hit.is_some() || !inside, "{origin}, {dir}");
        assert!(hit.is_none_or(|hit| hit.t == 2.0), "{origin}, {dir}: {hit:?}");
        let past = turn([u.signum() * 1.000_000_1, v, 0.0]) - dir * 3.0;
        assert_eq!(brute::nearest(&shapes, &Ray::new(past, dir), f64::INFINITY), None, "{past}");
    }
}
