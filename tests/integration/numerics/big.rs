//! 640-bit arithmetic: what the oracles compute with.

use std::cmp::Ordering;
use std::ops::{Add, Div, Mul, Neg, Sub};

use dashu_float::{FBig, round::mode::HalfEven};
use glam::DVec3;

/// Bits of a [`Big`]: products of eight factors of 53 bits are exact, with room for a quotient and a root.
const BITS: usize = 640;

/// A number of 640 bits, of any exponent.
#[derive(Clone, Debug, PartialEq, PartialOrd)]
pub(crate) struct Big(FBig<HalfEven, 2>);

/// The exact value of a finite `x`.
pub(crate) fn big(x: f64) -> Big {
    let exact = FBig::<HalfEven, 2>::try_from(x + 0.0).expect("a finite number");
    Big(exact.with_precision(BITS).value())
}

impl Big {
    /// The nearest `f64`.
    pub(crate) fn f64(&self) -> f64 {
        self.0.to_f64().value()
    }

    pub(crate) fn is_zero(&self) -> bool {
        self.sign() == Ordering::Equal
    }

    pub(crate) fn sign(&self) -> Ordering {
        self.partial_cmp(&Self(FBig::ZERO)).expect("an ordered number")
    }

    pub(crate) fn is_positive(&self) -> bool {
        self.sign() == Ordering::Greater
    }

    pub(crate) fn is_negative(&self) -> bool {
        self.sign() == Ordering::Less
    }

    pub(crate) fn abs(&self) -> Self {
        if self.is_negative() { -self } else { self.clone() }
    }

    /// The root of a number that is not negative.
    pub(crate) fn sqrt(&self) -> Self {
        Self(self.0.sqrt())
    }

    pub(crate) fn square(&self) -> Self {
        self * self
    }

    /// `self · 2^e`.
    pub(crate) fn shifted(&self, e: i32) -> Self {
        Self(self.0.clone() << isize::try_from(e).expect("a small exponent"))
    }
}

macro_rules! operator {
    ($($trait:ident $method:ident),*) => { $(
        impl $trait<&Big> for &Big {
            type Output = Big;
            fn $method(self, other: &Big) -> Big {
                Big((&self.0).$method(&other.0))
            }
        }
        impl $trait<&Big> for Big {
            type Output = Big;
            fn $method(self, other: &Big) -> Big {
                (&self).$method(other)
            }
        }
        impl $trait<Big> for &Big {
            type Output = Big;
            fn $method(self, other: Big) -> Big {
                self.$method(&other)
            }
        }
        impl $trait<Big> for Big {
            type Output = Big;
            fn $method(self, other: Big) -> Big {
                (&self).$method(&other)
            }
        }
    )* };
}
operator!(Add add, Sub sub, Mul mul, Div div);

impl Neg for &Big {
    type Output = Big;
    fn neg(self) -> Big {
        Big(-self.0.clone())
    }
}

/// A vector of [`Big`]s.
#[derive(Clone, Debug)]
pub(crate) struct BigVec(pub(crate) [Big; 3]);

/// The exact value of a finite vector.
pub(crate) fn big_vec(v: DVec3) -> BigVec {
    BigVec(v.to_array().map(big))
}

impl BigVec {
    fn zip(&self, other: &Self, op: impl Fn(&Big, &Big) -> Big) -> Self {
        Self([0, 1, 2].map(|k| op(&self.0[k], &other.0[k])))
    }

    pub(crate) fn minus(&self, other: &Self) -> Self {
        self.zip(other, |a, b| a - b)
    }

    pub(crate) fn plus(&self, other: &Self) -> Self {
        self.zip(other, |a, b| a + b)
    }

    /// Componentwise.
    pub(crate) fn times(&self, other: &Self) -> Self {
        self.zip(other, |a, b| a * b)
    }

    pub(crate) fn scaled(&self, s: &Big) -> Self {
        Self([0, 1, 2].map(|k| &self.0[k] * s))
    }

    pub(crate) fn shifted(&self, e: i32) -> Self {
        Self([0, 1, 2].map(|k| self.0[k].shifted(e)))
    }

    pub(crate) fn sum(&self) -> Big {
        &self.0[0] + &self.0[1] + &self.0[2]
    }

    pub(crate) fn dot(&self, other: &Self) -> Big {
        self.times(other).sum()
    }

    pub(crate) fn cross(&self, other: &Self) -> Self {
        let (a, b) = (&self.0, &other.0);
        let component = |k: usize, l: usize| &a[k] * &b[l] - &a[l] * &b[k];
        Self([component(1, 2), component(2, 0), component(0, 1)])
    }

    pub(crate) fn length(&self) -> Big {
        self.dot(self).sqrt()
    }

    pub(crate) fn f64(&self) -> DVec3 {
        DVec3::from_array([0, 1, 2].map(|k| self.0[k].f64()))
    }

    /// Σ |aₖ bₖ|.
    pub(crate) fn dot_abs(&self, other: &Self) -> f64 {
        self.times(other).f64().abs().element_sum()
    }
}

#[test]
fn big_numbers_are_exact_beyond_f64() {
    let one_and_a_bit = big(1.0) + big(2.0_f64.powi(-300));
    let square = one_and_a_bit.square() - big(1.0) - big(2.0_f64.powi(-299));
    assert_eq!(square, big(2.0_f64.powi(-600)));
    assert!((big(2.0).sqrt().square() - big(2.0)).abs() < big(2.0_f64.powi(-630)));
    assert_eq!(big(5e-324).shifted(1074).f64(), 1.0);
}
