//! A scene as its text says it: plain data, not yet checked. The text is TOML; every field's unit is said here.
//!
//! Lengths are in scene units, axes right-handed with y up, angles in degrees. Colours are sRGB display values from 0
//! to 1; all other weights are plain linear numbers.

use std::collections::BTreeMap;

use serde::Deserialize;

/// A scene.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SceneDesc {
    /// Width and height of the picture in pixels.
    pub resolution: [u32; 2],
    /// The deepest level of recursion; camera rays have level 1.
    pub depth: u32,
    /// The weight in a sample below which a reflected or transmitted ray is not cast; 0 casts all.
    #[serde(default)]
    pub cutoff: f32,
    /// The colour of a ray that hits nothing.
    pub background: [f64; 3],
    /// Anti-aliasing as `--aa` takes it, unless that is given.
    #[serde(default)]
    pub aa: Option<String>,
    /// What the colours are.
    #[serde(default)]
    pub color_space: ColorSpace,
    /// The camera.
    pub camera: CameraDesc,
    /// The lights.
    #[serde(default)]
    pub light: Vec<LightDesc>,
    /// Textures by name.
    #[serde(default)]
    pub texture: BTreeMap<String, TextureDesc>,
    /// Materials by name.
    #[serde(default)]
    pub material: BTreeMap<String, MaterialDesc>,
    /// The objects.
    #[serde(default)]
    pub object: Vec<ObjectDesc>,
    /// Models from OBJ files.
    #[serde(default)]
    pub model: Vec<ModelDesc>,
}

/// What the three channels of a colour in a description are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ColorSpace {
    /// Values as a display takes them.
    #[default]
    Srgb,
    /// Linear light.
    Linear,
}

/// A model from an OBJ file: scaled, then turned, then moved.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModelDesc {
    /// The file, beside that of the scene.
    pub file: String,
    /// What its lengths are multiplied by.
    #[serde(default = "one")]
    pub scale: f64,
    /// Turns about x, then y, then z, in degrees.
    #[serde(default)]
    pub rotate: [f64; 3],
    /// How far it is moved then.
    #[serde(default)]
    pub translate: [f64; 3],
    /// The name of a material in place of the model's own.
    #[serde(default)]
    pub material: Option<String>,
}

fn one() -> f64 {
    1.0
}

/// A pinhole camera.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CameraDesc {
    /// Where it is.
    pub eye: [f64; 3],
    /// A point in the middle of the picture.
    pub look_at: [f64; 3],
    /// A direction that is up in the picture.
    pub up: [f64; 3],
    /// The angle between the picture's lower and upper edge.
    pub vertical_fov: f64,
}

/// A white point light, as bright near as far.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LightDesc {
    /// Where it is.
    pub position: [f64; 3],
    /// How bright it is.
    pub intensity: f64,
}

/// A texture.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
pub enum TextureDesc {
    /// Squares in the plane of x and z.
    Checker {
        /// Colour of the square next to the origin (towards +x, +z) and of every other one.
        even: [f64; 3],
        /// Colour of the rest.
        odd: [f64; 3],
        /// A corner of a square.
        origin: [f64; 3],
        /// Side of a square.
        size: f64,
    },
    /// Diagonal stripes in the plane of x and y.
    Plaid {
        /// Colour between the stripes.
        ground: [f64; 3],
        /// Colour where stripes cross; where there is one, the mean of the display values is shown.
        stripe: [f64; 3],
        /// Where the stripes begin.
        origin: [f64; 3],
        /// A third of the distance from stripe to stripe along x.
        size: f64,
    },
    /// A picture file; shapes without surface coordinates cannot wear it.
    Image(String),
}

/// A material; [`Material`](crate::material::Material) says what the weights do.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct MaterialDesc {
    /// The colour, if there is no texture.
    pub color: [f64; 3],
    /// The name of a texture.
    pub texture: Option<String>,
    /// Weight of the light that is everywhere.
    pub ambient: f32,
    /// Weight of scattered light.
    pub diffuse: f32,
    /// Weight of the highlight.
    pub specular: f32,
    /// Phong's exponent.
    pub shininess: f64,
    /// Weight of the mirror image.
    pub reflection: f32,
    /// Weight of the ambient and diffuse part.
    pub opacity: f32,
    /// Weight of the light that passes at each crossing of the surface.
    pub transmission: f32,
    /// The colour that this light is filtered to.
    pub transmission_color: [f64; 3],
    /// Index of refraction.
    pub ior: f64,
}

impl Default for MaterialDesc {
    /// White, opaque, and giving back nothing.
    fn default() -> Self {
        Self {
            color: [1.0; 3],
            texture: None,
            ambient: 0.0,
            diffuse: 0.0,
            specular: 0.0,
            shininess: 1.0,
            reflection: 0.0,
            opacity: 1.0,
            transmission: 0.0,
            transmission_color: [1.0; 3],
            ior: 1.0,
        }
    }
}

/// A shape and what it is made of.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ObjectDesc {
    /// The name of a material.
    pub material: String,
    /// The shape.
    pub shape: ShapeDesc,
}

/// A shape.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
pub enum ShapeDesc {
    /// A sphere.
    Sphere {
        /// Its centre.
        center: [f64; 3],
        /// Its radius.
        radius: f64,
    },
    /// A circular cylinder.
    Cylinder {
        /// The middle of one end.
        base: [f64; 3],
        /// The middle of the other.
        top: [f64; 3],
        /// Its radius.
        radius: f64,
        /// Whether discs close it.
        ends: EndsDesc,
    },
    /// A circular cone.
    Cone {
        /// The middle of the base.
        base: [f64; 3],
        /// The tip.
        apex: [f64; 3],
        /// The radius of the base.
        radius: f64,
        /// Whether a disc closes it.
        ends: EndsDesc,
    },
    /// The open side of a truncated circular cone.
    Frustum {
        /// The middle of one end.
        base: [f64; 3],
        /// The middle of the other.
        top: [f64; 3],
        /// The radius at the base.
        base_radius: f64,
        /// The radius at the top.
        top_radius: f64,
    },
    /// A parallelogram, its front where the cross product of the edges points.
    Quad {
        /// A corner, where the surface coordinates are (0, 0).
        corner: [f64; 3],
        /// The edges from there, along which they go from 0 to 1.
        edges: [[f64; 3]; 2],
    },
    /// A triangle.
    Triangle {
        /// Its corners, counterclockwise seen from the front.
        vertices: [[f64; 3]; 3],
    },
    /// A flat polygon, convex or not.
    Polygon {
        /// Its corners, counterclockwise seen from the front.
        vertices: Vec<[f64; 3]>,
    },
    /// A regular tetrahedron, tip up, of six planes: three sides and the base in three parts.
    Tetrahedron {
        /// The middle of the base.
        base_center: [f64; 3],
        /// The length of an edge.
        edge: f64,
        /// The direction of the base's first corner from its middle: 0 is +z, 90 is +x.
        turn: f64,
    },
}

/// Whether a cylinder or cone is closed by discs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum EndsDesc {
    /// Side only.
    Open,
    /// A solid.
    Closed,
}
