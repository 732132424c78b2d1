#include "tests/support/naive_box.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <zstd.h>

#include "tests/support/naive_bytes.h"

enum { HEADER = 16 };

typedef struct code {
    int type, sample_bytes;
    uint64_t mask;    /* all bits of a sample */
    uint64_t samples; /* of all boxes */
    uint64_t map_bytes;
    int map, how, width;
    bool along, has_background, differs;
    uint64_t base, background, coded;
    unsigned char *bits; /* the map of samples */
    unsigned char *streams;
    uint64_t *u; /* of all samples, in their order */
} code;

int naive_sample_bytes(int type) {
    return type <= 2 ? 1 : type <= 4 ? 2 : 4;
}

static uint64_t row_bytes(long samples) {
    return (uint64_t)(samples + 7) / 8;
}

/* ---- header and streams ---- */

static const char *read_fields(code *c, const unsigned char *in) {
    c->map = in[1];
    c->how = in[2] & 3;
    c->along = in[2] >> 2 & 1;
    c->has_background = in[2] >> 3 & 1;
    c->differs = in[2] >> 4 & 1;
    c->width = in[3];
    c->base = naive_number(in + 4, 4);
    c->background = naive_number(in + 8, 4);
    c->coded = naive_number(in + 12, 4);
    if (in[0] != 1 || in[2] > 31)
        return "a code's method or prediction";
    if (c->map > (c->type == 5 ? 31 : 0) || (c->map == 0 && c->base != 0))
        return "a code's map or base";
    if (c->width > (c->coded ? c->sample_bytes : 0))
        return "a code's width";
    if (c->background > (c->has_background ? c->mask : 0))
        return "a code's background";
    if (c->coded > c->samples || (!c->has_background && c->coded != c->samples))
        return "how many residuals a code has";
    return NULL;
}

/* One stream of so many bytes. */
static bool expand(const unsigned char *in, uint64_t size, unsigned char *out, uint64_t bytes) {
    unsigned char none;
    return ZSTD_findFrameCompressedSize(in, size) == size &&
           ZSTD_decompress(bytes ? out : &none, bytes, in, size) == bytes;
}

static const char *read_streams(code *c, const unsigned char *in, uint64_t bytes) {
    const int streams = c->width + c->has_background;
    uint64_t at = HEADER + 4 * (uint64_t)streams;
    c->bits = malloc(c->map_bytes);
    c->streams = malloc(c->coded * (uint64_t)c->width + 1);
    if (!c->bits || !c->streams)
        return "no memory";
    if (at > bytes)
        return "a code's sizes of streams are cut off";
    for (int s = 0; s < streams; s++) {
        const bool map = c->has_background && s == 0;
        const uint64_t size = naive_number(in + HEADER + 4 * s, 4);
        unsigned char *out =
            map ? c->bits : c->streams + c->coded * (uint64_t)(s - c->has_background);
        if (size > bytes - at || !expand(in + at, size, out, map ? c->map_bytes : c->coded))
            return "a stream of a code";
        at += size;
    }
    return at == bytes ? NULL : "bytes behind a code";
}

/* ---- the map of samples ---- */

static bool is_coded(const code *c, const unsigned char *row, long x) {
    return !c->has_background || (row[x / 8] >> x % 8 & 1);
}

static const char *check_map(const code *c, const long (*sizes)[3], int count) {
    const unsigned char *row = c->bits;
    uint64_t ones = 0;
    for (int b = 0; b < count; b++)
        for (long n = 0; n < sizes[b][1] * sizes[b][2]; n++, row += row_bytes(sizes[b][0]))
            for (long x = 0; x < 8 * (long)row_bytes(sizes[b][0]); x++) {
                const bool one = row[x / 8] >> x % 8 & 1;
                if (one && x >= sizes[b][0])
                    return "a bit of a map behind its row";
                ones += one;
            }
    return ones == c->coded ? NULL : "a map has more or fewer bits than there are residuals";
}

/* ---- prediction ---- */

static uint64_t least(uint64_t a, uint64_t b) {
    return a < b ? a : b;
}

static uint64_t most(uint64_t a, uint64_t b) {
    return a > b ? a : b;
}

/* u: of this box; n: which sample it is. */
static uint64_t predict(const code *c, const uint64_t *u, const long size[3], long n) {
    const long row = size[0], plane = size[0] * size[1];
    const bool has_above = n / row % size[1] > 0, has_behind = n / plane > 0;
    if (c->how == 0 || (!has_above && !has_behind))
        return 0;
    if (!has_above || !has_behind)
        return has_above ? u[n - row] : u[n - plane];
    const uint64_t above = u[n - row], behind = u[n - plane], corner = u[n - row - plane];
    if (c->how == 1)
        return above;
    if (c->how == 3 && corner >= most(above, behind))
        return least(above, behind);
    if (c->how == 3 && corner <= least(above, behind))
        return most(above, behind);
    return above + behind - corner;
}

static uint64_t residual(const code *c, uint64_t index) {
    uint64_t r = 0;
    for (int b = 0; b < c->width; b++)
        r |= (uint64_t)c->streams[c->coded * (uint64_t)b + index] << (8 * b);
    return r;
}

/* d of a residual, modulo 2^64. */
static uint64_t difference(uint64_t r) {
    return r % 2 == 0 ? r / 2 : -((r + 1) / 2);
}

static void make_values(const code *c, const long (*sizes)[3], int count) {
    const unsigned char *bits = c->bits;
    uint64_t *u = c->u, next = 0;
    for (int b = 0; b < count; b++) {
        const long *size = sizes[b], all = size[0] * size[1] * size[2];
        uint64_t e = 0;
        for (long n = 0; n < all; n++) {
            const long x = n % size[0];
            bits += x == 0 && n > 0 ? row_bytes(size[0]) : 0;
            e = x == 0 ? 0 : e;
            if (!is_coded(c, bits, x)) {
                u[n] = c->background;
                continue;
            }
            const uint64_t d = difference(residual(c, next++));
            e += d;
            u[n] = (predict(c, u, size, n) + (c->along ? e : d)) & c->mask;
        }
        bits += row_bytes(size[0]);
        u += all;
    }
}

/* ---- values ---- */

static double step_of(int map) {
    static const double decimal[8] = {0, 1, 1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6};
    return map <= 7 ? decimal[map] : ldexp(1, 7 - map);
}

/* The u that stands for an earlier sample; of a map, 0 for one that is no multiple. */
static uint64_t value_of(const code *c, const unsigned char *sample) {
    const uint64_t bits = naive_number(sample, c->sample_bytes);
    if (c->type == 1 || c->type == 3)
        return bits;
    if (c->type == 2 || c->type == 4)
        return bits ^ (c->mask / 2 + 1);
    if (c->map == 0)
        return bits >> 31 ? ~bits & c->mask : bits ^ 0x80000000u;
    static const double in_one[8] = {0, 1, 10, 100, 1e3, 1e4, 1e5, 1e6};
    const double times = c->map <= 7 ? in_one[c->map] : ldexp(1, c->map - 7);
    const double near = (double)naive_float_of(bits) * times;
    if (bits == 0x7fc00000 || !(fabs(near) < 0x1p30 - 1))
        return 0;
    const int64_t k = (int64_t)(near < 0 ? near - 0.5 : near + 0.5);
    const float value = (float)((double)k * step_of(c->map));
    uint32_t found;
    memcpy(&found, &value, sizeof found);
    return found == bits ? ((uint64_t)k - c->base) & c->mask : 0;
}

/* The bits of the sample that u stands for. */
static uint64_t sample_of(const code *c, uint64_t u) {
    if (c->type == 1 || c->type == 3)
        return u;
    if (c->type == 2 || c->type == 4)
        return u ^ (c->mask / 2 + 1);
    if (c->map == 0)
        return u >> 31 ? u ^ 0x80000000u : ~u & c->mask;
    if (u == 0)
        return 0x7fc00000;
    const int64_t sum = (int64_t)((u + c->base) & c->mask);
    const double product =
        (double)(sum < INT64_C(0x80000000) ? sum : sum - INT64_C(0x100000000)) * step_of(c->map);
    const float value = (float)product;
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

static void put(const code *c, uint64_t u, unsigned char *out) {
    const uint64_t bits = sample_of(c, u);
    for (int b = 0; b < c->sample_bytes; b++)
        out[b] = (unsigned char)(bits >> (8 * b));
}

static const char *decode(code *c, const long (*sizes)[3], int count, const unsigned char *in,
                          uint64_t bytes, const unsigned char *earlier, unsigned char *out) {
    const char *why = read_fields(c, in);
    if (!why && c->differs != (earlier != NULL))
        why = "differences to nothing, or a base for none";
    why = why ? why : read_streams(c, in, bytes);
    if (!why && c->has_background)
        why = check_map(c, sizes, count);
    c->u = why ? NULL : malloc(c->samples * sizeof c->u[0]);
    if (why || !c->u)
        return why ? why : "no memory";
    make_values(c, sizes, count);
    for (uint64_t i = 0; earlier && i < c->samples; i++)
        c->u[i] =
            (c->u[i] + value_of(c, earlier + i * (uint64_t)c->sample_bytes) - (c->mask / 2 + 1)) &
            c->mask;
    for (uint64_t i = 0; i < c->samples; i++)
        put(c, c->u[i], out + i * (uint64_t)c->sample_bytes);
    return NULL;
}

const char *naive_boxes_decode(int type, const long (*sizes)[3], int count, const unsigned char *in,
                               uint64_t bytes, const unsigned char *earlier, unsigned char *out) {
    code c = {.type = type, .sample_bytes = naive_sample_bytes(type)};
    c.mask = (UINT64_C(1) << (8 * c.sample_bytes)) - 1;
    for (int b = 0; b < count; b++) {
        c.samples += (uint64_t)(sizes[b][0] * sizes[b][1] * sizes[b][2]);
        c.map_bytes += row_bytes(sizes[b][0]) * (uint64_t)(sizes[b][1] * sizes[b][2]);
    }
    const uint64_t plain = c.samples * (uint64_t)c.sample_bytes;
    if (bytes < HEADER || bytes > HEADER + plain)
        return "a code's size";
    if (in[0] == 0) {
        if (earlier || !naive_zeros(in, 1, HEADER) || bytes != HEADER + plain)
            return "a plain code";
        memcpy(out, in + HEADER, plain);
        return NULL;
    }
    const char *why = decode(&c, sizes, count, in, bytes, earlier, out);
    free(c.bits);
    free(c.streams);
    free(c.u);
    return why;
}
