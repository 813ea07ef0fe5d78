//! TOML scenes without other files, up to a scene that is ready to trace.

#![no_main]

use whitted::scene::{Scene, SceneError, builtin, format::SceneText};

libfuzzer_sys::fuzz_target!(|text: &str| {
    let mut no_models = |name: &str| Err(SceneError::ModelWithoutFile { name: name.to_owned() });
    let parts = SceneText::parse("fuzz", text, &|file| file.starts_with(builtin::PREFIX))
        .and_then(|scene| scene.parts(&mut builtin::picture, &mut no_models));
    match parts {
        Ok(parts) => {
            let _ = Scene::assemble("fuzz", parts);
        }
        Err(faults) => {
            let _ = faults.to_string();
        }
    }
});
