//! Whitted's weights: how much of a surface is its own colour, highlight, mirror and glass.

use crate::{color::Rgb, geometry::Similarity, texture::Texture};

/// How a surface answers light.
///
/// Light leaves it as the sum of: `opacity · (ambient C + diffuse C Σ cos θ I)`, with C the texture's colour and the
/// sum over the lights that reach it; `specular · Σ cosⁿ I`, Phong's highlight, white, with n the `shininess`;
/// `reflection` times the light from the mirror direction; and `transmission` times the light from behind. The weights
/// are linear numbers that are not made to sum to 1.
///
/// A surface with `transmission` bounds a body: seen from within it only transmits.
///
/// Source: Whitted, "An Improved Illumination Model for Shaded Display", *CACM* 23(6) (1980).
#[derive(Clone, Debug)]
pub struct Material {
    /// The surface's own colour.
    pub texture: Texture,
    /// Weight of the light that is everywhere.
    pub ambient: f32,
    /// Weight of the light scattered alike in all directions.
    pub diffuse: f32,
    /// Weight of the highlight.
    pub specular: f32,
    /// Phong's exponent.
    pub shininess: f64,
    /// Weight of the mirror image.
    pub reflection: f32,
    /// Weight of the ambient and diffuse part.
    pub opacity: f32,
    /// Weight of the light that passes, for each crossing of the surface and each channel; zero is an opaque surface.
    pub transmission: Rgb,
    /// Index of refraction of the body, against 1 outside; with 1 light goes straight on.
    pub ior: f64,
}

impl Material {
    /// A white surface that is opaque and gives back nothing: what others are made from.
    pub fn none() -> Self {
        Self {
            texture: Texture::Solid(Rgb::ONE),
            ambient: 0.0,
            diffuse: 0.0,
            specular: 0.0,
            shininess: 1.0,
            reflection: 0.0,
            opacity: 1.0,
            transmission: Rgb::ZERO,
            ior: 1.0,
        }
    }

    /// Whether light passes through.
    pub fn is_transmissive(&self) -> bool {
        self.transmission != Rgb::ZERO
    }

    /// Whether rays go on from where they meet it.
    pub fn sends_on(&self) -> bool {
        self.reflection > 0.0 || self.is_transmissive()
    }

    /// The same material in a scene whose coordinates were changed by `map`.
    #[must_use]
    pub fn mapped(self, map: &Similarity) -> Self {
        Self { texture: self.texture.mapped(map), ..self }
    }
}
