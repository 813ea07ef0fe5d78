//! Which positions are the same point: exact comparison of coordinates, through a hash table of indices.

use glam::DVec3;

use crate::math::random::mix;

const EMPTY: u32 = u32::MAX;

/// For every position, the first that has the same coordinates.
pub(in crate::scene) fn weld(positions: &[DVec3]) -> Vec<u32> {
    let mut table = vec![EMPTY; (positions.len() * 2).next_power_of_two().max(4)];
    let mask = table.len() - 1;
    let mut first = Vec::with_capacity(positions.len());
    for (p, index) in positions.iter().zip(0_u32..) {
        let p = *p + DVec3::ZERO; // −0 is 0
        let bits = p.to_array().map(f64::to_bits);
        let hash = mix(mix(mix(bits[0]).wrapping_add(bits[1])).wrapping_add(bits[2]));
        let mut slot = hash as usize & mask;
        first.push(loop {
            let seen = table[slot];
            if seen == EMPTY {
                table[slot] = index;
                break index;
            }
            if positions[seen as usize] == p {
                break seen;
            }
            slot = (slot + 1) & mask;
        });
    }
    first
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_points_are_one() {
        let (a, b) = (DVec3::new(0.0, 1.0, 2.0), DVec3::new(0.0, 1.0, 2.000_000_000_000_001));
        let same = DVec3::new(-0.0, 1.0, 2.0);
        assert_eq!(weld(&[a, b, same, b, a]), [0, 1, 0, 1, 0]);
        assert!(weld(&[]).is_empty());
    }
}
