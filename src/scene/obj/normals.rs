//! Normals for faces that have none: by smoothing group, or where faces meet at a small angle.

use std::collections::HashMap;

use glam::{DVec3, Vec3};

use super::parse::{NONE, Obj, Smoothing};
use super::weld::mix;
use crate::math::scale;

/// Faces without smoothing groups are smooth where they meet at less than this angle.
const CREASE_DEGREES: f64 = 30.0;

/// A corner of a face as one of the corners around its point, linked to others that share its normal.
#[derive(Debug)]
struct Links {
    parent: Vec<u32>,
}

impl Links {
    fn find(&mut self, mut x: u32) -> u32 {
        while self.parent[x as usize] != x {
            let grandparent = self.parent[self.parent[x as usize] as usize];
            self.parent[x as usize] = grandparent;
            x = grandparent;
        }
        x
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.find(a), self.find(b));
        self.parent[a.max(b) as usize] = a.min(b);
    }
}

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

/// Gives every corner of the faces of `wanted` without a usable normal one, where its face is to be smooth.
///
/// `areas` are the vector areas of the faces, `first` the first of the positions equal to each. A smooth normal is the mean
/// of the faces' normals around a point, weighted by their angles there, so that it does not depend on how the
/// faces are cut.
pub(super) fn complete(obj: &mut Obj, areas: &[DVec3], first: &[u32], wanted: &[bool]) {
    if obj.corner_normals.is_empty() {
        obj.corner_normals = vec![NONE; obj.corners.len()];
    }
    let mut links = Links { parent: (0..obj.corners.len() as u32).collect() };
    let mut groups: NumberMap<u32> = NumberMap::default();
    // Faces by edge, as face and corner, in half-full open addressing: files have millions of edges.
    let is_any_unsaid = !obj.tallies.smoothing_said;
    let slots = if is_any_unsaid { obj.corners.len() } else { 1 };
    let mut edges = vec![[NONE; 2]; slots.next_power_of_two().max(4) * 2];
    let mask = edges.len() - 1;
    let crease = CREASE_DEGREES.to_radians().cos();
    let mut missing = vec![false; obj.corners.len()];
    for_each_face(obj, |obj, face, smoothing| {
        if !wanted[face] {
            return;
        }
        let range = obj.face(face);
        for corner in range.clone() {
            missing[corner] = smoothing != Smoothing::Off && lacks_normal(obj, corner);
        }
        match smoothing {
            Smoothing::Off => {}
            Smoothing::Group(group) => {
                for corner in range {
                    let point = first[obj.corners[corner] as usize];
                    let key = u64::from(point) << 32 | u64::from(group);
                    let other = *groups.entry(key).or_insert(corner as u32);
                    links.join(other, corner as u32);
                }
            }
            Smoothing::Unsaid => {
                let count = range.len();
                for k in 0..count {
                    let (c, d) = (range.start + k, range.start + (k + 1) % count);
                    let point = |c: usize| first[obj.corners[c] as usize];
                    let (p, q) = (point(c), point(d));
                    let (from, to) = if p < q { (c, d) } else { (d, c) };
                    let key = [p.min(q), p.max(q)];
                    let here = [face as u32, from as u32, to as u32];
                    let mut slot = mix(u64::from(key[0]) << 32 | u64::from(key[1])) as usize & mask;
                    let there = loop {
                        let [other, start] = edges[slot];
                        if other == NONE {
                            edges[slot] = [face as u32, k as u32];
                            break here;
                        }
                        let range = obj.face(other as usize);
                        let count = range.len();
                        let (c, d) = (
                            range.start + start as usize,
                            range.start + (start as usize + 1) % count,
                        );
                        let (p, q) = (point(c), point(d));
                        if [p.min(q), p.max(q)] == key {
                            let (from, to) = if p < q { (c, d) } else { (d, c) };
                            break [other, from as u32, to as u32];
                        }
                        slot = (slot + 1) & mask;
                    };
                    let [a, b] = [here, there].map(|edge| areas[edge[0] as usize]);
                    if unit(a).dot(unit(b)) > crease {
                        links.join(here[1], there[1]);
                        links.join(here[2], there[2]);
                    }
                }
            }
        }
    });
    let mut number_of = vec![NONE; obj.corners.len()];
    let mut count = 0;
    for (corner, _) in missing.iter().enumerate().filter(|(_, missing)| **missing) {
        let root = links.find(corner as u32) as usize;
        if number_of[root] == NONE {
            number_of[root] = count;
            count += 1;
        }
    }
    let sums = sums(obj, areas, wanted, &mut links, &number_of, count as usize);
    let base = obj.normals.len() as u32;
    obj.normals.extend(sums.iter().map(|n| n.normalize_or_zero().as_vec3()));
    for (corner, _) in missing.iter().enumerate().filter(|(_, missing)| **missing) {
        obj.corner_normals[corner] = base + number_of[links.find(corner as u32) as usize];
    }
}

fn lacks_normal(obj: &Obj, corner: usize) -> bool {
    match obj.corner_normals[corner] {
        NONE => true,
        normal => obj.normals[normal as usize] == Vec3::ZERO,
    }
}

/// The sum of the faces' unit normals by angle, for each of `count` sets of linked corners.
fn sums(
    obj: &Obj,
    areas: &[DVec3],
    wanted: &[bool],
    links: &mut Links,
    number_of: &[u32],
    count: usize,
) -> Vec<DVec3> {
    let mut sums = vec![DVec3::ZERO; count];
    for (face, area) in areas.iter().enumerate() {
        if !wanted[face] {
            continue;
        }
        let range = obj.face(face);
        let normal = unit(*area);
        let count = range.len();
        for k in 0..count {
            let number = number_of[links.find((range.start + k) as u32) as usize];
            if number == NONE {
                continue;
            }
            let at = |k: usize| obj.positions[obj.corners[range.start + k % count] as usize];
            let (p, back, on) = (at(k), at(k + count - 1), at(k + 1));
            let (u, v) = (unit(back - p), unit(on - p));
            sums[number as usize] += normal * u.cross(v).length().atan2(u.dot(v));
        }
    }
    sums
}

fn unit(v: DVec3) -> DVec3 {
    scale::normalized(v).0.normalize_or_zero()
}

/// Calls `visit` with every face and its smoothing.
pub(super) fn for_each_face(obj: &Obj, mut visit: impl FnMut(&Obj, usize, Smoothing)) {
    for (k, section) in obj.sections.iter().enumerate() {
        let end = obj.sections.get(k + 1).map_or(obj.len(), |next| next.first_face as usize);
        for face in section.first_face as usize..end {
            // The format's default holds only where a file knows of smoothing at all.
            let is_default = section.smoothing == Smoothing::Unsaid && obj.tallies.smoothing_said;
            visit(obj, face, if is_default { Smoothing::Off } else { section.smoothing });
        }
    }
}
