#include "formats/grid/slice_tiles.h"

#include <string.h>

void slice_tiles_fill(const uint32_t dims[3], const slice_tile *t, size_t width, const void *value,
                      void *slice) {
    char row[SLICE_TILE * SLICE_SAMPLE_MAX];
    const size_t bytes = (t->end_x - t->x) * width;
    for (size_t i = 0; i < bytes; i += width)
        memcpy(row + i, value, width);
    for (uint32_t y = t->y; y < t->end_y; y++)
        memcpy((char *)slice + ((size_t)y * dims[0] + t->x) * width, row, bytes);
}

static void copy_tile(const uint32_t dims[3], const slice_tile *t, size_t width, const char *from,
                      char *to) {
    for (uint32_t y = t->y; y < t->end_y; y++) {
        const size_t at = ((size_t)y * dims[0] + t->x) * width;
        memcpy(to + at, from + at, (t->end_x - t->x) * width);
    }
}

void slice_tiles_copy(const uint32_t dims[3], size_t width, const void *from, const uint8_t *busy,
                      void *to, uint8_t *to_busy) {
    const size_t count = slice_tiles_count(dims);
    for (size_t i = 0; i < count; i++) {
        if (busy[i] || to_busy[i]) {
            const slice_tile t = slice_tiles_at(dims, i);
            copy_tile(dims, &t, width, from, to);
        }
        to_busy[i] = busy[i];
    }
}

size_t slice_tiles_gather(const uint32_t dims[3], size_t width, const void *slice,
                          const uint8_t *busy, void *packed) {
    const size_t count = slice_tiles_count(dims);
    char *at = packed;
    for (size_t i = 0; i < count; i++) {
        const slice_tile t = slice_tiles_at(dims, i);
        const size_t bytes = (t.end_x - t.x) * width;
        for (uint32_t y = t.y; busy[i] && y < t.end_y; y++, at += bytes)
            memcpy(at, (const char *)slice + ((size_t)y * dims[0] + t.x) * width, bytes);
    }
    return (size_t)(at - (char *)packed);
}

size_t slice_tiles_scatter(const uint32_t dims[3], size_t width, const void *packed,
                           const uint8_t *busy, void *slice) {
    const size_t count = slice_tiles_count(dims);
    const char *at = packed;
    for (size_t i = 0; i < count; i++) {
        const slice_tile t = slice_tiles_at(dims, i);
        const size_t bytes = (t.end_x - t.x) * width;
        for (uint32_t y = t.y; busy[i] && y < t.end_y; y++, at += bytes)
            memcpy((char *)slice + ((size_t)y * dims[0] + t.x) * width, at, bytes);
    }
    return (size_t)(at - (const char *)packed);
}
