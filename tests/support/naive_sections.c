#include "tests/support/naive_sections.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <xxhash.h>
#include <zstd.h>

#include "tests/support/naive_bytes.h"

static bool wrong(naive_sections *s, const char *format, ...) __attribute__((format(printf, 2, 3)));
static bool wrong(naive_sections *s, const char *format, ...) {
    va_list args;
    va_start(args, format);
    vsnprintf(s->why, sizeof s->why, format, args);
    va_end(args);
    return false;
}

/* What a section holds: `bytes` of the file, or a frame of as many as are wanted. */
static const unsigned char *content(naive_sections *s, const unsigned char *at, uint64_t bytes,
                                    uint64_t version, uint64_t want) {
    if (version == 1)
        return bytes == want ? at : NULL;
    unsigned char *out = malloc(want + 1);
    s->frame[s->frames++] = out;
    if (!out || !s->directory || bytes >= want ||
        ZSTD_findFrameCompressedSize(at, bytes) != bytes ||
        ZSTD_decompress(out, want, at, bytes) != want)
        return NULL;
    return out;
}

static bool take_ancillary(naive_sections *s, const unsigned char *at, uint64_t bytes,
                           uint64_t version, uint64_t kind) {
    const bool histograms = kind == 0x40000001;
    const uint64_t size = version == 1 ? bytes : ZSTD_getFrameContentSize(at, bytes);
    if (!histograms && kind != 0x40000002)
        return true;
    const unsigned char *what = size < UINT32_MAX ? content(s, at, bytes, version, size) : NULL;
    if (histograms) {
        s->histograms = what;
        s->histogram_bytes = size;
    } else {
        s->deviations = what;
    }
    return what != NULL;
}

static bool take(naive_sections *s, const unsigned char *file, size_t size, int i,
                 const uint64_t want[NAIVE_KINDS]) {
    const unsigned char *entry = file + s->table + 32 * i;
    const uint64_t kind = naive_number(entry, 4), version = naive_number(entry + 4, 4),
                   offset = naive_number(entry + 8, 8), bytes = naive_number(entry + 16, 8);
    if (version < 1 || version > 2 || offset != naive_up_to(s->end, 64) || offset > size ||
        bytes > size - offset || !naive_zeros(file, s->end, offset))
        return wrong(s, "section %d is out of place", i);
    if (XXH3_64bits(file + offset, bytes) != naive_number(entry + 24, 8))
        return wrong(s, "checksum of section %d", i);
    s->end = offset + bytes;
    if (kind >> 30 & 1)
        return take_ancillary(s, file + offset, bytes, version, kind) ||
               wrong(s, "section kind %x", (unsigned)kind);
    if (kind < 1 || kind >= NAIVE_KINDS || s->where[kind] || !want[kind])
        return wrong(s, "section kind %d", (int)kind);
    if ((kind == NAIVE_SAME || kind == NAIVE_BASES) && !s->directory)
        return wrong(s, "section kind %d before the payloads", (int)kind);
    s->where[kind] = content(s, file + offset, bytes, version, want[kind]);
    return s->where[kind] || wrong(s, "size of section kind %d", (int)kind);
}

bool naive_sections_find(naive_sections *s, const unsigned char *file, size_t size,
                         const uint64_t want[NAIVE_KINDS], uint32_t optional) {
    const int count = (int)naive_number(file + 72, 4);
    memset(s, 0, sizeof *s);
    s->directory = naive_number(file + 1504, 8);
    s->table = s->directory ? s->directory : 4096;
    if (s->table % 64 || s->table < 4096 || s->table > size ||
        32 * (uint64_t)count > size - s->table)
        return wrong(s, "the place of the directory");
    s->end = s->table + 32 * (uint64_t)count;
    for (int i = 0; i < count; i++)
        if (!take(s, file, size, i, want))
            return false;
    for (int kind = 1; kind < NAIVE_KINDS; kind++)
        if (want[kind] && !s->where[kind] && !(optional >> kind & 1))
            return wrong(s, "no section of kind %d", kind);
    s->payloads = s->directory ? 4096 : s->end;
    return true;
}

void naive_sections_release(naive_sections *s) {
    while (s->frames > 0)
        free(s->frame[--s->frames]);
}

uint64_t naive_sections_hold(const naive_sections *s, const unsigned char *file, size_t size,
                             uint64_t end) {
    const uint64_t run = UINT64_C(1) << naive_number(file + 52, 4);
    if (s->directory) {
        if (s->directory != naive_up_to(end, 64) || !naive_zeros(file, end, s->directory))
            return 0;
        end = s->end;
    }
    const uint64_t all = naive_up_to(end, run);
    return all <= size && naive_zeros(file, end, all) ? all : 0;
}

long naive_sections_link(const naive_sections *s, int kind, long p) {
    return s->where[kind] ? (long)naive_number(s->where[kind] + 4 * p, 4) - 1 : -1;
}
