//! Many bounces: between parallel mirrors, where the end point is known by unfolding the path.

use glam::DVec3;
use whitted::accel::brute;
use whitted::geometry::{Polygon, Quad, Ray, Shape, Triangle, reflect};

use super::big::{big, big_vec};
use super::oracle::UNIT;
use super::random::{Random, rays};
use super::subject::vector;

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

/// The shapes of rooms: square to the axes, turned, and with acute angles.
fn outlines() -> [(&'static str, [DVec3; 3]); 3] {
    let slanted = [EDGES[0], EDGES[1] + EDGES[0] * 0.5, EDGES[2] - EDGES[1] * 0.75];
    [("square", [DVec3::X, DVec3::Y, DVec3::Z]), ("turned", EDGES), ("slanted", slanted)]
}

fn inside(edges: &[DVec3; 3], random: &mut Random) -> DVec3 {
    edges.iter().fold(DVec3::ZERO, |p, e| p + e * random.between(0.1, 0.9))
}

/// How near, in roundings of the room's size, a line may come to an edge and still have to be kept in: at each bounce a
/// point is rounded and the next ray starts a few roundings beside it, which in an acute corner may be outside.
const EDGE_MARGIN: f64 = 64.0;

/// The distance of the ray's line from the nearest edge of the room, in roundings of the room's size.
fn edge_margin(edges: &[DVec3; 3], ray: &Ray) -> f64 {
    let size = edges.iter().map(|e| e.length()).sum::<f64>();
    let distance = |axis: usize, corner: DVec3| {
        let across = edges[axis].cross(ray.dir).normalize();
        across.dot(corner - ray.origin).abs()
    };
    let all =
        corners(*edges).map(|c| (0..3).map(|axis| distance(axis, c)).fold(f64::MAX, f64::min));
    all.into_iter().fold(f64::MAX, f64::min) / (UNIT * size)
}

/// Sends rays made by `aim` from points inside each room and fails if one gets out within `bounces`.
fn check_rooms(
    paths: usize,
    bounces: usize,
    mut aim: impl FnMut(&[DVec3; 3], &mut Random) -> DVec3,
) -> usize {
    let mut random = Random::new(16);
    let mut bounced = 0;
    for kind in ["quads", "polygons", "triangles"] {
        for (name, edges) in outlines() {
            let shapes = room(kind, edges);
            for _ in 0..paths {
                let start = inside(&edges, &mut random);
                let ray = Ray::new(start, aim(&edges, &mut random) - start);
                if let Err(bounce) = stay(&shapes, &edges, ray, bounces, &mut bounced) {
                    let (origin, dir) = (vector(ray.origin), vector(ray.dir));
                    panic!(
                        "out of a {name} room of {kind} at bounce {bounce}: Ray::new({origin}, {dir})"
                    );
                }
            }
        }
    }
    bounced
}

/// Follows a ray until it has bounced often enough or comes too near an edge to tell; or at which bounce it got out.
fn stay(
    shapes: &[Shape],
    edges: &[DVec3; 3],
    mut ray: Ray,
    bounces: usize,
    bounced: &mut usize,
) -> Result<(), usize> {
    for k in 0..bounces {
        if edge_margin(edges, &ray) < EDGE_MARGIN {
            break;
        }
        ray = bounce(shapes, ray, 1).map_err(|_| k)?.0;
        *bounced += 1;
    }
    Ok(())
}

#[test]
fn closed_rooms() {
    let bounced = check_rooms(rays(10), 2000, inside);
    println!("closed rooms: {bounced} bounces inside");
    assert!(bounced >= rays(10) * 9 * 1900, "{bounced} bounces");
}

/// Into every edge and corner of a room, 10⁻ᵏ beside it, and out again by some bounces.
#[test]
fn edges_of_rooms() {
    for k in 1..=12 {
        let bounced = check_rooms(rays(600), 12, |edges, random| {
            let axis = random.below(3);
            let [along, a, b] = [0, 1, 2].map(|j| edges[(axis + j) % 3]);
            let mut near = || {
                let miss = 10.0_f64.powi(-k) * random.between(0.5, 2.0);
                if random.flip() { miss } else { 1.0 - miss }
            };
            let (u, v, corner) = (near(), near(), near());
            let place = if random.flip() { corner } else { random.unit() };
            along * place + a * u + b * v
        });
        println!("10^-{k} from the edges of rooms: {bounced} bounces");
        assert!(bounced >= rays(600) * 9 * 4, "10^-{k}: {bounced} bounces");
    }
}
