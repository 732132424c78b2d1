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

bool slice_tiles_row_busy(const uint32_t dims[3], const uint8_t *busy, uint32_t row) {
    const uint32_t across = slice_tiles_along(dims[0]);
    return memchr(busy + (size_t)row * across, 1, across) != NULL;
}

/* Mark the tiles of a row of tiles in which a row of samples is not all the value. Returns how many
 * are not marked. */
static uint32_t mark_row(uint32_t nodes, size_t width, const char *samples, const char *quiet,
                         uint8_t *busy) {
    const size_t bytes = SLICE_TILE * width;
    uint32_t left = 0;
    for (uint32_t i = 0; i < nodes / SLICE_TILE; i++) {
        busy[i] = busy[i] || memcmp(samples + i * bytes, quiet, bytes) != 0;
        left += !busy[i];
    }
    if (nodes % SLICE_TILE) {
        const uint32_t i = nodes / SLICE_TILE;
        busy[i] = busy[i] || memcmp(samples + i * bytes, quiet, nodes % SLICE_TILE * width) != 0;
        left += !busy[i];
    }
    return left;
}

void slice_tiles_find(const uint32_t dims[3], size_t width, const void *slice, const void *value,
                      uint8_t *busy) {
    const uint32_t across = slice_tiles_along(dims[0]), down = slice_tiles_along(dims[1]);
    char quiet[SLICE_TILE * SLICE_SAMPLE_MAX];
    for (size_t i = 0; i < SLICE_TILE; i++)
        memcpy(quiet + i * width, value, width);
    memset(busy, 0, slice_tiles_count(dims));
    for (uint32_t row = 0; row < down; row++, busy += across) {
        const uint32_t end = (row + 1) * SLICE_TILE, last = end < dims[1] ? end : dims[1];
        uint32_t left = across;
        for (uint32_t y = row * SLICE_TILE; y < last && left > 0; y++)
            left = mark_row(dims[0], width, (const char *)slice + (size_t)y * dims[0] * width,
                            quiet, busy);
    }
}

/* Copy the samples of consecutive tiles of a row of tiles. */
static void copy_run(const uint32_t dims[3], size_t width, const slice_tile *first, uint32_t end_x,
                     const char *from, char *to) {
    for (uint32_t y = first->y; y < first->end_y; y++) {
        const size_t at = ((size_t)y * dims[0] + first->x) * width;
        memcpy(to + at, from + at, (end_x - first->x) * width);
    }
}

void slice_tiles_copy(const uint32_t dims[3], size_t width, const void *from, const uint8_t *busy,
                      void *to, uint8_t *to_busy) {
    const size_t count = slice_tiles_count(dims), across = slice_tiles_along(dims[0]);
    for (size_t i = 0; i < count; i++) {
        const slice_tile first = slice_tiles_at(dims, i);
        const size_t row_end = i - i % across + across;
        size_t end = i;
        while (end < row_end && (busy[end] || to_busy[end]))
            end++;
        if (end == i)
            continue;
        copy_run(dims, width, &first, slice_tiles_at(dims, end - 1).end_x, from, to);
        memcpy(to_busy + i, busy + i, end - i);
        i = end - 1;
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
