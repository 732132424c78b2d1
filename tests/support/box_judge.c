#include "tests/support/box_judge.h"

#include <stdlib.h>
#include <string.h>
#include <zstd.h>

#include "tests/support/naive_box.h"

enum { HEADER = 16, CODED_MAX = 1 << 16 };

/* ---- making codes ---- */

static size_t row_bytes(uint32_t samples) {
    return (samples + 7) / 8;
}

static size_t map_bytes(const box_lab *b) {
    size_t bytes = 0;
    for (uint32_t i = 0; i < b->count; i++)
        bytes += row_bytes(b->boxes[i].size[0]) * b->boxes[i].size[1] * b->boxes[i].size[2];
    return bytes;
}

/* Clear the bits behind rows; returns how many are left. */
static uint32_t fit_map(const box_lab *b, unsigned char *map) {
    uint32_t ones = 0;
    for (uint32_t i = 0; i < b->count; i++) {
        const uint32_t *size = b->boxes[i].size;
        for (uint32_t row = 0; row < size[1] * size[2]; row++, map += row_bytes(size[0])) {
            if (size[0] % 8)
                map[size[0] / 8] &= (unsigned char)((1U << size[0] % 8) - 1);
            for (uint32_t x = 0; x < size[0]; x++)
                ones += map[x / 8] >> x % 8 & 1U;
        }
    }
    return ones;
}

static void put_u32(unsigned char *to, uint32_t v) {
    for (int i = 0; i < 4; i++)
        to[i] = (unsigned char)(v >> (8 * i));
}

static void put_header(const box_code *code, unsigned char *to) {
    to[0] = code->method;
    to[1] = code->map;
    to[2] = code->prediction;
    to[3] = code->width;
    put_u32(to + 4, code->base);
    put_u32(to + 8, code->background);
    put_u32(to + 12, code->coded);
}

unsigned char *box_judge_make(const box_lab *b, box_made *made, size_t *bytes) {
    const bool background = made->code.prediction & BOX_BACKGROUND;
    const unsigned streams = made->code.width + background;
    const size_t map = map_bytes(b), longest = (map > CODED_MAX ? map : CODED_MAX) + 1;
    unsigned char *stream = malloc(longest);
    unsigned char *out = malloc(HEADER + streams * (4 + ZSTD_compressBound(longest)));
    size_t taken = 0;
    *bytes = HEADER + 4 * streams;
    if (!stream || !out)
        abort();
    for (unsigned s = 0; s < streams; s++) {
        const bool is_map = background && s == 0;
        const size_t size = is_map ? map : made->code.coded & (CODED_MAX - 1);
        for (size_t i = 0; i < size; i++)
            stream[i] = made->data[taken++ % made->data_bytes];
        if (is_map && made->fits)
            made->code.coded = fit_map(b, stream);
        const size_t used = ZSTD_compress(out + *bytes, ZSTD_compressBound(size), stream, size, 1);
        put_u32(out + HEADER + 4 * s, (uint32_t)used);
        *bytes += used;
    }
    put_header(&made->code, out);
    free(stream);
    return out;
}

/* ---- judging them ---- */

/* What the independent reader makes of it; NULL: it is no code. */
static unsigned char *read_naively(const box_lab *b, const unsigned char *code, size_t bytes) {
    long sizes[BOX_LAB_MAX][3];
    unsigned char *samples = malloc(b->samples * b->width);
    for (uint32_t i = 0; i < b->count; i++)
        for (int a = 0; a < 3; a++)
            sizes[i][a] = b->boxes[i].size[a];
    if (samples && !naive_boxes_decode((int)b->type, (const long(*)[3])sizes, (int)b->count, code,
                                       bytes, NULL, samples))
        return samples;
    free(samples);
    return NULL;
}

static const char *judge_isa(box_coder *c, box_lab *b, const unsigned char *code, size_t bytes,
                             const unsigned char *want) {
    box_lab_wipe(b);
    const bool good = box_coder_decode(c, code, bytes, b->boxes, b->count, false);
    if (!box_lab_kept(b))
        return "a byte that is no sample has changed";
    if (good != (want != NULL))
        return good ? "the coder alone takes it" : "the independent reader alone takes it";
    if (!good)
        return NULL;
    unsigned char *got = box_lab_list(b);
    const bool same = memcmp(got, want, b->samples * b->width) == 0;
    free(got);
    return same ? NULL : "other samples";
}

const char *box_judge(mem *m, box_lab *b, const unsigned char *code, size_t bytes, bool *good) {
    box_coder *c = NULL;
    if (box_coder_create(m, b->type, b->samples, 0, &c) != ST_OK)
        return "no coder";
    /* Exactly as many bytes, so that a sanitizer sees each one that is read behind them. */
    unsigned char *exact = malloc(bytes ? bytes : 1);
    if (!exact)
        abort();
    memcpy(exact, code, bytes);
    unsigned char *want = read_naively(b, exact, bytes);
    const char *why = NULL;
    for (int isa = CPU_SCALAR; !why && isa <= (int)cpu_best(); isa++) {
        box_coder_use(c, (cpu_isa)isa);
        why = judge_isa(c, b, exact, bytes, want);
    }
    *good = want != NULL;
    free(want);
    free(exact);
    box_coder_destroy(c);
    return why;
}
