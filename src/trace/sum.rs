//! Sums of light that do not depend on the order of their terms.

use crate::color::Rgb;

/// A sum of colours in fixed point, 2⁻⁴⁰ a unit.
///
/// Integers add up to the same whatever their order; floating-point numbers do not, and the order in which a sample's
/// rays come back depends on what else is traced beside it. The unit is a 16-millionth of the last bit of a picture
/// with 16 bits a channel; sums up to eight million fit, and saturate beyond.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Sum([i64; 3]);

const UNIT: f32 = 1.0 / (1_u64 << 40) as f32;

impl Sum {
    /// Adds a colour; what is not a number counts nothing.
    pub(super) fn add(&mut self, color: Rgb) {
        for (sum, channel) in self.0.iter_mut().zip(color.to_array()) {
            *sum = sum.saturating_add((channel / UNIT) as i64);
        }
    }

    pub(super) fn value(self) -> Rgb {
        Rgb::from_array(self.0.map(|sum| (sum as f64 * f64::from(UNIT)) as f32))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Oracle: the exact sum, and the same bits in any order, where single precision differs.
    #[test]
    fn order_does_not_matter() {
        let terms: Vec<f32> = (0..200_u16).map(|k| 1.7_f32.powi(i32::from(k % 23) - 15)).collect();
        let exact: f64 = terms.iter().map(|&x| f64::from(x)).sum();
        let sum = |terms: &mut dyn Iterator<Item = &f32>| {
            let mut sum = Sum::default();
            terms.for_each(|&x| sum.add(Rgb::splat(x)));
            sum
        };
        let (forward, backward) = (sum(&mut terms.iter()), sum(&mut terms.iter().rev()));
        assert_eq!(forward, backward);
        assert!((f64::from(forward.value().x) - exact).abs() <= 1e-7 * exact, "{exact}");
        let float: (f32, f32) = (terms.iter().sum(), terms.iter().rev().sum());
        assert!(float.0 != float.1, "the test needs terms whose float sums differ");
    }

    #[test]
    fn absurd_terms_do_no_harm() {
        let mut sum = Sum::default();
        sum.add(Rgb::new(f32::NAN, f32::INFINITY, 0.25));
        sum.add(Rgb::new(0.5, 1e30, 0.25));
        assert_eq!(sum.value().x, 0.5);
        assert!(sum.value().y > 8e6);
        assert_eq!(sum.value().z, 0.5);
    }
}
