//! A Whitted-style recursive ray tracer.

pub mod color;

pub use color::Rgb;
