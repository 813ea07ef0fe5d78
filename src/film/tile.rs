//! Rectangles of pixels: parts and blocks of a picture, and the tiles of a block that workers take one after another.

/// A rectangle of pixels, half open: columns `x0..x1`, rows `y0..y1`, from 0 at the top left.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Tile {
    /// First column.
    pub x0: u32,
    /// First row.
    pub y0: u32,
    /// Column after the last.
    pub x1: u32,
    /// Row after the last.
    pub y1: u32,
}

impl Tile {
    /// Pixels in a row of the tile.
    pub fn width(&self) -> u32 {
        self.x1 - self.x0
    }

    /// Rows of the tile.
    pub fn height(&self) -> u32 {
        self.y1 - self.y0
    }

    /// The place in the whole picture of a tile whose place counts from the corner of `part`.
    #[must_use]
    pub fn plus(&self, part: &Self) -> Self {
        let (x, y) = (part.x0, part.y0);
        Self { x0: self.x0 + x, y0: self.y0 + y, x1: self.x1 + x, y1: self.y1 + y }
    }

    /// The place that counts from the corner of `part`, in which the tile lies.
    #[must_use]
    pub fn minus(&self, part: &Self) -> Self {
        let (x, y) = (part.x0, part.y0);
        Self { x0: self.x0 - x, y0: self.y0 - y, x1: self.x1 - x, y1: self.y1 - y }
    }
}

/// Squares of `side` pixels that cover a `width` x `height` picture without overlap, those at the
/// right and lower edge cut off; an empty picture has none.
///
/// They come in Morton order, so that neighbours in the list lie close together in the picture and
/// meet the same objects while those are in the cache.
///
/// # Panics
///
/// If `side` is 0.
pub fn tiles(width: u32, height: u32, side: u32) -> Vec<Tile> {
    assert!(side > 0, "a tile has at least one pixel");
    let (columns, rows) = (width.div_ceil(side), height.div_ceil(side));
    let mut places: Vec<(u32, u32)> =
        (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row))).collect();
    places.sort_unstable_by_key(|&(column, row)| spread(column) | spread(row) << 1);
    let cut = |place: u32, end: u32| (place * side, (place * side).saturating_add(side).min(end));
    places
        .into_iter()
        .map(|(column, row)| {
            let ((x0, x1), (y0, y1)) = (cut(column, width), cut(row, height));
            Tile { x0, y0, x1, y1 }
        })
        .collect()
}

/// The bits of `n` at the even places of a wider word.
fn spread(n: u32) -> u64 {
    let mut bits = u64::from(n);
    for (shift, mask) in [
        (16, 0x0000_ffff_0000_ffff),
        (8, 0x00ff_00ff_00ff_00ff),
        (4, 0x0f0f_0f0f_0f0f_0f0f),
        (2, 0x3333_3333_3333_3333),
        (1, 0x5555_5555_5555_5555_u64),
    ] {
        bits = (bits | bits << shift) & mask;
    }
    bits
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Oracle: counting how often each pixel is covered.
    #[test]
    fn tiles_cover_each_pixel_exactly_once() {
        for (width, height, side) in
            [(0, 0, 4), (0, 9, 4), (1, 1, 1), (1, 1, 64), (8, 8, 4), (9, 7, 4), (100, 3, 16)]
        {
            let mut cover = vec![0; (width * height) as usize];
            for tile in tiles(width, height, side) {
                assert!(tile.width() > 0 && tile.height() > 0, "{tile:?}");
                assert!(tile.width() <= side && tile.height() <= side, "{tile:?}");
                for y in tile.y0..tile.y1 {
                    for x in tile.x0..tile.x1 {
                        cover[(y * width + x) as usize] += 1;
                    }
                }
            }
            assert!(cover.iter().all(|&n| n == 1), "{width} x {height} by {side}");
        }
    }

    #[test]
    fn tiles_reach_the_edge_of_the_widest_pictures() {
        let strip = tiles(u32::MAX, 1, u32::MAX - 1);
        assert_eq!(strip.iter().map(|tile| u64::from(tile.width())).sum::<u64>(), 0xffff_ffff);
    }

    /// Oracle: a Z over the first four, then the same Z one block to the right.
    #[test]
    fn tiles_follow_the_morton_curve() {
        let order: Vec<_> = tiles(8, 4, 2).iter().map(|tile| (tile.x0 / 2, tile.y0 / 2)).collect();
        assert_eq!(order, [(0, 0), (1, 0), (0, 1), (1, 1), (2, 0), (3, 0), (2, 1), (3, 1)]);
    }
}
