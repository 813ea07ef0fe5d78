//! Whether faces close a space.

use super::{lists::Obj, normals::NumberMap, report::OpenEdge};

/// How many of the open edges are told.
const EXAMPLES: usize = 8;

/// The edges of the faces of `kept` that are not used once in either direction: how many there are, and some of them.
///
/// Points count as one if their coordinates are equal, as `first` says.
pub(super) fn open_edges(obj: &Obj, first: &[u32], kept: &[bool]) -> (usize, Vec<OpenEdge>) {
    struct Uses {
        forward: u32,
        backward: u32,
        line: u32,
    }
    let mut edges: NumberMap<Uses> = NumberMap::default();
    for (face, _) in kept.iter().enumerate().filter(|(_, kept)| **kept) {
        let corners = &obj.corners[obj.face(face)];
        for (k, corner) in corners.iter().enumerate() {
            let p = first[*corner as usize];
            let q = first[corners[(k + 1) % corners.len()] as usize];
            if p == q {
                continue;
            }
            let key = u64::from(p.min(q)) << 32 | u64::from(p.max(q));
            let line = obj.lines[face];
            let uses = edges.entry(key).or_insert(Uses { forward: 0, backward: 0, line });
            *(if p < q { &mut uses.forward } else { &mut uses.backward }) += 1;
        }
    }
    let is_open = |uses: &Uses| (uses.forward, uses.backward) != (1, 1);
    let mut open: Vec<_> = edges.iter().filter(|(_, uses)| is_open(uses)).collect();
    open.sort_unstable_by_key(|(key, uses)| (uses.line, **key));
    let example = |(key, uses): &(&u64, &Uses)| OpenEdge {
        line: uses.line,
        from: obj.positions[(**key >> 32) as usize].to_array(),
        to: obj.positions[(**key & 0xffff_ffff) as usize].to_array(),
        uses: uses.forward + uses.backward,
    };
    (open.len(), open.iter().take(EXAMPLES).map(example).collect())
}
