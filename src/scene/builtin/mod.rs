//! The scenes inside the program. Their texts and pictures are part of the binary, so they render anywhere.

use super::{Scene, desc::SceneDesc, error::SceneError, generators, parts::Parts};
use crate::texture::Image;

/// A built-in scene.
#[derive(Clone, Copy, Debug)]
pub struct Builtin {
    /// Its name.
    pub name: &'static str,
    /// What it shows, in a line.
    pub description: &'static str,
    text: &'static str,
    /// Makes the scene with so many objects, for those that have as many as one likes.
    generator: Option<fn(u32) -> Result<Parts, SceneError>>,
}

/// The scene of any number of spheres, without the spheres.
pub(super) const SPHERES: Builtin = Builtin {
    name: "spheres",
    description: "the stress scene: matte, mirror and glass spheres, as many as one likes (--objects)",
    text: include_str!("spheres.toml"),
    generator: Some(generators::spheres),
};

const BUILTINS: &[Builtin] = &[
    Builtin {
        name: "assignment",
        description: "mirror, glass, hollow and textured spheres, plaid cylinder and cone, a tetrahedron of six planes",
        text: include_str!("assignment.toml"),
        generator: None,
    },
    SPHERES,
];

const PICTURES: &[(&str, &[u8])] = &[
    ("cat.png", include_bytes!("../../../textures/cat.png")),
    ("flower.png", include_bytes!("../../../textures/flower.png")),
];

/// What begins the name of one of the program's own pictures in a scene file.
pub const PREFIX: &str = "builtin:";

/// The built-in scenes.
pub fn builtins() -> &'static [Builtin] {
    BUILTINS
}

impl Builtin {
    /// The scene as a file would say it, without generated objects.
    pub fn text(&self) -> &'static str {
        self.text
    }

    /// The scene's description.
    ///
    /// # Errors
    /// None, unless the program was built with a broken scene.
    pub fn desc(&self) -> Result<SceneDesc, SceneError> {
        let syntax =
            |source| SceneError::Syntax { name: self.name.to_owned(), source: Box::new(source) };
        toml::from_str(self.text).map_err(syntax)
    }

    /// The scene's parts, with so many objects, or its usual number of them.
    ///
    /// # Errors
    /// The objects are given by the description, but a number of them was asked for.
    pub fn parts(&self, objects: Option<u32>) -> Result<Parts, SceneError> {
        match (self.generator, objects) {
            (Some(generator), objects) => generator(objects.unwrap_or(generators::DEFAULT_OBJECTS)),
            (None, None) => Parts::try_new(&self.desc()?, &mut picture),
            (None, Some(_)) => Err(not_generated(self.name)),
        }
    }
}

/// What is wrong with asking the scene `name` for a number of objects.
pub(super) fn not_generated(name: &str) -> SceneError {
    let generated = BUILTINS.iter().filter(|builtin| builtin.generator.is_some());
    let known = generated.map(|builtin| builtin.name).collect::<Vec<_>>().join(", ");
    SceneError::NotGenerated { name: name.to_owned(), known }
}

/// The built-in scene of this name.
///
/// # Errors
/// No scene has this name.
pub fn builtin(name: &str) -> Result<&'static Builtin, SceneError> {
    BUILTINS.iter().find(|builtin| builtin.name == name).ok_or_else(|| {
        let known = BUILTINS.iter().map(|builtin| builtin.name).collect::<Vec<_>>().join(", ");
        SceneError::UnknownScene { name: name.to_owned(), known }
    })
}

/// The built-in scene of this name, ready to trace.
///
/// # Errors
/// No scene has this name.
pub fn load_builtin(name: &str) -> Result<Scene, SceneError> {
    load_builtin_of(name, None)
}

/// The built-in scene of this name with so many objects, or its usual number of them.
///
/// # Errors
/// No scene has this name; or its objects are given by its description, but a number of them was asked for.
pub fn load_builtin_of(name: &str, objects: Option<u32>) -> Result<Scene, SceneError> {
    let builtin = builtin(name)?;
    Scene::assemble(builtin.name, builtin.parts(objects)?)
}

/// One of the program's own pictures.
///
/// # Errors
/// None has this name.
pub fn picture(name: &str) -> Result<Image, SceneError> {
    let name = name.strip_prefix(PREFIX).unwrap_or(name);
    let Some((_, bytes)) = PICTURES.iter().find(|(known, _)| *known == name) else {
        let known = PICTURES.iter().map(|(known, _)| *known).collect::<Vec<_>>().join(", ");
        return Err(SceneError::UnknownImage { name: name.to_owned(), known });
    };
    Ok(Image::decode(name, bytes)?)
}
