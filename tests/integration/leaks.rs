//! Closed meshes, through the tree: no ray from within gets out between two triangles.

use std::{ops::ControlFlow, path::Path};

use glam::DVec3;
use whitted::{
    accel::Accel,
    geometry::{Bounds, Ray, Shape, Triangle},
    math::random::SplitMix64,
};

type Mesh = (Vec<DVec3>, Vec<[usize; 3]>);

/// The vertices and triangles of an OBJ file's `v` and `f` lines.
fn read(path: &str) -> Mesh {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    let text = std::fs::read_to_string(&path)
        .unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let (mut vertices, mut faces) = (Vec::new(), Vec::new());
    for line in text.lines() {
        let words: Vec<&str> = line.split_whitespace().collect();
        match words.as_slice() {
            ["v", x, y, z, ..] => {
                vertices.push(DVec3::from_array([x, y, z].map(|x| x.parse().expect("a number"))));
            }
            ["f", a, b, c] => {
                faces.push([a, b, c].map(|k| k.parse::<usize>().expect("an index") - 1));
            }
            _ => {}
        }
    }
    (vertices, faces)
}

fn cube() -> Mesh {
    let corner = |k: usize| {
        DVec3::from_array([0, 1, 2].map(|axis| if k >> axis & 1 == 1 { 1.0 } else { -1.0 }))
    };
    let sides =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let faces = sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
    ((0..8).map(corner).collect(), faces.collect())
}

/// An octahedron whose faces are divided into four, `level` times.
fn sphere(level: u32) -> Mesh {
    let axes = [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z];
    let mut vertices = axes.to_vec();
    let mut faces = vec![
        [0, 2, 4],
        [2, 1, 4],
        [1, 3, 4],
        [3, 0, 4],
        [2, 0, 5],
        [1, 2, 5],
        [3, 1, 5],
        [0, 3, 5],
    ];
    for _ in 0..level {
        let mut middles = std::collections::HashMap::new();
        let mut middle = |a: usize, b: usize| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                vertices.push((vertices[a] + vertices[b]).normalize());
                vertices.len() - 1
            })
        };
        let divided = faces.iter().flat_map(|&[a, b, c]| {
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
        });
        faces = divided.collect();
    }
    (vertices, faces)
}

/// The least power of two that is not less than the size of the mesh, and its 2⁻²⁸ as the grid for its vertices.
fn size_and_grid((vertices, _): &Mesh) -> (f64, f64) {
    let size = Bounds::of_points(vertices.iter().copied()).size();
    let size = 2.0_f64.powi(size.log2().ceil() as i32);
    (size, size * 2.0_f64.powi(-28))
}

/// Whether a point is inside a closed mesh: whether the ray from there along z crosses its surface an odd number of times.
///
/// Every triangle is asked, in whole numbers of the grid, so that no answer is rounded.
fn is_inside(mesh: &Mesh, point: DVec3) -> bool {
    let (_, grid) = size_and_grid(mesh);
    let whole = |v: DVec3| (v / grid).round().to_array().map(|x| x as i128);
    let start = whole(point);
    let seen = |k: &usize| {
        let vertex = whole(mesh.0[*k]);
        [0, 1, 2].map(|axis| vertex[axis] - start[axis])
    };
    let crossings = mesh.1.iter().filter(|face| {
        let corners = face.each_ref().map(seen);
        let around =
            |a: usize, b: usize| corners[a][0] * corners[b][1] - corners[a][1] * corners[b][0];
        // Twice the areas that the corners opposite to each edge are weighted by.
        let areas = [around(1, 2), around(2, 0), around(0, 1)];
        if areas.iter().any(|a| *a > 0) && areas.iter().any(|a| *a < 0) {
            return false;
        }
        assert!(!areas.contains(&0), "{point}: an edge is right above or below");
        let height: i128 = (0..3).map(|k| areas[k] * corners[k][2]).sum();
        (height > 0) == (areas[0] > 0)
    });
    crossings.count() % 2 == 1
}

/// Casts `count` rays from `start`, which is inside, at vertices, edges and points just beside them; none may get out.
fn check(name: &str, mesh: &Mesh, start: DVec3, shift: DVec3, count: u64) {
    // On a grid on which the shift is exact, so that the mesh stays the same.
    let (_, grid) = size_and_grid(mesh);
    let (vertices, faces) = mesh;
    let vertices: Vec<DVec3> =
        vertices.iter().map(|v| (*v / grid).round() * grid + shift).collect();
    let corners = |face: &[usize; 3]| face.map(|k| vertices[k]);
    let shapes =
        faces.iter().filter_map(|face| Triangle::try_new(corners(face)).ok().map(Shape::from));
    let accel = Accel::build(shapes.collect());
    let (bounds, start) = (accel.bounds(), start + shift);
    let mut random = SplitMix64::new(5);
    for ray in 0..count {
        let face = &faces[(random.uniform() * faces.len() as f64) as usize];
        let [a, b, _] = corners(face);
        let target = match ray % 3 {
            0 => a,
            1 => a.lerp(b, random.uniform()),
            _ => a.lerp(b, random.uniform()) + bounds.extent() * (random.uniform() - 0.5) * 1e-12,
        };
        let ray = Ray::new(start, target - start);
        assert!(
            accel.nearest(&ray, f64::INFINITY).is_some(),
            "{name}, shifted by {shift}: {ray:?} gets out"
        );
        let (mut crossings, mut at_target) = (0, 0);
        accel.any_crossing(&ray, f64::INFINITY, |_, crossing| {
            crossings += 1;
            at_target += u32::from((crossing.t - 1.0).abs() < 1e-9);
            ControlFlow::Continue(())
        });
        // Where a ray meets an edge exactly, the triangles on both sides may report it.
        let is_odd = crossings % 2 == 1 || at_target > 1;
        assert!(
            is_odd,
            "{name}, shifted by {shift}: {ray:?} crosses the surface {crossings} times"
        );
    }
}

/// Oracle: the surface is closed and the start is inside, so every ray must hit, and cross the surface an odd number of times.
#[test]
fn closed_meshes_do_not_leak() {
    let bunny = read("tests/formats/models/bunny/bunny.obj");
    assert_eq!(bunny.1.len(), 69_666);
    // In its belly.
    let in_bunny = DVec3::new(-0.125, -0.1875, 0.140_625);
    assert!(is_inside(&bunny, in_bunny) && !is_inside(&bunny, in_bunny + DVec3::X));
    for (name, mesh, start, count) in [
        ("cube", &cube(), DVec3::ZERO, 150_000),
        ("sphere", &sphere(4), DVec3::ZERO, 150_000),
        ("bunny", &bunny, in_bunny, 200_000),
    ] {
        let (size, _) = size_and_grid(mesh);
        for sizes in [0.0, 2.0_f64.powi(20)] {
            let shift = DVec3::new(1.0, -1.0, 1.0) * size * sizes;
            check(name, mesh, start, shift, count);
        }
    }
}
