//! The instructions agree with plain arithmetic, and the ones asked for are the ones that run.

use super::super::simd::{Instructions, Isa, Kernel, Portable, Simd};

/// Every operation on three groups of numbers, and the name of what computed them.
struct Everything([[f32; 8]; 3]);

impl Kernel for Everything {
    type Output = (&'static str, Vec<[f32; 8]>, Vec<u32>);

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Self::Output {
        let [x, y, z] = self.0;
        let (a, b, c) = (simd.load(&x), simd.load(&y), simd.load(&z));
        let values = [
            simd.splat(x[0]),
            simd.add(a, b),
            simd.sub(a, b),
            simd.mul(a, b),
            simd.div(a, b),
            simd.mul_add(a, b, c),
            simd.mul_sub(a, b, c),
            simd.neg_mul_add(a, b, c),
            simd.min(a, b),
            simd.max(a, b),
            simd.sqrt(a),
            simd.toggle_sign(a, b),
        ];
        let values = values.into_iter().map(|v| simd.store(v).0).collect();
        (std::any::type_name::<S>(), values, vec![simd.le(a, b), simd.le(b, a), simd.le(a, a)])
    }
}

/// Oracle: the portable version. Numbers of few bits, so that a product and a sum round to the same once or twice.
#[test]
fn instructions_agree_with_plain_arithmetic() {
    let (nan, inf) = (f32::NAN, f32::INFINITY);
    let inputs = [
        [[1.5, -2.0, 0.0, -0.0, 3.25, nan, 1.0, inf], [2.0; 8], [0.5; 8]],
        [[-0.0; 8], [0.0, -0.0, nan, inf, -inf, 1.0, -1.0, 4.0], [1.0; 8]],
        [[nan; 8], [1.0, nan, -1.0, 0.0, 2.0, 3.0, inf, -inf], [nan; 8]],
    ];
    for input in inputs {
        let (name, expected, masks) = Instructions::of(Isa::Portable).run(Everything(input));
        assert_eq!(name, std::any::type_name::<Portable>());
        for isa in Isa::ALL.into_iter().filter(|isa| isa.is_available()) {
            let (name, values, found) = Instructions::of(isa).run(Everything(input));
            assert!(name.ends_with(&format!("{isa:?}")), "{isa:?} ran as {name}");
            assert_eq!(found, masks, "{isa:?}");
            let bits = |v: &[[f32; 8]]| -> Vec<u32> {
                let canonical = |x: &f32| if x.is_nan() { f32::NAN.to_bits() } else { x.to_bits() };
                v.iter().flatten().map(canonical).collect()
            };
            assert_eq!(bits(&values), bits(&expected), "{isa:?} {input:?}");
        }
    }
}
