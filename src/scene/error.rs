//! What can be wrong with a scene.

use thiserror::Error;

use super::{format::Faults, nff::NffError, obj::ModelError, text::TextError};
use crate::{camera::CameraError, geometry::ShapeError, texture::ImageTextureError};

/// Why there is no scene to render.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SceneError {
    /// No built-in scene has this name.
    #[error("unknown scene `{name}` (known: {known})")]
    UnknownScene {
        /// What was asked for.
        name: String,
        /// What there is.
        known: String,
    },
    /// A number of objects was asked for, but the scene's description lists them.
    #[error("scene `{name}` has a fixed number of objects (any number: {known})")]
    NotGenerated {
        /// The scene.
        name: String,
        /// The scenes that have as many objects as one likes.
        known: String,
    },
    /// The text is not that of a scene.
    #[error("{name}: {source}")]
    Syntax {
        /// The scene.
        name: String,
        /// What is wrong, with line and column.
        source: Box<toml::de::Error>,
    },
    /// The argument is neither a built-in scene nor a file of a known kind.
    #[error("unknown scene `{name}`: no built-in scene ({known}), and no .toml, .nff or .obj file")]
    UnknownFile {
        /// What was asked for.
        name: String,
        /// The built-in scenes.
        known: String,
    },
    /// A model alone came from standard input, where its material libraries and pictures cannot be.
    #[error("standard input: this is an OBJ, which is only read from a file; give its name")]
    ModelFromStdin,
    /// A model cannot be used.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A scene's text is wrong in one or more places.
    #[error(transparent)]
    Invalid(#[from] Faults),
    /// A scene's file is not read at all.
    #[error("{path}: {source}")]
    Text {
        /// The file.
        path: String,
        /// The reason.
        source: TextError,
    },
    /// The anti-aliasing of a scene is not understood.
    #[error("`aa` is `{mode}`, which is not understood: {reason}")]
    Aa {
        /// What it is.
        mode: String,
        /// Why it is not understood.
        reason: String,
    },
    /// A model is named where there are no files.
    #[error("model `{name}` is named by a scene that is not a file")]
    ModelWithoutFile {
        /// The model's file.
        name: String,
    },
    /// A file that a scene names is missing.
    #[error("{what} `{name}` is missing in {folder}")]
    NoFile {
        /// What it should be.
        what: &'static str,
        /// Its name.
        name: String,
        /// Where it was looked for.
        folder: String,
    },
    /// There is nothing to see.
    #[error("the scene is empty")]
    Empty,
    /// An NFF file is not a scene.
    #[error(transparent)]
    Nff(#[from] NffError),
    /// An object or a model uses a material that is not defined.
    #[error("{place} uses material `{material}`, which is not defined (known: {known})")]
    UnknownMaterial {
        /// The object or model, counted from 1.
        place: String,
        /// The material.
        material: String,
        /// The materials that are defined.
        known: String,
    },
    /// A material uses a texture that is not defined.
    #[error(
        "material `{material}` uses texture `{texture}`, which is not defined (known: {known})"
    )]
    UnknownTexture {
        /// The material.
        material: String,
        /// The texture.
        texture: String,
        /// The textures that are defined.
        known: String,
    },
    /// An object with a picture on it has no surface coordinates.
    #[error(
        "object {object} uses material `{material}`, which has a picture, but only a sphere or quad has surface coordinates"
    )]
    NoSurfaceCoordinates {
        /// The object, counted from 1.
        object: usize,
        /// The material.
        material: String,
    },
    /// The floor under a model alone cannot be made.
    #[error("{path}: there can be no floor under the model, which is too large ({source})")]
    Floor {
        /// The model's file.
        path: String,
        /// Why not.
        source: ShapeError,
    },
    /// A shape cannot be made.
    #[error("object {object} ({kind}): {source}")]
    Shape {
        /// The object, counted from 1.
        object: usize,
        /// The kind of shape.
        kind: &'static str,
        /// What is wrong with it.
        source: ShapeError,
    },
    /// A number is out of its range.
    #[error("{place}: `{name}` is {value}, but must be {range}")]
    Value {
        /// The part of the scene.
        place: String,
        /// The parameter.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What it may be.
        range: &'static str,
    },
    /// The camera sees nothing.
    #[error(transparent)]
    Camera(#[from] CameraError),
    /// A texture's picture cannot be read.
    #[error(transparent)]
    Image(#[from] ImageTextureError),
    /// A texture's picture is not there.
    #[error("texture `{name}` is not one of the program's own pictures (known: {known})")]
    UnknownImage {
        /// The picture.
        name: String,
        /// The pictures there are.
        known: String,
    },
}
