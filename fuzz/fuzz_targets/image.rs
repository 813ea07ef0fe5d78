//! The loader of pictures.

#![no_main]

mod alone;

libfuzzer_sys::fuzz_target!(init: alone::alone(), |data: &[u8]| {
    let _ = whitted::texture::Image::decode("fuzz", data);
});
