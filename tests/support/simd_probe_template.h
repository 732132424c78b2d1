/* simd_probe_template.h - simd_probe_run() for the ISA of the translation unit that includes it. */
#ifndef TESTS_SUPPORT_SIMD_PROBE_TEMPLATE_H
#define TESTS_SUPPORT_SIMD_PROBE_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "tests/support/simd_probe.h"

void SIMD_NAME(simd_probe)(const simd_probe_input *in, simd_probe_output *out);

static void probe_doubles(const simd_probe_input *in, simd_probe_output *out) {
    const vd a = d_load(in->a), b = d_load(in->b);
    const md p = md_of_bits(in->p & ((1u << VD_N) - 1));
    const md q = md_of_bits(in->q & ((1u << VD_N) - 1));
    float narrow[VD_N];
    d_store(out->d[PROBE_ADD], a + b);
    d_store(out->d[PROBE_SUB], a - b);
    d_store(out->d[PROBE_MUL], a * b);
    d_store(out->d[PROBE_DIV], a / b);
    d_store(out->d[PROBE_MIN], d_min(a, b));
    d_store(out->d[PROBE_MAX], d_max(a, b));
    d_store(out->d[PROBE_SQRT], d_sqrt(a));
    d_store(out->d[PROBE_ABS], d_abs(a));
    d_store(out->d[PROBE_SELECT], d_select(p, a, b));
    d_store(out->d[PROBE_SET], d_set(in->a[0]));
    d_store(out->d[PROBE_BITS], d_and_bits(a, in->keep));
    d_store(out->d[PROBE_CONVERT], d_of_floats(in->x));
    d_store_floats(narrow, a);
    for (int i = 0; i < VD_N; i++)
        out->d[PROBE_NARROW][i] = (double)narrow[i];
    out->d_mask[PROBE_LT] = md_bits(d_lt(a, b));
    out->d_mask[PROBE_LE] = md_bits(d_le(a, b));
    out->d_mask[PROBE_EQ] = md_bits(d_eq(a, b));
    out->d_mask[PROBE_GE] = md_bits(d_ge(a, b));
    out->d_mask[PROBE_GT] = md_bits(d_gt(a, b));
    out->d_mask[PROBE_AND] = md_bits(md_and(p, q));
    out->d_mask[PROBE_OR] = md_bits(md_or(p, q));
    out->d_mask[PROBE_XOR] = md_bits(md_xor(p, q));
    out->d_mask[PROBE_AND_NOT] = md_bits(md_and_not(p, q));
    out->d_mask[PROBE_OF_BITS] = md_bits(p);
}

static void probe_integers(const simd_probe_input *in, simd_probe_output *out) {
    const vd a = d_load(in->a);
    uint64_t number[VD_N], back[VD_N];
    for (unsigned i = 0; i < VD_N; i++)
        number[i] = in->p >> i & 3u;
    const vl at = l_load(number);
    l_store(back, at + l_set(1));
    d_store(out->d[PROBE_GATHER], d_gather(in->a, l_load(back)));
    d_store(out->d[PROBE_BYTES], (vd)l_gather(in->a, at));
    d_store(out->d[PROBE_REVERSE], d_reverse(a));
    d_store(out->d[PROBE_LOW], d_of_low_floats((vl)a));
    d_store(out->d[PROBE_PRODUCT], (vd)l_mul((vl)a, (vl)d_load(in->b)));
    out->d_mask[PROBE_SAME] = md_bits(l_eq((vl)a, (vl)d_load(in->b)));
    out->d_mask[PROBE_ODD] = l_odd((vl)a);
}

static void probe_tables(const simd_probe_input *in, simd_probe_output *out) {
    double table[D_TABLE], packed[2 * VD_N];
    uint64_t five[VD_N], four[VD_N];
    uint16_t shorts[VD_N];
    for (unsigned i = 0; i < D_TABLE; i++)
        table[i] = i < SIMD_PROBE_F ? in->a[i] : in->b[i - SIMD_PROBE_F];
    for (unsigned i = 0; i < VD_N; i++) {
        five[i] = in->p >> i & 31u;
        four[i] = in->p >> i & 15u;
        shorts[i] = (uint16_t)(in->p << i);
    }
    const unsigned lanes = in->q & ((1u << VD_N) - 1u);
    const int count = __builtin_popcount(lanes);
    d_pack(packed, d_load(in->a), lanes);
    d_store(packed + count, d_set(1.0));
    d_store(out->d[PROBE_PACK], d_load(packed));
    d_store(out->d[PROBE_TABLE], d_look_up(table, l_load(five)));
    d_store(out->d[PROBE_HALF], d_look_up_half(table, l_load(four)));
    d_store(out->d[PROBE_SHORTS], (vd)l_of_shorts(shorts));
}

static void probe_fours(const simd_probe_input *in, const uint32_t at[], simd_probe_output *out) {
    const unsigned lanes = in->q & ((1u << VF_N) - 1u);
    uint32_t numbers[VF_N], packed[2 * VF_N];
    vf four[4];
    f_load_fours(in->x, 4, at, four);
    for (int k = 0; k < 4; k++)
        f_store(out->f[PROBE_FOUR_X + k], four[k]);
    f_store(out->f[PROBE_FOUR_TABLE], f_look_up(in->x, i_load(at)));
    for (unsigned i = 0; i < VF_N; i++)
        numbers[i] = in->p << i;
    i_pack(packed, i_load(numbers), lanes);
    i_store(packed + __builtin_popcount(lanes), i_set(1));
    for (unsigned i = 0; i < VF_N; i++)
        out->f[PROBE_PACK_INT][i] = (float)packed[i];
}

static void probe_gathers(const simd_probe_input *in, simd_probe_output *out) {
    uint32_t sevens[VF_N], table[16], at[VF_N], found[VF_N], numbers[VF_N];
    for (unsigned i = 0; i < 16; i++)
        table[i] = (uint32_t)(in->keep >> 32) << i;
    for (unsigned i = 0; i < VF_N; i++) {
        sevens[i] = 7u * (in->p >> i & 3u);
        at[i] = in->p >> i & 15u;
        numbers[i] = (uint32_t)(in->keep >> 32) << i;
    }
    f_store(out->f[PROBE_GATHER_INT], (vf)i_gather(in->x, i_load(sevens)));
    i_store(found, i_look_up_16(table, i_load(at)));
    for (unsigned i = 0; i < VF_N; i++)
        out->f[PROBE_SIXTEEN][i] = (float)found[i];
    f_store(out->f[PROBE_OF_INTS], f_of_ints(i_load(numbers)));
}

static void probe_floats(const simd_probe_input *in, simd_probe_output *out) {
    const vf x = f_load(in->x), y = f_load(in->y);
    const mf p = mf_of_bits(in->p & ((1u << VF_N) - 1));
    const mf q = mf_of_bits(in->q & ((1u << VF_N) - 1));
    f_store(out->f[PROBE_ADD], x + y);
    f_store(out->f[PROBE_SUB], x - y);
    f_store(out->f[PROBE_MUL], x * y);
    f_store(out->f[PROBE_DIV], x / y);
    f_store(out->f[PROBE_MIN], f_min(x, y));
    f_store(out->f[PROBE_MAX], f_max(x, y));
    f_store(out->f[PROBE_SQRT], f_sqrt(x));
    f_store(out->f[PROBE_ABS], f_abs(x));
    f_store(out->f[PROBE_SELECT], f_select(p, x, y));
    f_store(out->f[PROBE_SET], f_set(in->x[0]));
    f_store(out->f[PROBE_BITS], f_and_bits(x, (uint32_t)(in->keep >> 32)));
    f_store(out->f[PROBE_CONVERT], f_of_doubles(in->a));
    f_store(out->f[PROBE_FLOOR], f_floor(x));
    f_store(out->f[PROBE_CEIL], f_ceil(x));
    f_stream(out->f[PROBE_STREAM], x);
    f_stream_end();
    f_store(out->reciprocal, f_reciprocal(x));
    uint32_t at[VF_N];
    vf triple[3];
    for (int i = 0; i < VF_N; i++)
        at[i] = in->p >> i & 3u;
    f_load_triples(in->x, at, triple);
    for (int a = 0; a < 3; a++)
        f_store(out->f[PROBE_TRIPLE_X + a], triple[a]);
    probe_fours(in, at, out);
    probe_gathers(in, out);
    const vi whole = f_to_int(x);
    for (int i = 0; i < VF_N; i++)
        out->f[PROBE_INT][i] = in->x[i] > -0x1p30f && in->x[i] < 0x1p30f ? (float)whole[i] : 0.0f;
    for (int i = 0; i < VF_N; i++) {
        vi one = {0};
        one[i] = (int32_t)(in->p & 1u << i) * (1 << i);
        out->f[PROBE_ANY][i] = i_any(one) ? 1.0f : 0.0f;
    }
    out->f_mask[PROBE_LT] = mf_bits(f_lt(x, y));
    out->f_mask[PROBE_LE] = mf_bits(f_le(x, y));
    out->f_mask[PROBE_EQ] = mf_bits(f_eq(x, y));
    out->f_mask[PROBE_GE] = mf_bits(f_ge(x, y));
    out->f_mask[PROBE_GT] = mf_bits(f_gt(x, y));
    out->f_mask[PROBE_AND] = mf_bits(mf_and(p, q));
    out->f_mask[PROBE_OR] = mf_bits(mf_or(p, q));
    out->f_mask[PROBE_AND_NOT] = mf_bits(mf_and_not(p, q));
    out->f_mask[PROBE_OF_BITS] = mf_bits(p);
}

void SIMD_NAME(simd_probe)(const simd_probe_input *in, simd_probe_output *out) {
    out->doubles = VD_N;
    out->floats = VF_N;
    probe_doubles(in, out);
    probe_integers(in, out);
    probe_tables(in, out);
    probe_floats(in, out);
}

#endif
#endif
