//! Small scenes from text, and their pictures.

use whitted::{
    Rgb,
    aa::AntiAliasing,
    film::Film,
    render::{RenderOptions, Rendering, render},
    scene::{Scene, builtin},
};

/// The scene of a TOML text; its textures are the program's own pictures.
pub(crate) fn scene(text: &str) -> Scene {
    let desc = toml::from_str(text).unwrap_or_else(|error| panic!("{error}"));
    Scene::try_new("test", &desc, &mut builtin::picture).unwrap_or_else(|error| panic!("{error}"))
}

/// The picture of a scene, with one ray through each pixel's centre.
pub(crate) fn picture(scene: &Scene) -> Film {
    rendering(scene, &RenderOptions { aa: AntiAliasing::None, ..Default::default() }).film
}

pub(crate) fn rendering(scene: &Scene, options: &RenderOptions) -> Rendering {
    render(scene, options, &|_| ()).expect("threads start")
}

/// The colour of the only pixel of the picture, one of 1 x 1.
pub(crate) fn only_pixel(text: &str) -> Rgb {
    let film = picture(&scene(text));
    assert_eq!((film.width(), film.height()), (1, 1));
    film.pixel(0, 0)
}

/// Panics unless two colours agree to single precision.
#[track_caller]
pub(crate) fn assert_color(color: Rgb, expected: [f64; 3], what: &str) {
    for (value, expected) in color.to_array().into_iter().zip(expected) {
        let error = (f64::from(value) - expected).abs();
        assert!(error <= 2e-6, "{what}: {color} instead of {expected} in one channel");
    }
}

/// The sRGB transfer function, written down once more.
pub(crate) fn linear(display: f64) -> f64 {
    if display > 0.04045 { ((display + 0.055) / 1.055).powf(2.4) } else { display / 12.92 }
}
