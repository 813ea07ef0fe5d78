//! A Whitted-style recursive ray tracer.

pub mod color;
pub mod film;

pub use color::Rgb;
