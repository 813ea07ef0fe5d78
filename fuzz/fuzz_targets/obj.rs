//! OBJ and MTL: the library stands behind a line `#mtl`.

#![no_main]

mod alone;

libfuzzer_sys::fuzz_target!(init: alone::alone(), |data: &[u8]| {
    let mark = b"#mtl\n";
    let at = data.windows(mark.len()).position(|part| part == mark);
    let (obj, mtl) = match at {
        Some(at) => (&data[..at], &data[at + mark.len()..]),
        None => (data, &data[..0]),
    };
    if let Ok(model) = whitted::scene::obj::parse_model("fuzz", obj, mtl) {
        assert!(!model.mesh.triangles().is_empty());
        assert_eq!(model.mesh.triangles().len(), model.material_of.len());
    }
});
