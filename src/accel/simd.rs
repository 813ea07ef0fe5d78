//! Eight single-precision numbers at once, and which instructions do it.
//!
//! A [`Kernel`] is written once against [`Simd`] and compiled for each instruction set. All its callees must be
//! `#[inline(always)]`, or the compiler builds them for the baseline and every operation becomes a call; then
//! `f64::mul_add` in the shapes' own tests is an instruction too, with the same result as the library's function.

/// Which instructions the queries use; the answers do not depend on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Isa {
    /// What every machine has.
    Portable,
    /// AVX2 and FMA of x86-64.
    Avx2,
    /// AVX-512 of x86-64: F, VL, DQ and BW.
    Avx512,
}

impl Isa {
    /// All there are.
    pub const ALL: [Self; 3] = [Self::Portable, Self::Avx2, Self::Avx512];

    /// The fastest that this machine has.
    pub fn detect() -> Self {
        let best = Self::ALL.into_iter().rev().find(|isa| isa.is_available());
        best.unwrap_or(Self::Portable)
    }

    /// Whether this machine has it.
    pub fn is_available(self) -> bool {
        Instructions::of(self).isa() == self
    }
}

/// Instructions that this machine has; the proof comes with each.
#[derive(Clone, Copy, Debug)]
pub(super) enum Instructions {
    Portable(Portable),
    #[cfg(target_arch = "x86_64")]
    Avx2(super::simd_x86::Avx2),
    #[cfg(target_arch = "x86_64")]
    Avx512(super::simd_x86::Avx512),
}

impl Instructions {
    /// Those of `isa`, or the portable ones where the machine lacks them.
    pub(super) fn of(isa: Isa) -> Self {
        match isa {
            Isa::Portable => None,
            #[cfg(target_arch = "x86_64")]
            Isa::Avx2 => super::simd_x86::Avx2::detect().map(Self::Avx2),
            #[cfg(target_arch = "x86_64")]
            Isa::Avx512 => super::simd_x86::Avx512::detect().map(Self::Avx512),
            #[cfg(not(target_arch = "x86_64"))]
            Isa::Avx2 | Isa::Avx512 => None,
        }
        .unwrap_or(Self::Portable(Portable))
    }

    /// Whose they are.
    pub(super) fn isa(self) -> Isa {
        match self {
            Self::Portable(_) => Isa::Portable,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2(_) => Isa::Avx2,
            #[cfg(target_arch = "x86_64")]
            Self::Avx512(_) => Isa::Avx512,
        }
    }

    /// Runs `kernel` with them.
    #[inline(always)]
    pub(super) fn run<K: Kernel>(self, kernel: K) -> K::Output {
        match self {
            Self::Portable(simd) => simd.vectorize(kernel),
            #[cfg(target_arch = "x86_64")]
            Self::Avx2(simd) => simd.vectorize(kernel),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512(simd) => simd.vectorize(kernel),
        }
    }
}

/// Something to be computed with any instructions.
pub(super) trait Kernel {
    type Output;

    /// Must be `#[inline(always)]`.
    fn run<S: Simd>(self, simd: S) -> Self::Output;
}

/// Eight lanes, aligned.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(super) struct Lanes(pub(super) [f32; 8]);

/// An instruction set; a value of the type proves that the machine has it.
pub(super) trait Simd: Copy {
    /// Eight numbers.
    type F: Copy;

    /// Which it is.
    #[cfg(test)]
    const ISA: Isa;

    /// Runs a kernel, as a function of its own that is compiled for these instructions.
    fn vectorize<K: Kernel>(self, kernel: K) -> K::Output;

    /// Asks for the memory of `x`, which is needed soon.
    fn prefetch<T>(self, x: &T);

    fn splat(self, x: f32) -> Self::F;
    fn load(self, x: &[f32; 8]) -> Self::F;
    fn store(self, x: Self::F) -> Lanes;
    fn add(self, a: Self::F, b: Self::F) -> Self::F;
    fn sub(self, a: Self::F, b: Self::F) -> Self::F;
    fn mul(self, a: Self::F, b: Self::F) -> Self::F;
    fn div(self, a: Self::F, b: Self::F) -> Self::F;
    /// `a b + c`, rounded once or twice.
    fn mul_add(self, a: Self::F, b: Self::F, c: Self::F) -> Self::F;
    /// `a b − c`, rounded once or twice.
    fn mul_sub(self, a: Self::F, b: Self::F, c: Self::F) -> Self::F;
    /// `c − a b`, rounded once or twice.
    fn neg_mul_add(self, a: Self::F, b: Self::F, c: Self::F) -> Self::F;
    /// The smaller, or `b` where either is NaN.
    fn min(self, a: Self::F, b: Self::F) -> Self::F;
    /// The larger, or `b` where either is NaN.
    fn max(self, a: Self::F, b: Self::F) -> Self::F;
    fn sqrt(self, a: Self::F) -> Self::F;
    /// `a`, with the other sign where that of `b` is negative.
    fn toggle_sign(self, a: Self::F, b: Self::F) -> Self::F;
    /// A bit for each lane in which `a ≤ b`; none where either is NaN.
    fn le(self, a: Self::F, b: Self::F) -> u32;
}

/// The lanes of which a mask such as that of [`Simd::le`] has the bit.
#[inline(always)]
pub(super) fn bits(mut mask: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        if mask == 0 {
            return None;
        }
        let lane = (mask.trailing_zeros() & 7) as usize;
        mask &= mask - 1;
        Some(lane)
    })
}

/// Plain arithmetic, for every machine.
#[derive(Clone, Copy, Debug)]
pub(super) struct Portable;

impl Portable {
    #[inline(always)]
    fn zip(a: Lanes, b: Lanes, f: impl Fn(f32, f32) -> f32) -> Lanes {
        Lanes(std::array::from_fn(|k| f(a.0[k], b.0[k])))
    }
}

impl Simd for Portable {
    type F = Lanes;

    #[cfg(test)]
    const ISA: Isa = Isa::Portable;

    #[inline(never)]
    fn vectorize<K: Kernel>(self, kernel: K) -> K::Output {
        kernel.run(self)
    }

    #[inline(always)]
    fn prefetch<T>(self, _: &T) {}

    #[inline(always)]
    fn splat(self, x: f32) -> Lanes {
        Lanes([x; 8])
    }

    #[inline(always)]
    fn load(self, x: &[f32; 8]) -> Lanes {
        Lanes(*x)
    }

    #[inline(always)]
    fn store(self, x: Lanes) -> Lanes {
        x
    }

    #[inline(always)]
    fn add(self, a: Lanes, b: Lanes) -> Lanes {
        Self::zip(a, b, |a, b| a + b)
    }

    #[inline(always)]
    fn sub(self, a: Lanes, b: Lanes) -> Lanes {
        Self::zip(a, b, |a, b| a - b)
    }

    #[inline(always)]
    fn mul(self, a: Lanes, b: Lanes) -> Lanes {
        Self::zip(a, b, |a, b| a * b)
    }

    #[inline(always)]
    fn div(self, a: Lanes, b: Lanes) -> Lanes {
        Self::zip(a, b, |a, b| a / b)
    }

    #[inline(always)]
    fn mul_add(self, a: Lanes, b: Lanes, c: Lanes) -> Lanes {
        self.add(self.mul(a, b), c)
    }

    #[inline(always)]
    fn mul_sub(self, a: Lanes, b: Lanes, c: Lanes) -> Lanes {
        self.sub(self.mul(a, b), c)
    }

    #[inline(always)]
    fn neg_mul_add(self, a: Lanes, b: Lanes, c: Lanes) -> Lanes {
        self.sub(c, self.mul(a, b))
    }

    #[inline(always)]
    fn min(self, a: Lanes, b: Lanes) -> Lanes {
        Self::zip(a, b, |a, b| if a < b { a } else { b })
    }

    #[inline(always)]
    fn max(self, a: Lanes, b: Lanes) -> Lanes {
        Self::zip(a, b, |a, b| if a > b { a } else { b })
    }

    #[inline(always)]
    fn sqrt(self, a: Lanes) -> Lanes {
        Lanes(a.0.map(f32::sqrt))
    }

    #[inline(always)]
    fn toggle_sign(self, a: Lanes, b: Lanes) -> Lanes {
        Self::zip(a, b, |a, b| f32::from_bits(a.to_bits() ^ (b.to_bits() & 1 << 31)))
    }

    #[inline(always)]
    fn le(self, a: Lanes, b: Lanes) -> u32 {
        (0..8).fold(0, |bits, k| bits | u32::from(a.0[k] <= b.0[k]) << k)
    }
}
