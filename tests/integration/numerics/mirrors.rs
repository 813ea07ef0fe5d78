//! Many bounces: between parallel mirrors, where the end point is known by unfolding the path.

use glam::DVec3;
use whitted::accel::brute;
use whitted::geometry::{Polygon, Quad, Ray, Shape, Triangle, reflect};

use super::big::{big, big_vec};
use super::random::{Random, rays};

/// The ray after `bounces` mirror reflections, or at which bounce it got out.
fn bounce(shapes: &[Shape], mut ray: Ray, bounces: usize) -> Result<(Ray, DVec3), usize> {
    let mut end = ray.origin;
    for k in 0..bounces {
        let hit = brute::nearest(shapes, &ray, f64::INFINITY).ok_or(k)?;
        let surface = shapes[hit.primitive as usize].surface(&ray, &hit);
        let inward = ray.dir.dot(surface.normal) > 0.0;
        let dir = reflect(ray.dir, surface.normal);
        ray = surface.leave(&hit, dir, inward);
        end = surface.point;
    }
    Ok((ray, end))
}

/// Where the path ends: the unfolded path is straight, at right angles to the mirrors its speed is constant.
fn unfolded(corner: DVec3, edges: [DVec3; 2], gap: DVec3, ray: &Ray, bounces: usize) -> DVec3 {
    let [e1, e2] = edges.map(big_vec);
    let (n, d, p) = (e1.cross(&e2), big_vec(ray.dir), big_vec(ray.origin));
    let square = n.dot(&n);
    let height = n.dot(&p.minus(&big_vec(corner)));
    let depth = n.dot(&big_vec(gap)); // positive
    let speed = n.dot(&d); // positive
    let way = &depth * big(bounces as f64) - &height;
    let along = d.minus(&n.scaled(&(&speed / &square)));
    let end = if bounces % 2 == 1 { depth } else { big(0.0) };
    let lift = n.scaled(&((end - height) / square));
    p.plus(&along.scaled(&(way / speed))).plus(&lift).f64()
}

#[test]
fn parallel_mirrors() {
    let mut random = Random::new(15);
    let mut worst = 0.0_f64;
    for bounces in [10, 1000, 100_000] {
        for tries in 0..rays(100) {
            // Corners on a grid, so that the mirrors are exactly parallel; the first try square to an axis.
            let [corner, mut e1, mut e2] = [(); 3].map(|()| random.on_grid());
            if tries == 0 {
                (e1, e2) = (DVec3::new(0.0, 0.0, 1.5), DVec3::new(1.25, 0.0, 0.0));
            }
            let wide = tries % 2 == 0;
            let share = if wide { 1.0 } else { 2.0 / (bounces as f64).log2().ceil().exp2() };
            let mut gap = random.on_grid() * share;
            let normal = e1.cross(e2);
            if gap.dot(normal) < 0.0 {
                gap = -gap;
            }
            let depth = gap.dot(normal.normalize());
            // The far mirror is as long as the near one, so the path must stay over both.
            let slant = gap - normal.normalize() * depth;
            let (from, to) = (0.3, 0.6);
            let start = corner + (e1 + e2) * from + gap * 0.375;
            let width = normal.length() / e1.length().max(e2.length());
            if depth < 0.05 * share || slant.length() > 0.2 * width {
                continue;
            }
            let dir = (e1 + e2) * ((to - from) / (bounces as f64)) + normal.normalize() * depth;
            let quads =
                [corner, corner + gap].map(|c| Quad::try_new(c, e1, e2).expect("a quad").into());
            let ray = Ray::new(start, dir.normalize());
            let (_, end) = bounce(&quads, ray, bounces)
                .unwrap_or_else(|k| panic!("out at bounce {k} of {bounces}"));
            let right = unfolded(corner, [e1, e2], gap, &ray, bounces);
            let size = e1.length().max(e2.length()) + right.abs().max_element();
            let error = (end - right).length() / size;
            worst = worst.max(error);
        }
    }
    println!(
        "parallel mirrors, 10 to 1e5 bounces: end point off by {worst:e} of the mirrors' size"
    );
    assert!(worst < 1e-12, "end point off by {worst:e} of the mirrors' size");
}

/// Three edges at right angles, of integer length, along no axis.
const EDGES: [DVec3; 3] =
    [DVec3::new(1.0, 2.0, 2.0), DVec3::new(2.0, 1.0, -2.0), DVec3::new(2.0, -2.0, 1.0)];

/// The eight corners of a box.
fn corners(edges: [DVec3; 3]) -> [DVec3; 8] {
    std::array::from_fn(|k| {
        let part = |axis: usize| edges[axis] * f64::from(u8::from(k >> axis & 1 == 1));
        part(0) + part(1) + part(2)
    })
}

/// The corners of a box's faces, in order.
const FACES: [[usize; 4]; 6] =
    [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]];

/// A closed room of a kind of shapes.
fn room(kind: &str, edges: [DVec3; 3]) -> Vec<Shape> {
    let corners = corners(edges);
    let mut shapes: Vec<Shape> = vec![];
    for face in FACES {
        let [a, b, c, d] = face.map(|k| corners[k]);
        match kind {
            "quads" => shapes.push(Quad::try_new(a, b - a, d - a).expect("a quad").into()),
            "polygons" => {
                shapes.push(Polygon::try_new(vec![a, b, c, d]).expect("a square").into());
            }
            _ => shapes.extend(
                [[a, b, c], [a, c, d]].map(|v| Triangle::try_new(v).expect("a half").into()),
            ),
        }
    }
    shapes
}

/// A ray that bounces in a closed room stays there, also when each bounce is sent to within 10⁻ᵏ of an edge.
#[test]
fn closed_rooms() {
    let mut random = Random::new(16);
    let slanted = [EDGES[0], EDGES[1] + EDGES[0] * 0.5, EDGES[2] - EDGES[1] * 0.75];
    let mut table = vec![];
    for kind in ["quads", "polygons", "triangles"] {
        for (name, edges) in
            [("axis", [DVec3::X, DVec3::Y, DVec3::Z]), ("turned", EDGES), ("slanted", slanted)]
        {
            let shapes = room(kind, edges);
            for k in [1, 3] {
                let miss = if k == 17 { 0.0 } else { 10.0_f64.powi(-k) };
                let mut out = 0;
                let paths = rays(40);
                for _ in 0..paths {
                    let inside = |random: &mut Random| {
                        edges.iter().fold(DVec3::ZERO, |p, e| p + e * random.between(0.1, 0.9))
                    };
                    let start = inside(&mut random);
                    let mut ray = Ray::new(start, inside(&mut random) - start);
                    for bounce in 0..100 {
                        let Some(hit) = brute::nearest(&shapes, &ray, f64::INFINITY) else {
                            out += 1;
                            break;
                        };
                        let surface = shapes[hit.primitive as usize].surface(&ray, &hit);
                        let inward = ray.dir.dot(surface.normal) > 0.0;
                        let mut dir = reflect(ray.dir, surface.normal);
                        if bounce % 3 == 0 {
                            // To a point near an edge.
                            let axis = random.below(3);
                            let [along, a, b] = [0, 1, 2].map(|j| edges[(axis + j) % 3]);
                            let near =
                                |random: &mut Random| if random.flip() { miss } else { 1.0 - miss };
                            let target = along * random.unit()
                                + a * near(&mut random)
                                + b * near(&mut random);
                            let towards = target - surface.point;
                            if towards.dot(surface.normal) * dir.dot(surface.normal) > 0.0 {
                                dir = towards;
                            }
                        }
                        ray = surface.leave(&hit, dir, inward);
                    }
                }
                table.push(format!("{kind}, {name}, 10^-{k}: {out} of {paths} out"));
            }
        }
    }
    println!("{}", table.join("\n"));
    assert!(table.iter().all(|line| line.contains(": 0 of")), "{}", table.join("\n"));
}
