//! Eight lanes in two AVX2 registers.

use core::arch::x86_64::{
    __m256d, __m256i, _CMP_LE_OQ, _CMP_LT_OQ, _mm256_add_epi64, _mm256_add_pd, _mm256_and_pd,
    _mm256_andnot_pd, _mm256_blendv_pd, _mm256_castpd_si256, _mm256_castsi256_pd, _mm256_cmp_pd,
    _mm256_div_pd, _mm256_fmadd_pd, _mm256_loadu_pd, _mm256_movemask_pd, _mm256_mul_pd,
    _mm256_or_pd, _mm256_set1_epi64x, _mm256_set1_pd, _mm256_slli_epi64, _mm256_sqrt_pd,
    _mm256_srli_epi64, _mm256_storeu_pd, _mm256_sub_pd, _mm256_xor_pd,
};

use grouser_real::DETERMINISTIC;

use super::lanes_of;

type Register = __m256d;
type Mask = __m256d;
const WIDTH: usize = 4;
const COUNT: usize = 2;

// SAFETY of all below: see `lanes_of`.
lanes_of!(Avx2, Avx2Mask, [0 1], {
    splat: |x| _mm256_set1_pd(x),
    load: |p| _mm256_loadu_pd(p),
    store: |p, x| _mm256_storeu_pd(p, x),
    add: |a, b| _mm256_add_pd(a, b),
    sub: |a, b| _mm256_sub_pd(a, b),
    mul: |a, b| _mm256_mul_pd(a, b),
    div: |a, b| _mm256_div_pd(a, b),
    fused: |a, b, c| if DETERMINISTIC {
        _mm256_add_pd(_mm256_mul_pd(a, b), c)
    } else {
        _mm256_fmadd_pd(a, b, c)
    },
    sqrt: |x| _mm256_sqrt_pd(x),
    negate: |x| _mm256_xor_pd(x, _mm256_set1_pd(-0.0)),
    abs: |x| _mm256_andnot_pd(_mm256_set1_pd(-0.0), x),
    lt: |a, b| _mm256_cmp_pd::<_CMP_LT_OQ>(a, b),
    le: |a, b| _mm256_cmp_pd::<_CMP_LE_OQ>(a, b),
    select: |m, a, b| _mm256_blendv_pd(b, a, m),
    and: |a, b| _mm256_and_pd(a, b),
    or: |a, b| _mm256_or_pd(a, b),
    not: |a| _mm256_xor_pd(a, _mm256_castsi256_pd(ones())),
    any: |m| _mm256_movemask_pd(m) != 0,
    features: "avx2,fma",
    power_of_two: |x| _mm256_castsi256_pd(_mm256_slli_epi64::<52>(_mm256_add_epi64(
        _mm256_castpd_si256(x),
        _mm256_set1_epi64x(1023),
    ))),
    times_power: |a, b| _mm256_castsi256_pd(_mm256_add_epi64(
        _mm256_castpd_si256(a),
        _mm256_slli_epi64::<52>(_mm256_castpd_si256(b)),
    )),
    exponent: |x| _mm256_or_pd(
        _mm256_castsi256_pd(_mm256_srli_epi64::<52>(_mm256_castpd_si256(x))),
        _mm256_castsi256_pd(_mm256_set1_epi64x(TWO_52.cast_signed())),
    ),
    mantissa: |x| _mm256_or_pd(
        _mm256_and_pd(x, _mm256_castsi256_pd(_mm256_set1_epi64x(0x000f_ffff_ffff_ffff))),
        _mm256_set1_pd(1.0),
    ),
});

/// All bits set.
#[inline(always)]
unsafe fn ones() -> __m256i {
    // SAFETY: as all above.
    unsafe { _mm256_set1_epi64x(-1) }
}
