//! TOML scenes without other files, up to a scene that is ready to trace.

#![no_main]

mod alone;

use whitted::scene::{Scene, SceneError, builtin, format::SceneText};
use whitted::texture::Image;

/// A picture of one texel in the place of the program's own, whose decoding takes most of the time.
const PICTURE: &[u8] = include_bytes!("texel.png");

libfuzzer_sys::fuzz_target!(init: alone::alone(), |text: &str| {
    let mut picture = |name: &str| match name.strip_prefix(builtin::PREFIX) {
        Some("cat.png" | "flower.png") => Ok(Image::decode(name, PICTURE)?),
        _ => builtin::picture(name),
    };
    let mut no_models = |name: &str| Err(SceneError::ModelWithoutFile { name: name.to_owned() });
    let parts = SceneText::parse("fuzz", text, &|file| file.starts_with(builtin::PREFIX))
        .and_then(|scene| scene.parts(&mut picture, &mut no_models));
    match parts {
        Ok(parts) => {
            let _ = Scene::assemble("fuzz", parts);
        }
        Err(faults) => {
            let _ = faults.to_string();
        }
    }
});
