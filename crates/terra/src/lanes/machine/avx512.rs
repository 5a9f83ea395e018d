//! Eight lanes in one AVX-512 register.

use core::arch::x86_64::{
    __m512d, __mmask8, _CMP_LE_OQ, _CMP_LT_OQ, _mm512_abs_pd, _mm512_add_epi64, _mm512_add_pd,
    _mm512_and_epi64, _mm512_castpd_si512, _mm512_castsi512_pd, _mm512_cmp_pd_mask, _mm512_div_pd,
    _mm512_fmadd_pd, _mm512_loadu_pd, _mm512_mask_blend_pd, _mm512_mul_pd, _mm512_or_epi64,
    _mm512_set1_epi64, _mm512_set1_pd, _mm512_slli_epi64, _mm512_sqrt_pd, _mm512_srli_epi64,
    _mm512_storeu_pd, _mm512_sub_pd,
};

use grouser_real::DETERMINISTIC;

use super::lanes_of;

type Register = __m512d;
type Mask = __mmask8;
const WIDTH: usize = 8;
const COUNT: usize = 1;

// SAFETY of all below: see `lanes_of`.
lanes_of!(Avx512, Avx512Mask, [0], {
    splat: |x| _mm512_set1_pd(x),
    load: |p| _mm512_loadu_pd(p),
    store: |p, x| _mm512_storeu_pd(p, x),
    add: |a, b| _mm512_add_pd(a, b),
    sub: |a, b| _mm512_sub_pd(a, b),
    mul: |a, b| _mm512_mul_pd(a, b),
    div: |a, b| _mm512_div_pd(a, b),
    fused: |a, b, c| if DETERMINISTIC {
        _mm512_add_pd(_mm512_mul_pd(a, b), c)
    } else {
        _mm512_fmadd_pd(a, b, c)
    },
    sqrt: |x| _mm512_sqrt_pd(x),
    negate: |x| _mm512_sub_pd(_mm512_set1_pd(-0.0), x),
    abs: |x| _mm512_abs_pd(x),
    lt: |a, b| _mm512_cmp_pd_mask::<_CMP_LT_OQ>(a, b),
    le: |a, b| _mm512_cmp_pd_mask::<_CMP_LE_OQ>(a, b),
    select: |m, a, b| _mm512_mask_blend_pd(m, b, a),
    and: |a, b| a & b,
    or: |a, b| a | b,
    not: |a| !a,
    any: |m| m != 0,
    features: "avx2,fma,avx512f,avx512dq",
    power_of_two: |x| _mm512_castsi512_pd(_mm512_slli_epi64::<52>(_mm512_add_epi64(
        _mm512_castpd_si512(x),
        _mm512_set1_epi64(1023),
    ))),
    times_power: |a, b| _mm512_castsi512_pd(_mm512_add_epi64(
        _mm512_castpd_si512(a),
        _mm512_slli_epi64::<52>(_mm512_castpd_si512(b)),
    )),
    exponent: |x| _mm512_castsi512_pd(_mm512_or_epi64(
        _mm512_srli_epi64::<52>(_mm512_castpd_si512(x)),
        _mm512_set1_epi64(TWO_52.cast_signed()),
    )),
    mantissa: |x| _mm512_castsi512_pd(_mm512_or_epi64(
        _mm512_and_epi64(_mm512_castpd_si512(x), _mm512_set1_epi64(0x000f_ffff_ffff_ffff)),
        _mm512_castpd_si512(_mm512_set1_pd(1.0)),
    )),
});
