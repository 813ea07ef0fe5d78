//! A Whitted-style recursive ray tracer.

pub mod accel;
pub mod color;
pub mod geometry;
pub mod math;

pub use color::Rgb;
