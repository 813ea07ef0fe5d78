//! What may hide between centres of one colour in the middle of others.

use crate::aa::estimate::all_alike;

/// The centres that tell a pixel's colour: its own and those around it.
const CENTERS: u32 = 9;

/// How many of the eight neighbours may have but little contrast.
const CALM: usize = 2;

/// The squared error, beyond what its own look tells, that a suspect pixel is expected to have whose eight neighbours
/// have its colour: where nearly all of these differ from their own neighbours, the likeness is chance. `contrast_at`
/// tells how much they do, and that those do not which are not known.
///
/// What the pixel gets must not depend on it, or it would on places more than two pixels away.
pub(super) fn hidden_error(contrast_at: impl Fn(i64, i64) -> f32, x: i64, y: i64) -> f32 {
    let mut contrasts = [0.0; 8];
    let around = (0..9).filter(|k| *k != 4).map(|k| (x + k % 3 - 1, y + k / 3 - 1));
    for (contrast, (x, y)) in contrasts.iter_mut().zip(around) {
        *contrast = contrast_at(x, y);
    }
    contrasts.sort_unstable_by(f32::total_cmp);
    all_alike(CENTERS) * contrasts[CALM] / 8.0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Oracle: by hand; 9 equal samples leave 2/(11 x 12) of the mean squared difference of the neighbours.
    #[test]
    fn likeness_amid_contrast_is_chance() {
        let all_but_two = |x: i64, y: i64| if y == 0 && x < 4 { 0.0 } else { 8.0 * 6600.0 };
        assert!((hidden_error(all_but_two, 3, 1) - 100.0).abs() < 1e-3);
        let all_but_three = |x: i64, y: i64| if y == 0 || x > 3 { 0.0 } else { 9e4 };
        assert_eq!(hidden_error(all_but_three, 3, 1), 0.0);
        // An edge has contrast at its side alone.
        assert_eq!(hidden_error(|x, _| if x > 1 { 9e4 } else { 0.0 }, 1, 1), 0.0);
    }
}
