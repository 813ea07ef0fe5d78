//! Corners that agree in position, surface coordinates and normal become one vertex.

use super::{
    lists::{NONE, Obj},
    normals::NumberMap,
};
use crate::math::random::mix;

/// The vertices that differ in position, surface coordinates or normal.
pub(super) struct Vertices {
    /// The places of position, surface coordinates and normal in their lists, or [`NONE`].
    pub(super) keys: Vec<[u32; 3]>,
    /// The first vertex at each position.
    at: Vec<u32>,
    /// The next vertex at the same position.
    next: Vec<u32>,
    /// Where a position has too many to go through them.
    crowded: NumberMap<Vec<u32>>,
}

/// The longest list of vertices of one position that is searched one by one.
const CROWD: usize = 16;

impl Vertices {
    pub(super) fn new(obj: &Obj) -> Self {
        let at = vec![NONE; obj.positions.len()];
        Self { keys: Vec::new(), at, next: Vec::new(), crowded: NumberMap::default() }
    }

    /// The vertex of a corner.
    pub(super) fn place(&mut self, obj: &Obj, corner: usize) -> u32 {
        let attribute = |list: &[u32]| list.get(corner).copied().unwrap_or(NONE);
        let p = obj.corners[corner];
        let key = [p, attribute(&obj.corner_texcoords), attribute(&obj.corner_normals)];
        let mut vertex = self.at[p as usize];
        for _ in 0..CROWD {
            if vertex == NONE {
                return self.add(key);
            }
            if self.keys[vertex as usize] == key {
                return vertex;
            }
            vertex = self.next[vertex as usize];
        }
        let hash = mix(mix(u64::from(key[0]) << 32 | u64::from(key[1])) ^ u64::from(key[2]));
        let known = self.crowded.entry(hash).or_default();
        if let Some(vertex) = known.iter().find(|v| self.keys[**v as usize] == key) {
            return *vertex;
        }
        known.push(self.keys.len() as u32);
        self.keys.push(key);
        self.next.push(NONE);
        self.keys.len() as u32 - 1
    }

    fn add(&mut self, key: [u32; 3]) -> u32 {
        let vertex = self.keys.len() as u32;
        self.keys.push(key);
        self.next.push(self.at[key[0] as usize]);
        self.at[key[0] as usize] = vertex;
        vertex
    }
}
