//! The flags that say what is seen, and from where.

use clap::Args;
use glam::DVec3;
use whitted::scene::{LoadOptions, Loaded, ModelPlace};

use super::super::failure::Failure;
use super::super::memory;
use super::super::parse::{parse_angle, parse_direction, parse_model, parse_objects, parse_vector};

#[derive(Debug, Args)]
pub(crate) struct SceneArgs {
    /// Built-in scene (`whitted scenes` lists them), or a file: .toml, .nff, or .obj (a model, shown
    /// on a floor under two lights); - is a .toml or .nff from standard input
    #[arg(default_value = "assignment")]
    pub(crate) scene: String,

    /// Objects in a generated scene (spheres), from 1 to 50000000 [default: 1000]
    #[arg(long, value_name = "N", value_parser = parse_objects, allow_negative_numbers = true, help_heading = "Scene")]
    pub(crate) objects: Option<u32>,

    /// Model to add, standing with its lowest point at X,Y,Z and scaled so that its largest side is SIZE;
    /// repeatable [default: on the floor in front of the scene's middle, in a fitting size]
    #[arg(long = "obj", value_name = "FILE[@X,Y,Z][*SIZE]", value_parser = parse_model, help_heading = "Scene")]
    pub(crate) models: Vec<ModelPlace>,

    /// Position of the camera, in scene units [default: the scene's own]
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_vector, allow_hyphen_values = true, help_heading = "Camera")]
    pub(crate) eye: Option<DVec3>,

    /// Point in the middle of the picture, in scene units [default: the scene's own]
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_vector, allow_hyphen_values = true, help_heading = "Camera")]
    pub(crate) look_at: Option<DVec3>,

    /// Direction that is up in the picture, or x, y, z for an axis; a model rendered alone stands upright
    /// along it [default: the scene's own; y for models]
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_direction, allow_hyphen_values = true, help_heading = "Camera")]
    pub(crate) up: Option<DVec3>,

    /// Vertical field of view in degrees, between 0 and 180 [default: the scene's own]
    #[arg(long, value_name = "DEGREES", value_parser = parse_angle, allow_negative_numbers = true, help_heading = "Camera")]
    pub(crate) fov: Option<f64>,
}

impl SceneArgs {
    /// The scene with what the flags change about it; `rows` as in [`LoadOptions`].
    pub(crate) fn load(&self, rows: Option<u32>) -> Result<Loaded, Failure> {
        self.objects.map_or(Ok(()), memory::check_objects)?;
        let options = LoadOptions {
            models: self.models.clone(),
            eye: self.eye,
            look_at: self.look_at,
            up: self.up,
            fov: self.fov,
            objects: self.objects,
            rows,
        };
        Ok(whitted::scene::load(&self.scene, &options)?)
    }
}
