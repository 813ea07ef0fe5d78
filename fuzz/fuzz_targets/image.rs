//! The loader of pictures.

#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    let _ = whitted::texture::Image::decode("fuzz", data);
});
