//! Many bounces: between parallel mirrors, where the end point is known by unfolding the path.

use glam::DVec3;
use whitted::accel::brute;
use whitted::geometry::{Polygon, Quad, Ray, Shape, reflect};

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
        for tries in 0..rays(12) {
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
            if depth < 0.05 * share || slant.length() > 0.25 * e1.length().min(e2.length()) {
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
            println!("{bounces} bounces, wide {wide}: {error:e}");
            worst = worst.max(error);
        }
    }
    println!("worst {worst:e}");
    assert!(worst < 1e-12, "end point off by {worst:e} of the mirrors' size");
}
