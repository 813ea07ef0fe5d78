//! The statements of an OBJ file, read in parts of a fixed size, each by one thread.
//!
//! What an index may mean depends on how much stands before it, so a first pass counts that. The lists and the messages
//! are those of one reader from top to bottom, whatever the number of threads.

use std::collections::HashMap;

use glam::Vec3;
use rayon::prelude::*;

use super::{
    error::ModelError,
    lists::{NONE, Obj, Section, Smoothing, Tallies},
    statement::{Part, Said},
};
use crate::scene::text::{Lines, TextError, Tokens, decode::LARGEST_FILE, lines};

impl Obj {
    /// Reads the statements of `text`; `path` is for messages.
    pub(super) fn parse(path: &str, text: &[u8]) -> Result<Self, ModelError> {
        Self::join(path, Parts::read(path, text, PART)?)
    }

    /// The contents of a file from its parts.
    pub(super) fn join(path: &str, Parts(parts): Parts) -> Result<Self, ModelError> {
        let mut all = Self::default();
        let mut joint = Joint::default();
        all.reserve(&parts);
        for part in parts {
            joint.join(&mut all, part);
        }
        let corners = all.corners.len();
        for list in [&mut all.corner_texcoords, &mut all.corner_normals] {
            if !list.is_empty() {
                list.resize(corners, NONE);
            }
        }
        if !all.colors.is_empty() {
            all.colors.resize(all.positions.len(), Vec3::ONE);
        }
        if all.ends.is_empty() {
            let Tallies { unknown, unknown_word, .. } = &all.tallies;
            return Err(ModelError::NoFace {
                path: path.to_owned(),
                hint: match unknown.count {
                    0 => String::new(),
                    _ => format!(" (line {}: unknown statement `{unknown_word}`)", unknown.line),
                },
            });
        }
        Ok(all)
    }

    fn reserve(&mut self, parts: &[Part]) {
        let count = |of: fn(&Self) -> usize| parts.iter().map(|part| of(&part.obj)).sum();
        self.positions.reserve_exact(count(|obj| obj.positions.len()));
        self.texcoords.reserve_exact(count(|obj| obj.texcoords.len()));
        self.normals.reserve_exact(count(|obj| obj.normals.len()));
        self.ends.reserve_exact(count(|obj| obj.ends.len()));
        self.lines.reserve_exact(count(|obj| obj.lines.len()));
        let corners = count(|obj| obj.corners.len());
        self.corners.reserve_exact(corners);
        if count(|obj| obj.corner_texcoords.len()) > 0 {
            self.corner_texcoords.reserve_exact(corners);
        }
        if count(|obj| obj.corner_normals.len()) > 0 {
            self.corner_normals.reserve_exact(corners);
        }
    }
}

/// How much of a file stands before a part of it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Counts {
    pub(super) lines: u32,
    pub(super) positions: usize,
    pub(super) texcoords: usize,
    pub(super) normals: usize,
}

impl Counts {
    /// Those of one text.
    fn of(text: &[u8]) -> Self {
        let mut counts = Self::default();
        let mut lines = Lines::after(0, text);
        while let Some((_, line)) = lines.next_line() {
            match Tokens::new(line).next_word() {
                Some(b"v") => counts.positions += 1,
                Some(b"vt") => counts.texcoords += 1,
                Some(b"vn") => counts.normals += 1,
                _ => {}
            }
        }
        counts.lines = lines.count();
        counts
    }

    fn add(&mut self, other: Self) {
        self.lines = self.lines.saturating_add(other.lines);
        self.positions += other.positions;
        self.texcoords += other.texcoords;
        self.normals += other.normals;
    }
}

/// The parts of a file, read but not yet joined; the text itself is needed no more.
#[derive(Debug)]
pub(super) struct Parts(Vec<Part>);

/// The least size of a part, in bytes.
pub(super) const PART: usize = 1 << 18;

impl Parts {
    /// Reads the statements of `text` in parts of at least so many bytes; `path` is for messages.
    pub(super) fn read(path: &str, text: &[u8], least: usize) -> Result<Self, ModelError> {
        if text.len() as u64 > LARGEST_FILE {
            let source = TextError::TooLarge { most: LARGEST_FILE };
            return Err(ModelError::Text { path: path.to_owned(), source });
        }
        let texts = lines::parts(text, least);
        let counts: Vec<Counts> = texts.par_iter().map(|text| Counts::of(text)).collect();
        let mut before = Counts::default();
        let befores = counts.into_iter().map(|counts| {
            let here = before;
            before.add(counts);
            here
        });
        let befores: Vec<Counts> = befores.collect();
        let read = texts.par_iter().zip(befores).map(|(text, before)| Part::read(text, before));
        let parts: Vec<_> = read.collect();
        // Of several errors the first in the file.
        let parts: Result<Vec<Part>, _> = parts.into_iter().collect();
        parts.map(Self).map_err(|(line, reason)| ModelError::Line {
            path: path.to_owned(),
            line,
            reason,
        })
    }
}

/// What goes on from one part to the next.
#[derive(Debug, Default)]
struct Joint {
    numbers: HashMap<String, u32>,
    material: Option<u32>,
    smoothing: Option<Smoothing>,
}

impl Joint {
    fn join(&mut self, all: &mut Obj, part: Part) {
        let Part { obj, said, .. } = part;
        let (faces, corners) = (all.ends.len() as u32, all.corners.len());
        let numbers: Vec<u32> = obj
            .materials
            .into_iter()
            .map(|(name, line)| {
                *self.numbers.entry(name).or_insert_with_key(|name| {
                    all.materials.push((name.clone(), line));
                    all.materials.len() as u32 - 1
                })
            })
            .collect();
        let faces_here = obj.ends.len() as u32;
        for Said { first_face, material, smoothing } in said {
            self.material = material.map(|number| numbers[number as usize]).or(self.material);
            self.smoothing = smoothing.or(self.smoothing);
            let section = Section {
                first_face: faces + first_face,
                material: self.material.unwrap_or(NONE),
                smoothing: self.smoothing.unwrap_or(Smoothing::Unsaid),
            };
            let is_same = all.sections.last().is_some_and(|last| {
                (last.material, last.smoothing) == (section.material, section.smoothing)
            });
            if first_face < faces_here && !is_same {
                all.sections.push(section);
            }
        }
        if !obj.colors.is_empty() {
            all.colors.resize(all.positions.len(), Vec3::ONE);
            all.colors.extend(obj.colors);
        }
        all.positions.extend(obj.positions);
        all.texcoords.extend(obj.texcoords);
        all.normals.extend(obj.normals);
        all.ends.extend(obj.ends.iter().map(|end| corners as u32 + end));
        all.lines.extend(obj.lines);
        all.corners.extend(obj.corners);
        for (list, more) in [
            (&mut all.corner_texcoords, obj.corner_texcoords),
            (&mut all.corner_normals, obj.corner_normals),
        ] {
            if !more.is_empty() {
                list.resize(corners, NONE);
                list.extend(more);
            }
        }
        all.libraries.extend(obj.libraries);
        all.tallies.join(obj.tallies);
    }
}

#[cfg(test)]
mod tests {
    use super::{super::lists::Tally, *};

    const TEXT: &str = "mtllib a.mtl\nv 0 0 0\nv 1 0 0 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\nf 1 2 3\ns 1\nusemtl a\n\
        f 1/1 2/1 \\\n3/1\nusemtl b\nvn 0 0 nan\nf -3//-1 -2//2 -1//1\no x\nv 1 1 1\ng\nusemtl a\nf 1 2\nwhat\n\
        f 1//1 2//1 4//1\ns off\nusemtl b\nf 4 3 2 1\nl 1 2\nusemtl c\nhuh\nusemtl b\n\nf 1 2 4\nusemtl d";

    /// Oracle: the whole text as one part.
    #[test]
    fn parts_of_any_size_make_the_same_model() {
        let read = |text: &str, least| Obj::join("m", Parts::read("m", text.as_bytes(), least)?);
        let whole = read(TEXT, TEXT.len()).expect("a model");
        assert_eq!((whole.len(), whole.sections.len(), whole.materials.len()), (6, 5, 4));
        assert_eq!(whole.tallies.unknown, Tally { count: 2, line: 20 });
        for least in 1..TEXT.len() {
            let parts = read(TEXT, least).expect("a model");
            assert_eq!(parts.positions.len(), 4);
            assert!(parts == whole, "in parts of {least}: {parts:#?} for {whole:#?}");
            let wrong = format!("{TEXT}\nv 1 2 3\nvn 1 2 3\nf 1 2 6\nf x");
            let error = read(&wrong, least).expect_err("an index out of range").to_string();
            assert_eq!(error, "m:34: position index 6 is out of range, must be 1 to 5 or -1 to -5");
        }
    }
}
