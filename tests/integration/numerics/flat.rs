//! Rays that are hard on quads, triangles and polygons.

use glam::DVec3;
use whitted::geometry::Ray;

use super::random::{Random, tenth};
use super::score::sweep;
use super::subject::Subject;

/// A point of the plane and its edges: q + u e₁ + v e₂.
struct Made {
    subject: Subject,
    corner: DVec3,
    edge1: DVec3,
    edge2: DVec3,
}

impl Made {
    fn normal(&self) -> DVec3 {
        self.edge1.cross(self.edge2).normalize()
    }

    fn at(&self, u: f64, v: f64) -> DVec3 {
        self.corner + self.edge1 * u + self.edge2 * v
    }
}

/// A quad or triangle with corners on a grid, so that the quad's other corners are exact.
fn any_flat(random: &mut Random) -> Made {
    let [corner, edge1, edge2] = [(); 3].map(|()| random.on_grid());
    flat(corner, edge1, edge2, random)
}

fn flat(corner: DVec3, edge1: DVec3, edge2: DVec3, random: &mut Random) -> Made {
    let subject = if random.flip() {
        Subject::Quad { corner, edge1, edge2 }
    } else {
        Subject::Triangle { vertices: [corner, corner + edge1, corner + edge2] }
    };
    Made { subject, corner, edge1, edge2 }
}

/// Scores rays that `make` makes for quads and triangles, ever harder.
fn flats(family: &'static str, mut make: impl FnMut(f64, &Made, &mut Random) -> Ray) {
    sweep(family, 9, 1..=14, 1000, |k, random, tally| {
        let made = any_flat(random);
        let ray = make(tenth(k), &made, random);
        tally.score(&made.subject, ray);
    });
}

#[test]
fn grazing() {
    flats("quad, triangle: grazing at 10^-k", |angle, made, random| {
        let normal = made.normal();
        let dir = random.across(normal) + normal * (angle * random.sign());
        let target = made.at(random.between(-0.1, 1.1), random.between(-0.1, 1.1));
        Ray::new(target - dir * random.between(0.1, 5.0), dir)
    });
}

#[test]
fn edges() {
    flats("quad, triangle: aimed 10^-k from an edge", |miss, made, random| {
        let along = random.between(-0.1, 1.1);
        let target = match random.below(3) {
            0 => made.at(along, miss * random.sign()),
            1 => made.at(miss * random.sign(), along),
            _ => made.at(along, 1.0 - along + miss * random.sign()),
        };
        let origin = made.corner + random.in_cube() * 4.0;
        Ray::new(origin, target - origin)
    });
}

#[test]
fn slivers() {
    sweep("quad, triangle: slivers of width 10^-k", 10, 1..=12, 1000, |k, random, tally| {
        // A width on the grid of 2⁻⁵⁰, so that the quad's corners are exact.
        let width = 2.0_f64.powi((-3.322 * f64::from(k)).round() as i32);
        let [corner, edge1] = [(); 2].map(|()| random.on_grid());
        let edge2 = edge1 * f64::from(u8::from(random.flip())) + random.on_grid() * width;
        let made = flat(corner, edge1, edge2, random);
        let target = made.at(random.between(-0.1, 1.1), random.between(-0.1, 1.1));
        let origin = made.corner + random.in_cube() * 4.0;
        tally.score(&made.subject, Ray::new(origin, target - origin));
    });
}

/// Rays along a coordinate axis, with zeros of both signs, at faces square to it and in their very plane.
#[test]
fn axis_rays() {
    let directions = ["square", "slanted", "in plane"];
    sweep("quad, triangle: axis rays with ±0", 11, directions, 2000, |name, random, tally| {
        let axis = random.below(3);
        let turn = |v: [f64; 3]| DVec3::from_array([0, 1, 2].map(|k| v[(k + axis) % 3]));
        let cell = |random: &mut Random| random.on_grid().x;
        let corner = random.on_grid();
        let (a, b) = (cell(random).abs() + 0.25, cell(random).abs() + 0.25);
        let tilt = if name == "slanted" { cell(random) } else { 0.0 };
        let (edge1, edge2) = (turn([a, 0.0, tilt]), turn([0.0, b, 0.0]));
        let made = flat(corner, edge1, edge2, random);
        let zero = |random: &mut Random| 0.0 * random.sign();
        let (z1, z2) = (zero(random), zero(random));
        let (u, v) = (random.between(-0.2, 1.2), random.between(-0.2, 1.2));
        let dir = if name == "in plane" {
            turn([random.sign(), z1, z2])
        } else {
            turn([z1, z2, random.sign()])
        };
        let beside = turn([0.0, 0.0, random.sign() * 10.0_f64.powf(random.between(-16.0, 0.0))]);
        let origin = made.at(u, v) - dir * random.between(-2.0, 2.0) + beside;
        tally.score(&made.subject, Ray::new(origin, dir));
    });
}
