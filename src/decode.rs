//! Decoders of pictures, whose panics at broken files are errors.

use std::{
    cell::Cell,
    panic::{AssertUnwindSafe, catch_unwind, set_hook, take_hook},
    sync::Once,
};

use image::{
    ImageError, ImageResult,
    error::{DecodingError, ImageFormatHint},
};

thread_local! {
    static DECODES: Cell<bool> = const { Cell::new(false) };
}

/// What `decode` gives, or an error where it panics, of which nothing is printed.
///
/// The decoders have such faults: png 0.18.1 panics at a palette that is no whole number of colours, zune-jpeg 0.5.15
/// at components that are sampled more densely than the first.
pub(crate) fn decode<T>(decode: impl FnOnce() -> ImageResult<T>) -> ImageResult<T> {
    static QUIET: Once = Once::new();
    QUIET.call_once(|| {
        let told = take_hook();
        set_hook(Box::new(move |panic| {
            if !DECODES.get() {
                told(panic);
            }
        }));
    });
    let before = DECODES.replace(true);
    let decoded = catch_unwind(AssertUnwindSafe(decode));
    DECODES.set(before);
    decoded.unwrap_or_else(|_| {
        let reason = "the file is broken in a way in which the decoder fails";
        Err(ImageError::Decoding(DecodingError::new(ImageFormatHint::Unknown, reason)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panics_are_errors_within_decoders_only() {
        assert_eq!(decode(|| Ok(1)).expect("no panic"), 1);
        let error = decode::<()>(|| [0; 3][..].get(5).map(|_| Ok(())).expect("a panic"));
        assert!(error.expect_err("a panic").to_string().contains("fails"));
        assert!(!DECODES.get());
    }
}
