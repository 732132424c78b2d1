#include "tests/support/simd_probe.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#if defined __x86_64__ || defined __i386__
void simd_probe_sse42(const simd_probe_input *in, simd_probe_output *out);
void simd_probe_avx2(const simd_probe_input *in, simd_probe_output *out);
void simd_probe_avx512(const simd_probe_input *in, simd_probe_output *out);
#endif

void simd_probe_run(cpu_isa isa, const simd_probe_input *in, simd_probe_output *out) {
    switch (isa) {
#if defined __x86_64__ || defined __i386__
    case CPU_SSE42: simd_probe_sse42(in, out); return;
    case CPU_AVX2: simd_probe_avx2(in, out); return;
    case CPU_AVX512: simd_probe_avx512(in, out); return;
#endif
    default: assert(0 && "an ISA with vectors"); (void)in, (void)out;
    }
}

static double keep_double(double a, uint64_t keep) {
    uint64_t bits;
    memcpy(&bits, &a, sizeof bits);
    bits &= keep;
    memcpy(&a, &bits, sizeof a);
    return a;
}

static float keep_float(float a, uint32_t keep) {
    uint32_t bits;
    memcpy(&bits, &a, sizeof bits);
    bits &= keep;
    memcpy(&a, &bits, sizeof a);
    return a;
}

static void meant_doubles(const simd_probe_input *in, int i, simd_probe_output *out) {
    const double a = in->a[i], b = in->b[i];
    out->d[PROBE_ADD][i] = a + b;
    out->d[PROBE_SUB][i] = a - b;
    out->d[PROBE_MUL][i] = a * b;
    out->d[PROBE_DIV][i] = a / b;
    out->d[PROBE_MIN][i] = a < b ? a : b;
    out->d[PROBE_MAX][i] = a > b ? a : b;
    out->d[PROBE_SQRT][i] = sqrt(a);
    out->d[PROBE_ABS][i] = fabs(a);
    out->d[PROBE_SELECT][i] = in->p >> i & 1u ? a : b;
    out->d[PROBE_SET][i] = in->a[0];
    out->d[PROBE_BITS][i] = keep_double(a, in->keep);
    out->d[PROBE_CONVERT][i] = (double)in->x[i];
    out->d[PROBE_NARROW][i] = (double)(float)a;
}

static uint64_t bits_of(double x) {
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

static void meant_integers(const simd_probe_input *in, int lanes, int i, simd_probe_output *out) {
    const unsigned at = in->p >> i & 3u;
    const uint32_t low = (uint32_t)bits_of(in->a[i]);
    const uint64_t product = (uint64_t)low * (uint32_t)bits_of(in->b[i]);
    float f;
    memcpy(&f, &low, sizeof f);
    out->d[PROBE_GATHER][i] = in->a[at + 1];
    memcpy(&out->d[PROBE_BYTES][i], (const char *)in->a + at, sizeof(double));
    out->d[PROBE_REVERSE][i] = in->a[lanes - 1 - i];
    out->d[PROBE_LOW][i] = (double)f;
    memcpy(&out->d[PROBE_PRODUCT][i], &product, sizeof product);
    out->d_mask[PROBE_SAME] |= (uint32_t)(bits_of(in->a[i]) == bits_of(in->b[i])) << i;
    out->d_mask[PROBE_ODD] |= (uint32_t)(bits_of(in->a[i]) & 1u) << i;
}

/* The i-th of the lanes that q has bits for; `lanes`: there are none. */
static int packed(const simd_probe_input *in, int lanes, int i) {
    for (int k = 0; k < lanes; k++)
        if ((in->q >> k & 1u) && i-- == 0)
            return k;
    return lanes;
}

static void meant_tables(const simd_probe_input *in, int lanes, int i, simd_probe_output *out) {
    const unsigned five = in->p >> i & 31u;
    const uint64_t number = (uint16_t)(in->p << i);
    out->d[PROBE_TABLE][i] = five < 16 ? in->a[five] : in->b[five - 16];
    out->d[PROBE_HALF][i] = in->a[in->p >> i & 15u];
    memcpy(&out->d[PROBE_SHORTS][i], &number, sizeof number);
    const int from = packed(in, lanes, i);
    out->d[PROBE_PACK][i] = from < lanes ? in->a[from] : 1.0;
}

static void meant_floats(const simd_probe_input *in, int lanes, int i, simd_probe_output *out) {
    const float x = in->x[i], y = in->y[i];
    out->f[PROBE_ADD][i] = x + y;
    out->f[PROBE_SUB][i] = x - y;
    out->f[PROBE_MUL][i] = x * y;
    out->f[PROBE_DIV][i] = x / y;
    out->f[PROBE_MIN][i] = x < y ? x : y;
    out->f[PROBE_MAX][i] = x > y ? x : y;
    out->f[PROBE_SQRT][i] = sqrtf(x);
    out->f[PROBE_ABS][i] = fabsf(x);
    out->f[PROBE_SELECT][i] = in->p >> i & 1u ? x : y;
    out->f[PROBE_SET][i] = in->x[0];
    out->f[PROBE_BITS][i] = keep_float(x, (uint32_t)(in->keep >> 32));
    out->f[PROBE_CONVERT][i] = (float)in->a[i];
    out->f[PROBE_FLOOR][i] = floorf(x);
    out->f[PROBE_CEIL][i] = ceilf(x);
    out->f[PROBE_ANY][i] = in->p >> i & 1u ? 1.0f : 0.0f;
    out->f[PROBE_INT][i] = fabsf(x) < 0x1p30f ? (float)(int32_t)x : 0.0f;
    out->f[PROBE_STREAM][i] = x;
    for (int k = 0; k < 3; k++)
        out->f[PROBE_TRIPLE_X + k][i] = in->x[3 * (in->p >> i & 3u) + (unsigned)k];
    for (int k = 0; k < 4; k++)
        out->f[PROBE_FOUR_X + k][i] = in->x[4 * (in->p >> i & 3u) + (unsigned)k];
    out->f[PROBE_FOUR_TABLE][i] = in->x[in->p >> i & 3u];
    const int from = packed(in, lanes, i);
    out->f[PROBE_PACK_INT][i] = from < lanes ? (float)(in->p << from) : 1.0f;
    const uint32_t keep = (uint32_t)(in->keep >> 32);
    memcpy(&out->f[PROBE_GATHER_INT][i], (const char *)in->x + 7u * (in->p >> i & 3u),
           sizeof(float));
    out->f[PROBE_SIXTEEN][i] = (float)(keep << (in->p >> i & 15u));
    out->f[PROBE_OF_INTS][i] = (float)(int32_t)(keep << i);
}

#define MEANT_MASKS(to, a, b, i)                \
    do {                                        \
        const uint32_t bit = 1u << (i);         \
        (to)[PROBE_LT] |= (a) < (b) ? bit : 0;  \
        (to)[PROBE_LE] |= (a) <= (b) ? bit : 0; \
        (to)[PROBE_EQ] |= (a) == (b) ? bit : 0; \
        (to)[PROBE_GE] |= (a) >= (b) ? bit : 0; \
        (to)[PROBE_GT] |= (a) > (b) ? bit : 0;  \
    } while (0)

static void meant_logic(const simd_probe_input *in, int lanes, uint32_t to[PROBE_MASKS]) {
    const unsigned all = (1u << lanes) - 1;
    to[PROBE_AND] = in->p & in->q & all;
    to[PROBE_OR] = (in->p | in->q) & all;
    to[PROBE_AND_NOT] = in->p & ~in->q & all;
    to[PROBE_OF_BITS] = in->p & all;
}

void simd_probe_meant(const simd_probe_input *in, int doubles, int floats, simd_probe_output *out) {
    memset(out, 0, sizeof *out);
    out->doubles = doubles;
    out->floats = floats;
    for (int i = 0; i < doubles; i++) {
        meant_doubles(in, i, out);
        meant_integers(in, doubles, i, out);
        meant_tables(in, doubles, i, out);
        MEANT_MASKS(out->d_mask, in->a[i], in->b[i], i);
    }
    for (int i = 0; i < floats; i++) {
        meant_floats(in, floats, i, out);
        MEANT_MASKS(out->f_mask, in->x[i], in->y[i], i);
    }
    meant_logic(in, doubles, out->d_mask);
    meant_logic(in, floats, out->f_mask);
    out->d_mask[PROBE_XOR] = (in->p ^ in->q) & ((1u << doubles) - 1);
}
