//! A Whitted-style recursive ray tracer.

pub mod aa;
pub mod accel;
pub mod camera;
pub mod color;
pub mod film;
pub mod geometry;
pub mod light;
pub mod material;
pub mod math;
pub mod render;
pub mod scene;
pub mod texture;
pub mod trace;

pub use color::Rgb;
