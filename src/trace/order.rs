//! Rays towards a light, in an order in which neighbours come from nearly the same direction.

use glam::DVec3;

use crate::geometry::lanes::LANES;

/// Steps of the curve, each of which tells one more bit of both coordinates.
const STEPS: u32 = 10;

/// A direction, by where it leads through a cube about the origin.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bearing {
    /// Which side of the cube.
    side: u8,
    /// Where on it, as slopes.
    slopes: [f32; 2],
}

impl Bearing {
    /// That of a direction, which need not be of length 1.
    #[inline(always)]
    pub(super) fn of(dir: DVec3) -> Self {
        let size = dir.abs();
        let (axis, along, others) = if size.x >= size.y && size.x >= size.z {
            (0, dir.x, [dir.y, dir.z])
        } else if size.y >= size.z {
            (1, dir.y, [dir.x, dir.z])
        } else {
            (2, dir.z, [dir.x, dir.y])
        };
        let slopes = others.map(|other| (other / along.abs()) as f32);
        Self { side: 2 * axis + u8::from(along < 0.0), slopes }
    }
}

/// Puts the numbers of `rays`, whose bearings are `of`, in the order of Hilbert curves over the parts of the cube's sides
/// through which they come; each is in the lower half of an entry.
#[inline(always)]
pub(super) fn put_in_order<T>(rays: &[T], of: impl Fn(&T) -> &Bearing, order: &mut Vec<u64>) {
    let mut ranges = [[[f32::INFINITY, f32::NEG_INFINITY]; 2]; 6];
    for Bearing { side, slopes } in rays.iter().map(&of) {
        for (range, slope) in ranges[usize::from(*side)].iter_mut().zip(*slopes) {
            *range = [range[0].min(slope), range[1].max(slope)];
        }
    }
    let last = ((1 << STEPS) - 1) as f32;
    let scales = ranges.map(|side| side.map(|[from, to]| last / (to - from)));
    order.clear();
    for (group, some) in rays.chunks(LANES).enumerate() {
        let mut cells = [[0; LANES]; 2];
        for (k, Bearing { side, slopes }) in some.iter().map(&of).enumerate() {
            let side = usize::from(*side);
            // Where all slopes are the same, the scale is infinite and the product no number, which counts as 0.
            let cell = |axis: usize| (slopes[axis] - ranges[side][axis][0]) * scales[side][axis];
            (cells[0][k], cells[1][k]) = (cell(0) as u32, cell(1) as u32);
        }
        let along = along_curve(&cells);
        order.extend(some.iter().map(&of).zip(along).enumerate().map(|(k, (bearing, along))| {
            let place = u64::from(bearing.side) << (2 * STEPS) | u64::from(along);
            place << 32 | (group * LANES + k) as u64
        }));
    }
    order.sort_unstable();
}

/// The places of cells, by column and row, on the Hilbert curve through a square of 2^[`STEPS`] cells a side.
///
/// Source: Warren, "Hacker's Delight" (2nd edition, 2012), figure 16-8.
#[inline(always)]
fn along_curve([x, y]: &[[u32; LANES]; 2]) -> [u32; LANES] {
    let (mut state, mut place) = ([0; LANES], [0; LANES]);
    for step in (0..STEPS).rev() {
        for k in 0..LANES {
            let row = (4 * state[k]) | (2 * (x[k] >> step & 1)) | (y[k] >> step & 1);
            place[k] = place[k] << 2 | 0x361e_9cb4 >> (2 * row) & 3;
            state[k] = 0x8fe6_5831 >> (2 * row) & 3;
        }
    }
    place
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::random::SplitMix64;

    /// Oracle: the definition. The curve visits each cell once, and goes on to one beside it.
    #[test]
    fn the_curve_goes_from_cell_to_cell() {
        let side = 1 << STEPS;
        let mut cells = vec![None; (side * side) as usize];
        for y in 0..side {
            for x in (0..side).step_by(LANES) {
                let row = std::array::from_fn(|k| x + k as u32);
                for (k, place) in along_curve(&[row, [y; LANES]]).into_iter().enumerate() {
                    assert_eq!(cells[place as usize].replace((row[k], y)), None);
                }
            }
        }
        let cells: Vec<(u32, u32)> = cells.into_iter().map(|cell| cell.expect("visited")).collect();
        let is_step = |pair: &[(u32, u32)]| {
            pair[0].0.abs_diff(pair[1].0) + pair[0].1.abs_diff(pair[1].1) == 1
        };
        assert!(cells.windows(2).all(is_step));
    }

    /// Oracle: each number once, and each side of the cube in one piece; also of rays that go nowhere, or all the same
    /// way.
    #[test]
    fn the_order_has_each_ray_once() {
        let mut random = SplitMix64::new(3);
        let mut vector =
            || DVec3::from_array(std::array::from_fn(|_| 2.0 * random.uniform() - 1.0));
        let any: Vec<Bearing> = (0..1000).map(|_| Bearing::of(vector())).collect();
        let one_way = vec![Bearing::of(DVec3::new(1.0, 2.0, 3.0)); 100];
        let nowhere = [DVec3::ZERO, DVec3::NAN].map(Bearing::of);
        let with_nowhere: Vec<Bearing> = any.iter().copied().chain(nowhere).collect();
        for (rays, sides) in [(any, 6), (one_way, 1), (with_nowhere, 6)] {
            let mut order = Vec::new();
            put_in_order(&rays, |ray| ray, &mut order);
            let mut numbers: Vec<usize> = order.iter().map(|x| *x as u32 as usize).collect();
            let mut pieces: Vec<u8> = numbers.iter().map(|k| rays[*k].side).collect();
            pieces.dedup();
            assert_eq!(pieces.len(), sides);
            numbers.sort_unstable();
            assert!(numbers.into_iter().eq(0..rays.len()));
        }
    }
}
