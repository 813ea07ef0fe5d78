//! Surface colour as a function of the place: plain, a pattern in space, or a picture on the surface.

pub mod image;
pub mod pattern;
mod pyramid;

use std::sync::Arc;

use glam::{DVec2, DVec3};

pub use self::{
    image::{Image, ImageTextureError},
    pattern::{Checker, Plaid},
};
use crate::{color::Rgb, geometry::Similarity};

/// Where a texture is asked for its colour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TexturePoint {
    /// The surface coordinates, from the lower left.
    pub uv: DVec2,
    /// The point, in the coordinates of what holds the texture: in a [`Scene`](crate::scene::Scene), the scene's own.
    pub point: DVec3,
}

/// The colour of a surface.
#[derive(Clone, Debug)]
pub enum Texture {
    /// One colour everywhere.
    Solid(Rgb),
    /// A checker of squares in the plane of x and z.
    Checker(Checker),
    /// Two sets of diagonal stripes, woven.
    Plaid(Plaid),
    /// A picture laid on the surface coordinates.
    Image(Arc<Image>),
    /// A picture laid on scaled and shifted surface coordinates, again and again.
    Repeated(Arc<Image>, UvMap),
}

/// A change of surface coordinates before a picture is looked up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UvMap {
    /// What each coordinate is multiplied by.
    pub scale: DVec2,
    /// What is added then.
    pub offset: DVec2,
    /// Whether the picture's edge goes on beyond it, instead of the picture.
    pub clamp: bool,
}

impl Texture {
    /// The colour at a point, in linear light, and a number of the cell of the pattern there (0 for what has no edges).
    #[inline(always)]
    pub fn at(&self, at: &TexturePoint) -> (Rgb, u32) {
        match self {
            Self::Solid(color) => (*color, 0),
            Self::Checker(checker) => checker.at(at.point),
            Self::Plaid(plaid) => plaid.at(at.point),
            Self::Image(image) => (image.sample(at.uv), 0),
            Self::Repeated(image, map) => {
                let uv = at.uv * map.scale + map.offset;
                (if map.clamp { image.sample(uv) } else { image.sample_repeated(uv) }, 0)
            }
        }
    }

    /// The squared error, in levels of 255, of the colour at `uv` as the mean of what is around it, `across` which the
    /// coordinates change by so much, squared. Patterns have cells instead.
    #[inline(always)]
    pub(crate) fn detail(&self, uv: DVec2, across: DVec2) -> f32 {
        match self {
            Self::Solid(_) | Self::Checker(_) | Self::Plaid(_) => 0.0,
            Self::Image(image) => image.detail(uv, across),
            Self::Repeated(image, map) => {
                let (uv, across) = (uv * map.scale + map.offset, across * map.scale * map.scale);
                if map.clamp { image.detail(uv, across) } else { image.detail_repeated(uv, across) }
            }
        }
    }

    /// Whether the colour depends on [`TexturePoint::uv`].
    pub fn needs_uv(&self) -> bool {
        matches!(self, Self::Image(_) | Self::Repeated(..))
    }

    /// The same texture in a scene whose coordinates were changed by `map`.
    #[must_use]
    pub fn mapped(self, map: &Similarity) -> Self {
        match self {
            Self::Checker(checker) => Self::Checker(checker.mapped(map)),
            Self::Plaid(plaid) => Self::Plaid(plaid.mapped(map)),
            Self::Solid(_) | Self::Image(_) | Self::Repeated(..) => self,
        }
    }
}
