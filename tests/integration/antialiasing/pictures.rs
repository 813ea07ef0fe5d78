//! Pictures on surfaces that are finer than the pixels, and some as regular as these.

use std::io::Cursor;

use image::{ImageFormat, RgbImage};
use whitted::{
    math::random::SplitMix64,
    scene::{Scene, SceneError},
    texture::Image,
};

use super::{
    mode,
    scenes::{rendered, rmse},
};

/// The texels in a row and a column, seven to a pixel where the picture fills the view.
const TEXELS: u32 = 512;

/// A grey by column and row.
type Greys<'a> = &'a mut dyn FnMut(u32, u32) -> u8;

/// A picture of these greys, on a square that fills the view, turned by so many degrees.
fn scene(degrees: f64, grey: Greys) -> Scene {
    let picture = RgbImage::from_fn(TEXELS, TEXELS, |x, y| image::Rgb([grey(x, y); 3]));
    let mut png = Cursor::new(Vec::new());
    picture.write_to(&mut png, ImageFormat::Png).expect("in memory");
    let (sin, cos) = degrees.to_radians().sin_cos();
    let side = if degrees == 0.0 { 20.0 } else { 28.0 };
    let edges = [[side * cos, side * sin, 0.0], [-side * sin, side * cos, 0.0]];
    let corner = [0, 1].map(|k| -0.5 * (edges[0][k] + edges[1][k]));
    let text = format!(
        r#"
        resolution = [72, 72]
        depth = 1
        background = [0, 0, 0]
        camera = {{ eye = [0, 0, 10], look_at = [0, 0, 0], up = [0, 1, 0], vertical_fov = 90 }}
        light = []
        texture.picture = {{ image = "picture" }}
        material.picture = {{ ambient = 1, texture = "picture" }}
        object = [{{ material = "picture", shape.quad = {{
            corner = [{}, {}, 0], edges = {edges:?} }} }}]
        "#,
        corner[0], corner[1]
    );
    let desc = toml::from_str(&text).unwrap_or_else(|error| panic!("{error}"));
    let mut decode = |name: &str| Image::decode(name, png.get_ref()).map_err(SceneError::from);
    Scene::try_new("test", &desc, &mut decode).unwrap_or_else(|error| panic!("{error}"))
}

/// Oracle: 256 rays in each pixel. What centres show of rings and lines is as smooth as what they show of a plain wall.
#[test]
fn pictures_finer_than_pixels_are_looked_into() {
    let mut random = SplitMix64::new(3);
    let mut noise = |_, _| (random.uniform() * 256.0) as u8;
    let mut lines = |x, y| if x % 37 == 3 || y % 41 == 3 { 255 } else { 0 };
    let mut rings = |x, y| {
        let [x, y] = [x, y].map(|k| f64::from(k) / f64::from(TEXELS) - 0.5);
        (127.5 + 127.5 * (std::f64::consts::TAU * (x * x + y * y) * 72.0).cos()) as u8
    };
    let pictures: [(&str, Greys); 3] =
        [("noise", &mut noise), ("lines", &mut lines), ("rings", &mut rings)];
    for (name, grey) in pictures {
        for degrees in [0.0, 20.0] {
            let scene = scene(degrees, grey);
            let truth = rendered(&scene, mode("sobol:256")).film;
            for (aa, most) in [("adaptive:8", 10.0), ("adaptive:4", 6.0), ("grid:2", 60.0)] {
                let picture = rendered(&scene, mode(aa));
                let (off, said) = (rmse(&picture.film, &truth), picture.estimated_rmse);
                let ratio = said.expect("all rays were cast") / off;
                println!("{name}, {degrees}, {aa}: off {off:.2}, says {ratio:.2} of it");
                assert!(off < most, "{name}, {degrees}, {aa}: {off}");
                assert!((0.5..3.0).contains(&ratio), "{name}, {degrees}, {aa}: {ratio}");
            }
        }
    }
}
