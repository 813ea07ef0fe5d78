//! The text format of scenes: TOML, checked against one table of keys, from which its JSON schema is printed too.

mod check;
mod fault;
mod keys;
mod lines;
mod nearest;
mod schema;
mod sound;
mod values;

pub use self::{
    fault::{Fault, Faults},
    nearest::nearest,
    schema::schema,
};
use super::{
    desc::SceneDesc,
    load::{ImageSource, ModelSource},
    parts::Parts,
};
use check::Checker;
use sound::Sound;

/// A place in a scene's description, for saying where something is wrong with it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Place {
    /// The scene as a whole, or one of its own keys.
    Scene(&'static str),
    /// The light of this number, from 0.
    Light(usize),
    /// The texture of this name.
    Texture(String),
    /// The material of this name.
    Material(String),
    /// The object of this number, from 0.
    Object(usize),
    /// The model of this number, from 0.
    Model(usize),
}

/// A scene's description, with the text that says it.
#[derive(Debug)]
pub struct SceneText<'a> {
    checker: Checker<'a>,
    /// The description; if the text is faulty, what is sound of it.
    sound: Sound,
}

impl<'a> SceneText<'a> {
    /// Reads the description in `text`, that of the file `name`; `exists` says whether a file that it names is there.
    ///
    /// # Errors
    /// Table of keys and types disagree.
    pub fn parse(
        name: &'a str,
        text: &'a str,
        exists: &dyn Fn(&str) -> bool,
    ) -> Result<Self, Faults> {
        let mut checker = Checker::new(name, text);
        if let Some(sound) = checker.check(exists) {
            return Ok(Self { checker, sound });
        }
        match toml::from_str(text) {
            Ok(desc) => Ok(Self { checker, sound: Sound::all(desc) }),
            // The table of keys and the types disagree; the message is still the user's.
            Err(error) => {
                checker.fault(error.span().unwrap_or(0..0), error.message().to_owned());
                Err(checker.into_faults())
            }
        }
    }

    /// The description; if the text is faulty, what is sound of it.
    pub fn desc(&self) -> &SceneDesc {
        &self.sound.desc
    }

    /// The parts of the scene; `images` and `models` find what it names.
    ///
    /// # Errors
    /// All that is wrong with it: unknown, missing and mistyped keys, values out of range, undefined names, shapes
    /// without size, files that cannot be used.
    pub fn parts(
        mut self,
        images: &mut ImageSource,
        models: &mut ModelSource,
    ) -> Result<Parts, Faults> {
        let found = match Parts::gather(&self.sound.desc, images, models) {
            Ok(parts) if self.checker.faults.is_empty() => return Ok(parts),
            Ok(_) => Vec::new(),
            Err(found) => found,
        };
        for (place, error) in found {
            let span = self.checker.span(&self.sound.in_text(place));
            self.checker.fault(span, error.to_string());
        }
        Err(self.checker.into_faults())
    }
}
