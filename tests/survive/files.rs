//! Picture formats and what files say of themselves.

use exr::prelude::{ReadChannels, ReadLayers, read_first_rgba_layer_from_file};

use super::{done, folder, json, read, run};

/// Oracle: the sRGB formula, on floats as another reader gives them. The PNG encodes the same values.
#[test]
fn the_exr_holds_the_linear_values_that_the_png_encodes() {
    let folder = folder();
    let at = folder.path();
    let small = ["render", "--quiet", "--size", "60x41", "--aa", "adaptive:2"];
    for name in ["a.png", "a.exr"] {
        done(&run(at, &[&small[..], &["-o", name, "--stats", &format!("{name}.json")]].concat()));
    }
    let png = image::open(at.join("a.png")).expect("a PNG").into_rgb8();
    let floats = read_first_rgba_layer_from_file(
        at.join("a.exr"),
        |size, _| vec![[0.0_f32; 3]; size.width() * size.height()],
        |pixels, place, (r, g, b, _): (f32, f32, f32, f32)| {
            pixels[place.y() * 60 + place.x()] = [r, g, b];
        },
    )
    .expect("an OpenEXR file");
    let encoded = |linear: f32| {
        let x = f64::from(linear);
        let level = if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 };
        (level * 255.0).round() as u8
    };
    let floats = &floats.layer_data.channel_data.pixels;
    assert_eq!((png.width(), png.height()), (60, 41));
    let mut fractions = 0;
    for (pixel, linear) in png.pixels().zip(floats) {
        assert_eq!(pixel.0, linear.map(encoded));
        fractions += usize::from((f64::from(linear[0]) * 255.0).fract() != 0.0);
    }
    assert!(fractions > 1000, "they are not 8-bit values: {fractions}");

    let layers = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .all_layers()
        .all_attributes()
        .from_file(at.join("a.exr"))
        .expect("an OpenEXR file")
        .layer_data;
    let names: Vec<String> = layers
        .iter()
        .map(|l| l.attributes.layer_name.clone().expect("named").to_string())
        .collect();
    assert_eq!(names, ["color", "samples"]);
    let samples: Vec<f32> = layers[1].channel_data.list[0].sample_data.values_as_f32().collect();
    let mean = f64::from(samples.iter().sum::<f32>()) / samples.len() as f64;
    let stats = json(&read(at, "a.exr.json"));
    assert_eq!(samples.len(), 60 * 41);
    assert!((stats["samples_per_pixel"]["mean"].as_f64().expect("a number") - mean).abs() < 1e-4);
}

/// The text chunks of a PNG.
fn chunks(bytes: &[u8]) -> Vec<(String, String)> {
    let reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().expect("a PNG");
    let text = &reader.info().uncompressed_latin1_text;
    text.iter().map(|chunk| (chunk.keyword.clone(), chunk.text.clone())).collect()
}

#[test]
fn a_png_says_what_decides_its_pixels_and_nothing_else() {
    let folder = folder();
    let at = folder.path();
    let small = ["render", "--quiet", "--size", "30x20", "--aa", "grid:2"];
    done(&run(at, &[&small[..], &["-o", "a.png"]].concat()));
    std::fs::create_dir(at.join("sub")).expect("created");
    let other = ["-o", "sub/b.png", "--threads", "1", "--progress", "none", "--checkpoint", "9"];
    done(&run(at, &[&small[..], &other].concat()));
    assert!(read(at, "a.png") == read(at, "sub/b.png"), "threads and paths are not in it");
    let found = chunks(&read(at, "a.png"));
    let names: Vec<&str> = found.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["Software", "Scene", "Options"]);
    assert_eq!(found[0].1, format!("whitted {}", env!("CARGO_PKG_VERSION")));
    assert_eq!(found[1].1, whitted::scene::load_builtin("assignment").expect("built in").hash());
    assert_eq!(found[2].1, "size=30x20 aa=grid:2 depth=6");
    let tile = ["--tile", "3/4", "-o", "c.png", "--depth", "2"];
    done(&run(at, &[&small[..], &tile].concat()));
    let found = chunks(&read(at, "c.png"));
    assert_eq!(found[2].1, "size=30x20 aa=grid:2 depth=2");
    assert_eq!(found[3], ("Part".to_owned(), "0,10,15,20".to_owned()));
    assert_eq!(found[4], ("Tile".to_owned(), "3/4".to_owned()));
}

/// Oracle: the same picture as PNG, decoded by another program's library.
#[test]
fn a_ppm_is_the_png_without_compression() {
    let folder = folder();
    let at = folder.path();
    for name in ["a.png", "a.ppm"] {
        done(&run(at, &["render", "--quiet", "--size", "31x20", "-o", name]));
    }
    let png = image::open(at.join("a.png")).expect("a PNG").into_rgb8();
    let mut expected = b"P6\n31 20\n255\n".to_vec();
    expected.extend(png.into_raw());
    assert!(read(at, "a.ppm") == expected);
}
