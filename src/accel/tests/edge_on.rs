//! Rays within the plane of flat shapes, up to rounding: where they cross is anything, but all must agree on it.

use glam::DVec3;

use super::{
    bits, eye,
    scenes::{Random, quad, sphere, triangle},
};
use crate::{
    accel::{Accel, Isa, brute},
    geometry::{Polygon, Ray, Shape, lanes::LANES},
};

/// A plane: a point and two directions in it.
type Plane = [DVec3; 3];

fn plane(random: &mut Random) -> Plane {
    let (u, v) = (random.direction(), random.direction());
    let v = if u.cross(v).length() > 0.2 { v } else { u.any_orthonormal_vector() };
    // Some along the axes, where coordinates are exact.
    let [u, v] = if random.below(4) == 0 { [DVec3::X, DVec3::Z] } else { [u, v] };
    [random.point(), u, v]
}

fn point_of([origin, u, v]: &Plane, reach: f64, random: &mut Random) -> DVec3 {
    origin + u * (reach * random.signed()) + v * (reach * random.signed())
}

/// A flat shape in a plane.
fn flat(plane: &Plane, random: &mut Random) -> Shape {
    let size = [1.0, 0.3, 0.01][random.below(3)];
    let (corner, [_, u, v]) = (point_of(plane, 1.0, random), plane);
    let mut edge = || u * (size * random.signed()) + v * (size * random.signed());
    let (a, b) = (edge(), edge());
    let b = if a.cross(b).length() > 0.1 * a.length() * b.length() { b } else { v * size };
    let a = if a.cross(b).length() > 0.1 * a.length() * b.length() { a } else { u * size };
    match random.below(3) {
        0 => triangle([corner, corner + a, corner + b]),
        1 => quad(corner, a, b),
        _ => {
            let outline = vec![corner, corner + a, corner + a + b * 0.5, corner + b];
            Polygon::try_new(outline).map_or_else(|_| quad(corner, a, b), Shape::from)
        }
    }
}

/// Oracle: the box about the shape, and brute force, which knows of no box.
#[test]
fn rays_in_the_plane_of_flat_shapes_meet_them_where_they_are() {
    let mut random = Random(84);
    let mut met = 0;
    for round in 0..400 {
        let plane = plane(&mut random);
        let mut shapes: Vec<Shape> =
            (0..=random.below(12)).map(|_| flat(&plane, &mut random)).collect();
        for _ in 0..random.below(4) {
            shapes.push(sphere(point_of(&plane, 1.0, &mut random), 0.03));
        }
        let accels: Vec<Accel> = Isa::ALL
            .into_iter()
            .filter(|isa| isa.is_available())
            .map(|isa| Accel::with_isa(shapes.clone(), isa))
            .collect();
        let reach = [1.0, 3.0, 100.0][random.below(3)];
        let eye = point_of(&plane, reach, &mut random);
        let middle = point_of(&plane, 1.0, &mut random);
        let narrow = [middle, plane[1], plane[2]];
        let goals: [DVec3; LANES] =
            std::array::from_fn(|_| point_of(&narrow, 0.1 * (middle - eye).length(), &mut random));
        for accel in &accels {
            eye::check("in the plane", &shapes, accel, eye, &goals);
        }
        for goal in goals {
            let ray = Ray::new(eye, goal - eye);
            for end in [f64::INFINITY, random.signed().abs()] {
                let expected = brute::nearest(&shapes, &ray, end);
                for accel in &accels {
                    let found = accel.nearest(&ray, end);
                    assert_eq!(bits(found), bits(expected), "round {round}: {ray:?} to {end}");
                }
                let Some(hit) = expected else { continue };
                met += 1;
                let (shape, bounds) =
                    (&shapes[hit.primitive as usize], shapes[hit.primitive as usize].bounds());
                let room = 4e-6 * (1.0 + reach);
                for point in [ray.origin + ray.dir * hit.t, shape.surface(&ray, &hit).point] {
                    let is_there = point.cmpge(bounds.min - room).all()
                        && point.cmple(bounds.max + room).all();
                    assert!(is_there, "round {round}: {ray:?} meets {shape:?} at {point}");
                }
            }
        }
    }
    assert!(met > 2000, "{met} crossings");
}
