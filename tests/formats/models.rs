//! Real models, against counts and areas that other programs found, and against another reader.

use whitted::scene::obj::{inspect_model, load_model};

use super::file;

fn path_of(model: &str) -> std::path::PathBuf {
    let gallery = file("models").join(model);
    if gallery.exists() { gallery } else { file("tests/formats/models").join(model) }
}

/// Oracle: `expected.csv`, by an independent counter; its areas agree with another library's.
#[test]
fn counts_and_areas_are_those_expected() {
    let table = std::fs::read_to_string(file("tests/formats/expected.csv")).expect("the table");
    let mut rows = 0;
    for line in table.lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let count = |k: usize| cells[k].parse::<usize>().expect(line);
        let report = inspect_model(&path_of(cells[0])).expect(line);
        let counts = [
            report.positions,
            report.texcoords,
            report.normals,
            report.faces,
            report.triangles,
            report.max_corners,
        ];
        assert_eq!(counts, [2, 3, 4, 5, 6, 7].map(count), "{}", cells[0]);
        let area: f64 = cells[8].parse().expect(line);
        assert!(
            (report.area / area - 1.0).abs() < 1e-4,
            "{}: {} for {area}",
            cells[0],
            report.area
        );
        assert!(report.textures.iter().all(|t| t.found), "{:?}", report.textures);
        rows += 1;
    }
    assert_eq!(rows, 14);
}

/// Oracle: the triangulation covers the polygons, so on flat faces its area is theirs.
#[test]
fn triangles_have_the_area_of_the_faces() {
    for model in ["crate/crate.obj", "cornell_box/cornell_box.obj", "stoneLantern/stoneLantern.obj"]
    {
        let mesh = load_model(&path_of(model)).expect(model).mesh;
        let corner = |k: u32| mesh.vertices()[k as usize];
        let area = |t: &[u32; 3]| {
            let [a, b, c] = t.map(corner);
            (b - a).cross(c - a).length() / 2.0
        };
        let total: f64 = mesh.triangles().iter().map(area).sum();
        let report = inspect_model(&path_of(model)).expect(model);
        assert!((total / report.area - 1.0).abs() < 1e-3, "{model}: {total} for {}", report.area);
    }
}

/// Oracle: tobj, on a file that it reads without help.
#[test]
fn positions_are_those_of_another_reader() {
    let path = path_of("bunny/bunny.obj");
    let (models, _) = tobj::load_obj(&path, &tobj::LoadOptions::default()).expect("a clean file");
    let theirs = &models[0].mesh;
    let ours = load_model(&path).expect("a clean file").mesh;
    assert_eq!(ours.triangles().len() * 3, theirs.indices.len());
    for (triangle, indices) in ours.triangles().iter().zip(theirs.indices.chunks(3)) {
        for (a, b) in triangle.iter().zip(indices) {
            let b = &theirs.positions[*b as usize * 3..][..3];
            assert_eq!(ours.vertices()[*a as usize].to_array(), [b[0], b[1], b[2]]);
        }
    }
    assert!(inspect_model(&path).expect("a clean file").closed);
}
