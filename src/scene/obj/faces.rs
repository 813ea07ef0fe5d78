//! Which faces become triangles: what is double or has no area is left out.

use std::{collections::HashSet, ops::Range};

use glam::DVec3;
use rayon::prelude::*;

use super::{
    lists::{Obj, Tally},
    normals::Mixed,
};
use crate::{
    geometry::{mesh::has_area, triangulate::vector_area},
    math::random::mix,
};

/// How many faces are looked at by one thread at a time.
const BLOCK: usize = 1 << 14;

/// The outline of a face that is left out; no other outline has this number.
const NO_OUTLINE: u64 = 0;

/// Which faces are kept, and why others are not.
#[derive(Debug, Default)]
pub(super) struct Faces {
    /// Whether a face becomes triangles.
    pub(super) kept: Vec<bool>,
    pub(super) degenerate: Tally,
    pub(super) duplicate: Tally,
    /// Faces with a corner that was given twice in a row.
    pub(super) repeated: Tally,
}

/// The faces of a model in blocks, the same for any number of threads.
pub(super) fn blocks(obj: &Obj) -> impl IndexedParallelIterator<Item = Range<usize>> {
    let faces = obj.len();
    let block = move |k: usize| k * BLOCK..((k + 1) * BLOCK).min(faces);
    (0..faces.div_ceil(BLOCK)).into_par_iter().map(block)
}

impl Faces {
    /// Sorts the faces of `obj`, whose positions are equal where `first` says so.
    pub(super) fn sort_out(obj: &Obj, first: &[u32]) -> Self {
        let mut faces = Self::default();
        let mut outlines = Vec::with_capacity(obj.len());
        let found: Vec<_> = blocks(obj).map(|block| self::outlines(obj, first, block)).collect();
        for (found, degenerate, repeated) in found {
            outlines.extend(found);
            faces.degenerate.join(degenerate);
            faces.repeated.join(repeated);
        }
        faces.kept = outlines.iter().map(|outline| *outline != NO_OUTLINE).collect();
        let mut again = seen_before(&outlines);
        again.sort_unstable();
        for face in again {
            faces.kept[face as usize] = false;
            faces.duplicate.add(obj.lines[face as usize]);
        }
        faces
    }
}

/// The outlines of the faces of a block, and how many of them are degenerate or have repeated corners.
fn outlines(obj: &Obj, first: &[u32], faces: Range<usize>) -> (Vec<u64>, Tally, Tally) {
    let (mut degenerate, mut repeated) = (Tally::default(), Tally::default());
    let (mut points, mut outline) = (Vec::new(), Vec::new());
    let mut number = |face: usize| {
        let corners = &obj.corners[obj.face(face)];
        points.clear();
        points.extend(corners.iter().map(|c| obj.positions[*c as usize]));
        outline.clear();
        outline.extend(corners.iter().map(|c| first[*c as usize]));
        outline.dedup();
        while outline.len() > 1 && outline.first() == outline.last() {
            outline.pop();
        }
        if outline.len() < 3 || !spans_area(&points) {
            degenerate.add(obj.lines[face]);
            return NO_OUTLINE;
        }
        if outline.len() < corners.len() {
            repeated.add(obj.lines[face]);
        }
        outline_key(&outline).max(NO_OUTLINE + 1)
    };
    let outlines = faces.map(&mut number).collect();
    (outlines, degenerate, repeated)
}

/// The places of the outlines that are not the first of their kind.
fn seen_before(outlines: &[u64]) -> Vec<u32> {
    const PARTS: u64 = 8;
    let part = |part: u64| {
        let mut seen: HashSet<u64, std::hash::BuildHasherDefault<Mixed>> = HashSet::default();
        seen.reserve(outlines.len() / PARTS as usize);
        let numbered = outlines.iter().zip(0_u32..);
        let ours = numbered.filter(|(outline, _)| **outline % PARTS == part);
        ours.filter(|(outline, _)| **outline != NO_OUTLINE && !seen.insert(**outline))
            .map(|(_, face)| face)
            .collect::<Vec<u32>>()
    };
    (0..PARTS).into_par_iter().flat_map_iter(part).collect()
}

/// Whether a polygon has an area that is not only rounding.
fn spans_area(points: &[DVec3]) -> bool {
    if let &[a, b, c] = points {
        return has_area(&[a, b, c]);
    }
    vector_area(points) != DVec3::ZERO
        || points.windows(3).any(|w| matches!(*w, [a, b, c] if has_area(&[a, b, c])))
}

/// A number for the outline of a face that is the same wherever it begins and whichever way round it goes.
fn outline_key(outline: &[u32]) -> u64 {
    let count = outline.len();
    let start = (0..count).min_by_key(|k| outline[*k]).unwrap_or(0);
    let (next, last) = (outline[(start + 1) % count], outline[(start + count - 1) % count]);
    let mut key = count as u64;
    for k in 0..count {
        let corner = if next <= last { start + k } else { start + count - k };
        key = mix(key ^ u64::from(outline[corner % count])).wrapping_add(key << 1);
    }
    key
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outlines_are_the_same_from_every_corner_and_side() {
        let outline = [7, 2, 9, 4, 3];
        for turn in 0..5 {
            let mut turned = outline;
            turned.rotate_left(turn);
            assert_eq!(outline_key(&turned), outline_key(&outline));
            turned.reverse();
            assert_eq!(outline_key(&turned), outline_key(&outline));
        }
        assert_ne!(outline_key(&[7, 2, 9, 3, 4]), outline_key(&outline));
    }

    #[test]
    fn all_but_the_first_were_seen_before() {
        let outlines: Vec<u64> = (0..1000_u64).map(|k| mix(k % 700) % 690 + 1).collect();
        let mut found = seen_before(&outlines);
        found.sort_unstable();
        let is_again = |k: &u32| outlines[..*k as usize].contains(&outlines[*k as usize]);
        assert_eq!(found, (0..1000).filter(is_again).collect::<Vec<u32>>());
        assert!(found.len() >= 310);
        assert!(seen_before(&[NO_OUTLINE; 9]).is_empty());
    }
}
