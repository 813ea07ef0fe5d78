//! The text format of scenes: TOML, checked against one table of keys, from which its JSON schema is printed too.

mod check;
mod fault;
mod keys;
mod nearest;
mod schema;

pub use self::{
    fault::{Fault, Faults},
    nearest::nearest,
    schema::schema,
};
use super::desc::SceneDesc;
use check::Checker;

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
    /// The description.
    pub desc: SceneDesc,
}

impl<'a> SceneText<'a> {
    /// Reads the description in `text`, that of the file `name`; `exists` says whether a file that it names is there.
    ///
    /// # Errors
    /// All that is wrong with it: syntax, unknown, missing and mistyped keys, values out of range, undefined names.
    pub fn parse(
        name: &'a str,
        text: &'a str,
        exists: &dyn Fn(&str) -> bool,
    ) -> Result<Self, Faults> {
        let mut checker = Checker::new(name, text);
        checker.check(exists);
        if !checker.faults.is_empty() {
            return Err(checker.into_faults());
        }
        match toml::from_str(text) {
            Ok(desc) => Ok(Self { checker, desc }),
            // The table of keys and the types disagree; the message is still the user's.
            Err(error) => {
                checker.fault(error.span().unwrap_or(0..0), error.message().to_owned());
                Err(checker.into_faults())
            }
        }
    }

    /// What was found wrong later on, with its places in the text.
    pub fn faults(mut self, found: Vec<(Place, String)>) -> Faults {
        for (place, message) in found {
            let span = self.checker.span(&place);
            self.checker.fault(span, message);
        }
        self.checker.into_faults()
    }
}
