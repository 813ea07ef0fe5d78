//! TOML scenes without other files, up to a scene that is ready to trace.

#![no_main]

use whitted::scene::{Parts, Scene, SceneError, builtin, format::SceneText};

libfuzzer_sys::fuzz_target!(|text: &str| {
    match SceneText::parse("fuzz", text, &|file| file.starts_with(builtin::PREFIX)) {
        Err(faults) => {
            let _ = faults.to_string();
        }
        Ok(scene) => {
            let none = |name: &str| Err(SceneError::ModelWithoutFile { name: name.to_owned() });
            match Parts::gather(&scene.desc, &mut builtin::picture, &mut { none }) {
                Ok(parts) => {
                    let _ = Scene::assemble("fuzz", parts);
                }
                Err(found) => {
                    let found = found.into_iter().map(|(place, error)| (place, error.to_string()));
                    let _ = scene.faults(found.collect()).to_string();
                }
            }
        }
    }
});
