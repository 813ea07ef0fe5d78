//! NFF, up to a scene that is ready to trace.

#![no_main]

mod alone;

use whitted::scene::{Scene, nff::parse_nff};

libfuzzer_sys::fuzz_target!(init: alone::alone(), |data: &[u8]| {
    if let Ok(scene) = parse_nff("fuzz", data, None) {
        let _ = Scene::assemble("fuzz", scene.parts);
    }
});
