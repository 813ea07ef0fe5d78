//! A scene's text against the table of keys: everything that is wrong, not only the first.

use std::{borrow::Cow, ops::Range as Span};

use toml::{
    Spanned,
    de::{DeTable, DeValue},
};

use super::{
    Place,
    fault::{Fault, Faults},
    keys::{Key, Kind, SCENE},
    lines::{Found, readable},
    nearest,
    sound::Sound,
    values::{listed, shown, unknown, unmet},
};

pub(super) type Value<'a> = Spanned<DeValue<'a>>;

/// Goes through a text and gathers its faults.
#[derive(Debug)]
pub(super) struct Checker<'a> {
    name: &'a str,
    text: &'a str,
    /// The text without the lines that hide what follows them.
    readable: Cow<'a, str>,
    pub(super) faults: Vec<Found>,
}

impl<'a> Checker<'a> {
    pub(super) fn new(name: &'a str, text: &'a str) -> Self {
        let (readable, faults) = readable(text);
        Self { name, text, readable, faults }
    }

    pub(super) fn fault(&mut self, span: Span<usize>, message: String) {
        self.faults.push((span, message));
    }

    pub(super) fn into_faults(mut self) -> Faults {
        self.faults.sort_by_key(|(span, _)| span.start);
        self.faults.dedup();
        let faults = self
            .faults
            .into_iter()
            .map(|(span, message)| Fault::new(self.text, span, message))
            .collect();
        Faults { file: self.name.to_owned(), faults }
    }

    /// Finds the faults; `exists` says whether a file that is named is there. If there are any, what is sound beside
    /// them is given back.
    pub(super) fn check(&mut self, exists: &dyn Fn(&str) -> bool) -> Option<Sound> {
        let (root, _) = DeTable::parse_recoverable(&self.readable);
        let root = root.get_ref();
        // What could not be parsed may be what seems to be missing.
        let is_whole = self.faults.is_empty();
        let walk = Walk { root, exists, is_whole };
        walk.table(root, SCENE, 0..0, "the scene", &mut self.faults);
        // Only what is complete and names nothing that was lost is sound.
        let strict = Walk { is_whole: true, ..walk };
        (!self.faults.is_empty()).then(|| Sound::read(&strict))
    }

    /// Where in the text a part of the scene is.
    pub(super) fn span(&self, place: &Place) -> Span<usize> {
        let (root, _) = DeTable::parse_recoverable(&self.readable);
        let get = |key: &str| find(root.get_ref(), key);
        let item = |key: &str, k: usize| get(key)?.get_ref().as_array()?.get(k);
        let named = |key: &str, name: &str| find(get(key)?.get_ref().as_table()?, name);
        let found = match place {
            Place::Scene(key) => get(key),
            Place::Light(k) => item("light", *k),
            Place::Object(k) => item("object", *k),
            Place::Model(k) => item("model", *k),
            Place::Texture(name) => named("texture", name),
            Place::Material(name) => named("material", name),
        };
        found.map_or(0..0, Spanned::span)
    }
}

pub(super) fn find<'t, 'a>(table: &'t DeTable<'a>, name: &str) -> Option<&'t Value<'a>> {
    table.iter().find(|(key, _)| key.get_ref() == name).map(|(_, value)| value)
}

/// Goes through the parts of a text.
pub(super) struct Walk<'t, 'a> {
    pub(super) root: &'t DeTable<'a>,
    exists: &'t dyn Fn(&str) -> bool,
    is_whole: bool,
}

impl Walk<'_, '_> {
    /// Finds what is wrong with each entry by itself; `what` is the word for its name.
    fn entries(&self, table: &DeTable, keys: &[Key], what: &str, found: &mut Vec<Found>) {
        for (name, value) in table {
            match keys.iter().find(|key| key.name == name.get_ref()) {
                Some(key) => self.value(value, key.kind, key.name, found),
                None => found.push((name.span(), unknown(what, name.get_ref(), keys))),
            }
        }
    }

    fn table(
        &self,
        table: &DeTable,
        keys: &[Key],
        at: Span<usize>,
        of: &str,
        found: &mut Vec<Found>,
    ) {
        self.entries(table, keys, "key", found);
        for key in keys.iter().filter(|key| key.required && self.is_whole) {
            if find(table, key.name).is_none() {
                found.push((at.clone(), format!("{of} has no `{}`: {}", key.name, key.about)));
            }
        }
    }

    fn one_of(
        &self,
        table: &DeTable,
        keys: &[Key],
        at: Span<usize>,
        of: &str,
        found: &mut Vec<Found>,
    ) {
        self.entries(table, keys, "kind", found);
        if table.len() != 1 {
            let known = listed(keys.iter().map(|key| key.name));
            found.push((at, format!("`{of}` must be exactly one of {known}")));
        }
    }

    /// Finds what is wrong with the value of the key `name`.
    pub(super) fn value(&self, value: &Value, kind: Kind, name: &str, found: &mut Vec<Found>) {
        let span = value.span();
        let mut wrong = |expected: &str| {
            let what = shown(value.get_ref());
            found.push((span.clone(), format!("`{name}` is {what}, but must be {expected}")));
        };
        match kind {
            Kind::Number(_)
            | Kind::Whole(_)
            | Kind::Text
            | Kind::Color
            | Kind::Vector
            | Kind::Size
            | Kind::Choice(_) => {
                if let Some(expected) = unmet(value.get_ref(), kind) {
                    wrong(&expected);
                }
            }
            Kind::File => match value.get_ref().as_str() {
                Some(file) if !file.is_empty() => {
                    if !(self.exists)(file) {
                        found.push((span, format!("there is no file `{file}`")));
                    }
                }
                _ => wrong("the name of a file"),
            },
            Kind::Vectors { least, most } => self.vectors(value, least, most, name, found),
            Kind::Name(table) => match value.get_ref().as_str() {
                Some(text) => self.name(text, table, name, value.span(), found),
                None => wrong(&format!("the name of a {table}")),
            },
            Kind::Table(keys) => match value.get_ref().as_table() {
                Some(table) => self.table(table, keys, span, &format!("`{name}`"), found),
                None => wrong("a table"),
            },
            Kind::OneOf(keys) => match value.get_ref().as_table() {
                Some(table) => self.one_of(table, keys, span, name, found),
                None => wrong("a table"),
            },
            Kind::Named(kind) => match value.get_ref().as_table() {
                Some(table) => {
                    table.iter().for_each(|(key, v)| self.value(v, *kind, key.get_ref(), found));
                }
                None => wrong("a table of names"),
            },
            Kind::List(kind) => match value.get_ref().as_array() {
                Some(list) => list.iter().for_each(|v| self.value(v, *kind, name, found)),
                None => wrong(&format!("a list; write [[{name}]]")),
            },
        }
    }

    fn vectors(
        &self,
        value: &Value,
        least: usize,
        most: usize,
        name: &str,
        found: &mut Vec<Found>,
    ) {
        let Some(list) = value.get_ref().as_array() else {
            let what = shown(value.get_ref());
            found
                .push((value.span(), format!("`{name}` is {what}, but must be a list of vectors")));
            return;
        };
        let count = list.len();
        if count < least || count > most {
            let range =
                if least == most { least.to_string() } else { format!("{least} to {most}") };
            found.push((
                value.span(),
                format!("`{name}` has {count} vectors, but must have {range}"),
            ));
        }
        for vector in list {
            self.value(vector, Kind::Vector, name, found);
        }
    }

    /// Whether there is an entry of this name in the table that holds such names.
    fn name(&self, text: &str, table: &str, key: &str, span: Span<usize>, found: &mut Vec<Found>) {
        let entries = find(self.root, table).and_then(|value| value.get_ref().as_table());
        if entries.is_some_and(|entries| find(entries, text).is_some()) || !self.is_whole {
            return;
        }
        let names = || entries.into_iter().flatten().map(|(name, _)| name.get_ref().as_ref());
        let hint = match nearest(text, names()) {
            Some(near) => format!("did you mean `{near}`?"),
            None if names().next().is_none() => format!("there is no [{table}] at all"),
            None => format!("known: {}", listed(names().take(12))),
        };
        found.push((
            span,
            format!("`{key}` is `{text}`, which is no {table} of this scene; {hint}"),
        ));
    }
}
