//! Equal shares of a picture, for machines that each render some.

use thiserror::Error;

use super::{Share, Tile};

/// A picture cannot be cut into so many shares.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error(
    "a picture of {width}x{height} pixels cannot be cut into {of} equal shares; choose a number that has fewer"
)]
pub struct ShareError {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// The shares that were wanted.
    pub of: u32,
}

/// The rectangle of a share: columns by rows of shares, as square as their number allows, counted row by row.
///
/// Their sides differ by a pixel at most, and together they cover each pixel once.
///
/// # Errors
/// A share would be empty however the picture is cut.
///
/// # Panics
/// If the share's number is not between 1 and how many there are.
pub fn share(width: u32, height: u32, share: Share) -> Result<Tile, ShareError> {
    let Share { index, of } = share;
    assert!((1..=of).contains(&index), "share {share}");
    // The border of all shares is least where columns · height + rows · width is.
    let divisors = (1..=of.min(width))
        .filter(|columns| of % columns == 0)
        .map(|columns| (columns, of / columns));
    let (columns, rows) = divisors
        .filter(|&(columns, rows)| columns <= width && rows <= height)
        .min_by_key(|&(columns, rows)| {
            u64::from(columns) * u64::from(height) + u64::from(rows) * u64::from(width)
        })
        .ok_or(ShareError { width, height, of })?;
    let (column, row) = ((index - 1) % columns, (index - 1) / columns);
    let cut = |k: u32, count: u32, length: u32| {
        (u64::from(k) * u64::from(length) / u64::from(count)) as u32
    };
    Ok(Tile {
        x0: cut(column, columns, width),
        y0: cut(row, rows, height),
        x1: cut(column + 1, columns, width),
        y1: cut(row + 1, rows, height),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Oracle: counting how often each pixel is covered.
    #[test]
    fn shares_cover_each_pixel_once_and_are_equal() {
        for (width, height, of) in
            [(1, 1, 1), (600, 400, 64), (31, 7, 7), (31, 7, 31), (10, 10, 100), (13, 17, 12)]
        {
            let mut cover = vec![0; (width * height) as usize];
            let mut sides = Vec::new();
            for index in 1..=of {
                let tile = share(width, height, Share { of, index }).expect("it can be cut");
                sides.push((tile.width(), tile.height()));
                for y in tile.y0..tile.y1 {
                    for x in tile.x0..tile.x1 {
                        cover[(y * width + x) as usize] += 1;
                    }
                }
            }
            assert!(cover.iter().all(|&n| n == 1), "{width} x {height} by {of}");
            let widths = || sides.iter().map(|side| side.0);
            let heights = || sides.iter().map(|side| side.1);
            assert!(widths().max() <= widths().min().map(|least| least + 1));
            assert!(heights().max() <= heights().min().map(|least| least + 1));
        }
        let square = share(600, 600, Share { index: 10, of: 64 });
        assert_eq!(square, Ok(Tile { x0: 75, y0: 75, x1: 150, y1: 150 }));
    }

    #[test]
    fn too_many_shares_are_refused() {
        for of in [49, 47, 4_000_000_000] {
            let refused = share(8, 6, Share { index: 1, of });
            assert_eq!(refused, Err(ShareError { width: 8, height: 6, of }));
        }
    }
}
