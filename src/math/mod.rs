//! Numbers: compensated sums of products, roots of quadratics, orthonormal frames, random numbers, scaling by powers of
//! two.

pub mod compensated;
pub mod frame;
pub mod quadratic;
pub mod random;
pub mod scale;

pub use compensated::{cross, difference_of_products, dot};
pub use frame::Frame;
pub use quadratic::Roots;

/// Unit roundoff of `f64`, 2⁻⁵³: the largest relative error of one rounding.
pub const UNIT_ROUNDOFF: f64 = f64::EPSILON / 2.0;
