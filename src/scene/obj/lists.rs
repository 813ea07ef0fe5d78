//! The statements of an OBJ file, in flat lists; nothing is repaired yet.

use std::ops::Range;

use glam::{DVec3, Vec2, Vec3};

/// No index, for a corner without surface coordinates or normal, and no material.
pub(super) const NONE: u32 = u32::MAX;

/// How faces are smoothed from here on, where they have no normals.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Smoothing {
    /// No `s` was seen.
    Unsaid,
    /// `s off`.
    Off,
    /// `s N`.
    Group(u32),
}

/// What holds from a face on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Section {
    pub(super) first_face: u32,
    /// A place in [`Obj::materials`], or [`NONE`].
    pub(super) material: u32,
    pub(super) smoothing: Smoothing,
}

/// The contents of an OBJ file.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Obj {
    pub(super) positions: Vec<DVec3>,
    /// Empty, or a colour for every position.
    pub(super) colors: Vec<Vec3>,
    pub(super) texcoords: Vec<Vec2>,
    /// Unit vectors; zero where the file has none that can be used.
    pub(super) normals: Vec<Vec3>,
    /// The end of every face in the lists of corners.
    pub(super) ends: Vec<u32>,
    /// The line of every face.
    pub(super) lines: Vec<u32>,
    pub(super) corners: Vec<u32>,
    /// Empty, or as long as the corners.
    pub(super) corner_texcoords: Vec<u32>,
    /// Empty, or as long as the corners.
    pub(super) corner_normals: Vec<u32>,
    pub(super) sections: Vec<Section>,
    /// The materials used, and the line of the first use.
    pub(super) materials: Vec<(String, u32)>,
    /// The material libraries, and their lines.
    pub(super) libraries: Vec<(String, u32)>,
    pub(super) tallies: Tallies,
}

/// How often, and in which line first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Tally {
    /// How often.
    pub(super) count: u32,
    /// The line of the first, from 1.
    pub(super) line: u32,
}

impl Tally {
    pub(super) fn add(&mut self, line: u32) {
        if self.count == 0 {
            self.line = line;
        }
        self.count = self.count.saturating_add(1);
    }

    /// Adds those that come `later`.
    pub(super) fn join(&mut self, later: Self) {
        if self.count == 0 {
            self.line = later.line;
        }
        self.count = self.count.saturating_add(later.count);
    }
}

/// What was counted on the way.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Tallies {
    pub(super) objects: Tally,
    pub(super) groups: Tally,
    /// Points and polylines, which a ray does not meet.
    pub(super) lines: Tally,
    pub(super) free_form: Tally,
    pub(super) bad_normals: Tally,
    pub(super) bad_texcoords: Tally,
    /// Faces of fewer than three corners.
    pub(super) short_faces: Tally,
    pub(super) unknown: Tally,
    pub(super) unknown_word: String,
    pub(super) smoothing_said: bool,
}

impl Obj {
    /// The number of faces.
    pub(super) fn len(&self) -> usize {
        self.ends.len()
    }

    /// The places of a face in the lists of corners.
    #[inline]
    pub(super) fn face(&self, face: usize) -> Range<usize> {
        let start = if face == 0 { 0 } else { self.ends[face - 1] };
        start as usize..self.ends[face] as usize
    }

    /// Whether a corner has no normal that can be used.
    pub(super) fn lacks_normal(&self, corner: usize) -> bool {
        match self.corner_normals.get(corner) {
            None | Some(&NONE) => true,
            Some(&normal) => self.normals[normal as usize] == Vec3::ZERO,
        }
    }

    /// What holds for a face.
    pub(super) fn section_at(&self, face: usize) -> &Section {
        let next = self.sections.partition_point(|s| s.first_face as usize <= face);
        &self.sections[next - 1]
    }

    /// What holds for `faces`, and for which of them.
    pub(super) fn sections_of(
        &self,
        faces: Range<usize>,
    ) -> impl Iterator<Item = (&Section, Range<usize>)> {
        let first = self.sections.partition_point(|s| s.first_face as usize <= faces.start).max(1);
        let sections = self.sections[first - 1..].iter();
        let ends = self.sections[first..].iter().map(|next| next.first_face as usize);
        sections
            .zip(ends.chain([self.len()]))
            .take_while(move |(section, _)| (section.first_face as usize) < faces.end)
            .map(move |(section, end)| {
                (section, faces.start.max(section.first_face as usize)..end.min(faces.end))
            })
    }

    /// How the faces of a section are smoothed; the format's default holds only where a file knows of smoothing at all.
    pub(super) fn smoothing_of(&self, section: &Section) -> Smoothing {
        match section.smoothing {
            Smoothing::Unsaid if self.tallies.smoothing_said => Smoothing::Off,
            smoothing => smoothing,
        }
    }
}

impl Tallies {
    /// Adds those of what comes `later`.
    pub(super) fn join(&mut self, later: Self) {
        if self.unknown.count == 0 {
            self.unknown_word = later.unknown_word;
        }
        self.unknown.join(later.unknown);
        self.objects.join(later.objects);
        self.groups.join(later.groups);
        self.lines.join(later.lines);
        self.free_form.join(later.free_form);
        self.bad_normals.join(later.bad_normals);
        self.bad_texcoords.join(later.bad_texcoords);
        self.short_faces.join(later.short_faces);
        self.smoothing_said |= later.smoothing_said;
    }
}
