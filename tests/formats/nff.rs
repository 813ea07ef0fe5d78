//! Standard scenes, against ray counts of an independent program.

use whitted::classic::{CLASSIC_SIZE, render_classic};
use whitted::scene::{LoadOptions, load};

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
