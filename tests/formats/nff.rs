//! Standard scenes, against ray counts of an independent program.

use glam::DVec3;
use whitted::classic::{CLASSIC_SIZE, render_classic};
use whitted::scene::{LoadOptions, load};

use whitted::geometry::Ray;
use whitted::scene::nff::parse_nff;

use super::file;

/// Oracle: rays that hit, reflected, refracted and shadow rays by an independent program in double precision. They agree
/// within 0.2 %, the teapot's patches within 3 %.
#[test]
fn classic_ray_counts_are_those_of_an_independent_program() {
    for (name, expected) in [
        ("balls", [263_169, 147_955, 0, 917_800]),
        ("gears", [242_899, 446_577, 295_920, 2_762_183]),
        ("mount", [172_415, 354_770, 354_770, 410_257]),
        ("rings", [263_169, 229_434, 0, 995_188]),
        ("teapot", [160_990, 226_884, 0, 410_775]),
        ("tetra", [53_632, 0, 0, 49_958]),
        ("tree", [166_800, 0, 0, 1_088_465]),
        ("jacks", [72_283, 119_143, 0, 97_223]),
        ("lattice", [242_635, 200_062, 0, 1_093_149]),
        ("shells", [78_871, 87_439, 0, 84_387]),
        ("sombrero", [112_159, 0, 0, 110_531_u64]),
    ] {
        let path = file("tests/formats/spd").join(format!("{name}.nff"));
        let options = LoadOptions { rows: Some(CLASSIC_SIZE), ..LoadOptions::default() };
        let loaded = load(&path.display().to_string(), &options).expect(name);
        assert!(loaded.warnings.is_empty(), "{name}: {:?}", loaded.warnings);
        let rays = render_classic(&loaded.scene, None).expect(name).rays;
        let counted = [rays.camera_hit, rays.reflected, rays.refracted, rays.shadow];
        for (k, (found, expected)) in counted.into_iter().zip(expected).enumerate() {
            let allowed = if name == "teapot" && k > 0 { 0.03 } else { 0.002 };
            let off = (found as f64 - expected as f64).abs();
            assert!(off <= allowed * expected as f64, "{name} {k}: {found} for {expected}");
        }
    }
}

/// Oracle: along the axis of view the walls of a sphere of radius 1 are 4 and 6 away, those of a cylinder of radius 2 too.
#[test]
fn shapes_of_negative_radius_are_seen_from_inside_only() {
    let view = "v\nfrom 0 0 5\nat 0 0 0\nup 0 1 0\nangle 45\nhither 1\nresolution 64 64\n";
    for (shape, walls) in [
        ("s 0 0 0 1", [4.0, 6.0]),
        ("c 0 -1 0 2 0 1 0 2", [3.0, 7.0]),
        ("c 0 -1 0 2 0 1 0 0", [4.0, 6.0]),
        ("c 0 -1 0 3 0 1 0 1", [3.0, 7.0]),
    ] {
        for (sign, wall) in [("", walls[0]), ("-", walls[1])] {
            let mut words: Vec<String> = shape.split(' ').map(str::to_owned).collect();
            let radii: &[usize] = if words.len() == 5 { &[4] } else { &[4, 8] };
            for &k in radii {
                words[k].insert_str(0, sign);
            }
            let text = format!("{view}{}\n", words.join(" "));
            let nff = parse_nff("test.nff", text.as_bytes(), None).expect("a scene");
            assert!(nff.warnings.is_empty(), "{:?}", nff.warnings);
            let ray = Ray::new(DVec3::Z * 5.0, DVec3::NEG_Z);
            let (hit, _) = nff.parts.shapes[0].first_hit(0, &ray).expect(&text);
            assert!((hit.t - wall).abs() < 1e-12, "{text}: {hit:?}");
        }
    }
}
