/* slice_tiles.h - marks the parts of slices that are one value, so that work on them can be left
 * out.
 *
 * A slice is cut into tiles of 16 x 16 samples, x fastest; tiles at the border are smaller. A map
 * has a byte a tile. 0: the tile is quiet; all its samples are the quiet value, to the bit, and are
 * stored in the slice all the same. 1: it is busy, and its samples may be any. A writer of slices
 * is given the map of what the memory holds, and keeps the map up to date: it does not touch a tile
 * that is quiet and stays so.
 */
#ifndef FORMATS_GRID_SLICE_TILES_H
#define FORMATS_GRID_SLICE_TILES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { SLICE_TILE_LOG2 = 4, SLICE_TILE = 1 << SLICE_TILE_LOG2, SLICE_SAMPLE_MAX = 8 };

/* slice_tiles_along() - returns the number of tiles along an axis of so many nodes.
 * slice_tiles_count() - returns the number of tiles of a slice, which is the size of its map in
 * bytes. */
static inline uint32_t slice_tiles_along(uint32_t nodes) {
    return (nodes + SLICE_TILE - 1) >> SLICE_TILE_LOG2;
}
static inline size_t slice_tiles_count(const uint32_t dims[3]) {
    return (size_t)slice_tiles_along(dims[0]) * slice_tiles_along(dims[1]);
}

/* Samples [x, end_x) of rows [y, end_y). */
typedef struct slice_tile {
    uint32_t x, end_x, y, end_y;
} slice_tile;

/* slice_tiles_at() - returns tile number `index` of a slice. */
static inline slice_tile slice_tiles_at(const uint32_t dims[3], size_t index) {
    const uint32_t across = slice_tiles_along(dims[0]);
    slice_tile t;
    t.x = (uint32_t)(index % across) << SLICE_TILE_LOG2;
    t.y = (uint32_t)(index / across) << SLICE_TILE_LOG2;
    t.end_x = dims[0] - t.x < SLICE_TILE ? dims[0] : t.x + SLICE_TILE;
    t.end_y = dims[1] - t.y < SLICE_TILE ? dims[1] : t.y + SLICE_TILE;
    return t;
}

/* slice_tiles_fill() - set all samples of a tile, `width` bytes each, to the value. */
void slice_tiles_fill(const uint32_t dims[3], const slice_tile *t, size_t width, const void *value,
                      void *slice);

/* slice_tiles_find() - make the map of a slice: tiles are quiet where all samples are the value.
 * slice_tiles_row_busy() - whether any tile of row `row` of a map is busy. */
void slice_tiles_find(const uint32_t dims[3], size_t width, const void *slice, const void *value,
                      uint8_t *busy);
bool slice_tiles_row_busy(const uint32_t dims[3], const uint8_t *busy, uint32_t row);

/* slice_tiles_copy() - copy a slice with its map to another slice. On entry to_busy says what `to`
 * holds. */
void slice_tiles_copy(const uint32_t dims[3], size_t width, const void *from, const uint8_t *busy,
                      void *to, uint8_t *to_busy);

/* slice_tiles_gather(), slice_tiles_scatter() - copy the samples of a slice's busy tiles to, or
 * from, memory in one piece: tile after tile, row after row. Both return the bytes of that piece.
 */
size_t slice_tiles_gather(const uint32_t dims[3], size_t width, const void *slice,
                          const uint8_t *busy, void *packed);
size_t slice_tiles_scatter(const uint32_t dims[3], size_t width, const void *packed,
                           const uint8_t *busy, void *slice);

#endif
