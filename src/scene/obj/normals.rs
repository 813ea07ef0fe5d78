//! Normals for faces that have none: by smoothing group, or where faces meet at a small angle.
//!
//! Which corners share a normal is settled point by point, among the corners around it alone, so that the points are
//! spread over the threads.

use std::{collections::HashMap, ops::Range};

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::lists::{NONE, Obj, Smoothing};
use crate::{
    geometry::triangulate::vector_area,
    math::{random::mix, scale},
    scene::disjoint::DisjointSets,
};

/// Faces without smoothing groups are smooth where they meet at less than this angle.
const CREASE_DEGREES: f64 = 30.0;

/// How many points are looked at by one thread at a time.
const BLOCK: usize = 1 << 13;

/// A hasher for keys that are already mixed.
#[derive(Debug, Default)]
pub(super) struct Mixed(u64);

impl std::hash::Hasher for Mixed {
    fn finish(&self) -> u64 {
        self.0
    }

    fn write(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.write_u64(u64::from(*byte));
        }
    }

    fn write_u64(&mut self, x: u64) {
        self.0 = mix(self.0 ^ x);
    }
}

/// A map from numbers that trusts nobody's distribution of them.
pub(super) type NumberMap<V> = HashMap<u64, V, std::hash::BuildHasherDefault<Mixed>>;

/// What the making of normals looks at.
struct Sight<'a> {
    obj: &'a Obj,
    /// The first of the positions equal to each.
    first: &'a [u32],
    /// The unit normals of the faces that want normals.
    units: &'a [DVec3],
    crease: f64,
}

/// Gives every corner of the faces of `wanted` without a usable normal one, where its face is to be smooth.
///
/// `first` are the first of the positions equal to each. A smooth normal is the mean of the faces' normals around a
/// point, weighted by their angles there, so that it does not depend on how the faces are cut.
pub(super) fn complete(obj: &mut Obj, first: &[u32], wanted: &[bool]) {
    if obj.corner_normals.is_empty() {
        obj.corner_normals = vec![NONE; obj.corners.len()];
    }
    let mut around = Around::new(obj, first, wanted);
    let units = units(obj, wanted);
    let crease = CREASE_DEGREES.to_radians().cos();
    let sight = Sight { obj, first, units: &units, crease };
    let blocks = around.blocks().into_par_iter();
    let made: Vec<Vec<Vec3>> = blocks
        .map_init(Ring::default, |ring, (starts, corners)| {
            let mut normals = Vec::new();
            for ends in starts.windows(2) {
                let [start, end] = [ends[0], ends[1]].map(|at| (at - starts[0]) as usize);
                ring.complete(&sight, &mut corners[start..end], &mut normals);
            }
            normals
        })
        .collect();
    drop(units);
    obj.normals.reserve_exact(made.iter().map(Vec::len).sum());
    for ((_, corners), normals) in around.blocks().into_iter().zip(made) {
        let base = obj.normals.len() as u32;
        for [number, corner] in corners.iter().filter(|[number, _]| *number != NONE) {
            obj.corner_normals[*corner as usize] = base + number;
        }
        obj.normals.extend(normals);
    }
}

/// The corners of the faces around each point, in the order of the file.
#[derive(Debug)]
struct Around {
    /// Where the corners of each point begin; then where the last end.
    starts: Vec<u32>,
    /// Face and corner; when normals are made, the number of the corner's new one in its block, and the corner.
    corners: Vec<[u32; 2]>,
}

impl Around {
    /// Of the faces that are `wanted` and not flat.
    fn new(obj: &Obj, first: &[u32], wanted: &[bool]) -> Self {
        let points = obj.positions.len();
        // Two places on, so that while the corners are put in, the starts move to where they belong.
        let mut starts = vec![0_u32; points + 2];
        for_each_corner(obj, wanted, |_, corner| {
            starts[first[obj.corners[corner] as usize] as usize + 2] += 1;
        });
        let mut sum = 0;
        for start in &mut starts {
            sum += *start;
            *start = sum;
        }
        let mut corners = vec![[0; 2]; sum as usize];
        for_each_corner(obj, wanted, |face, corner| {
            let next = &mut starts[first[obj.corners[corner] as usize] as usize + 1];
            corners[*next as usize] = [face as u32, corner as u32];
            *next += 1;
        });
        starts.truncate(points + 1);
        Self { starts, corners }
    }

    /// Blocks of points: where the corners of each begin, and the corners.
    fn blocks(&mut self) -> Vec<(&[u32], &mut [[u32; 2]])> {
        let Self { starts, corners } = self;
        let points = starts.len() - 1;
        let mut rest = corners.as_mut_slice();
        let block = |k: usize| {
            let starts = &starts[k..=(k + BLOCK).min(points)];
            let count = (starts[starts.len() - 1] - starts[0]) as usize;
            let (ours, others) = std::mem::take(&mut rest).split_at_mut(count);
            rest = others;
            (starts, ours)
        };
        (0..points).step_by(BLOCK).map(block).collect()
    }
}

/// Calls `visit` with the corners, and their faces, that are `wanted` and not flat.
fn for_each_corner(obj: &Obj, wanted: &[bool], mut visit: impl FnMut(usize, usize)) {
    for (section, faces) in obj.sections_of(0..obj.len()) {
        if obj.smoothing_of(section) != Smoothing::Off {
            for face in faces.filter(|face| wanted[*face]) {
                obj.face(face).for_each(|corner| visit(face, corner));
            }
        }
    }
}

/// The unit normals of the `wanted` faces.
fn units(obj: &Obj, wanted: &[bool]) -> Vec<DVec3> {
    let normal = |points: &mut Vec<DVec3>, face: usize| {
        if !wanted[face] {
            return DVec3::ZERO;
        }
        points.clear();
        points.extend(obj.corners[obj.face(face)].iter().map(|c| obj.positions[*c as usize]));
        unit(vector_area(points))
    };
    (0..obj.len()).into_par_iter().with_min_len(1 << 12).map_init(Vec::new, normal).collect()
}

/// The corners around one point; keeps its memory from one to the next.
#[derive(Debug, Default)]
struct Ring {
    /// Links between corners that share a normal.
    sets: DisjointSets,
    /// The first corner of each smoothing group, or at each edge from the point.
    seen: Vec<(u64, u32)>,
    /// Where there are too many to go through them.
    crowd: NumberMap<u32>,
    /// The numbers of the normals, at the roots of the links.
    numbers: Vec<u32>,
    sums: Vec<DVec3>,
}

/// The longest list that is searched one by one.
const CROWD: usize = 24;

impl Ring {
    /// Makes the normals of the `corners` that lack one, puts them after `normals`, and their numbers in place of the
    /// faces.
    fn complete(&mut self, sight: &Sight, corners: &mut [[u32; 2]], normals: &mut Vec<Vec3>) {
        let lacks = |corner: u32| sight.obj.lacks_normal(corner as usize);
        if !corners.iter().any(|[_, corner]| lacks(*corner)) {
            for [number, _] in corners {
                *number = NONE;
            }
            return;
        }
        self.link(sight, corners);
        self.numbers.clear();
        self.numbers.resize(corners.len(), NONE);
        self.sums.clear();
        for (k, [_, corner]) in corners.iter().enumerate() {
            let root = self.sets.find(k as u32) as usize;
            if lacks(*corner) && self.numbers[root] == NONE {
                self.numbers[root] = self.sums.len() as u32;
                self.sums.push(DVec3::ZERO);
            }
        }
        let base = normals.len() as u32;
        for (k, entry) in corners.iter_mut().enumerate() {
            let [face, corner] = *entry;
            let root = self.sets.find(k as u32) as usize;
            let number = self.numbers[root];
            entry[0] = if lacks(corner) { base + number } else { NONE };
            if number != NONE {
                self.sums[number as usize] +=
                    sight.units[face as usize] * sight.angle(face as usize, corner as usize);
            }
        }
        normals.extend(self.sums.iter().map(|n| n.normalize_or_zero().as_vec3()));
    }

    /// Links the corners that share a normal.
    fn link(&mut self, sight: &Sight, corners: &[[u32; 2]]) {
        let Sight { obj, first, units, crease } = *sight;
        self.sets.reset(corners.len());
        self.seen.clear();
        self.crowd.clear();
        for (&[face, corner], here) in corners.iter().zip(0_u32..) {
            let (face, corner) = (face as usize, corner as usize);
            if let Smoothing::Group(group) = obj.smoothing_of(obj.section_at(face)) {
                let there = self.first_with(u64::from(group), here);
                self.sets.join(there, here);
                continue;
            }
            let point = |corner: usize| first[obj.corners[corner] as usize];
            for other in neighbors(obj, face, corner) {
                if point(other) == point(corner) {
                    continue;
                }
                let there = self.first_with(u64::from(point(other)), here);
                let other_face = corners[there as usize][0] as usize;
                if units[face].dot(units[other_face]) > crease {
                    self.sets.join(there, here);
                }
            }
        }
    }

    /// The first corner that came with `key`: `here`, if there was none.
    fn first_with(&mut self, key: u64, here: u32) -> u32 {
        if let Some((_, there)) = self.seen.iter().find(|(seen, _)| *seen == key) {
            return *there;
        }
        if self.seen.len() < CROWD {
            self.seen.push((key, here));
            return here;
        }
        *self.crowd.entry(key).or_insert(here)
    }
}

impl Sight<'_> {
    /// The angle of a face at one of its corners, in radians.
    fn angle(&self, face: usize, corner: usize) -> f64 {
        let at = |corner: usize| self.obj.positions[self.obj.corners[corner] as usize];
        let [back, on] = neighbors(self.obj, face, corner).map(at);
        let (u, v) = (unit(back - at(corner)), unit(on - at(corner)));
        u.cross(v).length().atan2(u.dot(v))
    }
}

/// The corners before and after one of a face.
fn neighbors(obj: &Obj, face: usize, corner: usize) -> [usize; 2] {
    let Range { start, end } = obj.face(face);
    [
        if corner == start { end - 1 } else { corner - 1 },
        if corner + 1 == end { start } else { corner + 1 },
    ]
}

fn unit(v: DVec3) -> DVec3 {
    scale::normalized(v).0.normalize_or_zero()
}
