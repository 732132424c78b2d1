#include "prep/grid/treelet_build.h"

#include <assert.h>
#include <string.h>

#include "formats/grid/slice_tiles.h"
#include "formats/leaf/grid_family.h"

/* ---- samples ---- */

/* A row's samples: the first node of the level is repeated `before` times, the last one `behind`
 * times. */
typedef struct row_part {
    uint32_t from; /* first node that is there */
    uint32_t before, there, behind;
} row_part;

static row_part row_part_of(int64_t first, uint32_t count, uint32_t nodes) {
    const int64_t last = first + count - 1;
    const int64_t from = first < 0 ? 0 : first, to = last >= nodes ? (int64_t)nodes - 1 : last;
    return (row_part){.from = (uint32_t)from,
                      .before = (uint32_t)(from - first),
                      .there = (uint32_t)(to - from + 1),
                      .behind = (uint32_t)(last - to)};
}

/* Copy a row of between n and 2n bytes by its first and its last n. */
#define COPY_ENDS(n)                                        \
    do {                                                    \
        memcpy(out, from, (n));                             \
        memcpy(out + bytes - (n), from + bytes - (n), (n)); \
    } while (0)

/* Copy one to three bytes. */
static inline void copy_few(char *restrict out, const char *restrict from, size_t bytes) {
    out[0] = from[0];
    out[bytes / 2] = from[bytes / 2];
    out[bytes - 1] = from[bytes - 1];
}

/* Copy bytes: rows are short and of any length, and too many for a call each. */
static inline void copy_bytes(char *restrict out, const char *restrict from, size_t bytes) {
    if (bytes > 128)
        memcpy(out, from, bytes);
    else if (bytes < 4)
        copy_few(out, from, bytes);
    else if (bytes <= 8)
        COPY_ENDS(4);
    else if (bytes <= 16)
        COPY_ENDS(8);
    else if (bytes <= 32)
        COPY_ENDS(16);
    else if (bytes <= 64)
        COPY_ENDS(32);
    else
        COPY_ENDS(64);
}

/* Copy a row whose first sample that is there lies at `row`. Returns the end of the copy. */
static inline char *copy_row(char *out, const char *row, const row_part *p, size_t size) {
    for (uint32_t i = 0; i < p->before; i++, out += size)
        memcpy(out, row, size);
    copy_bytes(out, row, p->there * size);
    row += (p->there - 1) * size;
    out += p->there * size;
    for (uint32_t i = 0; i < p->behind; i++, out += size)
        memcpy(out, row, size);
    return out;
}

static uint32_t clamped(int64_t i, uint32_t nodes) {
    return i < 0 ? 0 : i >= nodes ? nodes - 1 : (uint32_t)i;
}

/* Rows of a slab lie a slice's width apart, where no processor looks ahead by itself. Inlined: gcc
 * leaves out calls of functions that do nothing else. */
enum { AHEAD = 6 };

static inline __attribute__((always_inline)) void fetch_row(const char *row, size_t bytes) {
    for (size_t at = 0; at < bytes; at += 64)
        __builtin_prefetch(row + at);
    __builtin_prefetch(row + bytes - 1);
}

/* Copy a box of samples of a level, from node `first` on. Returns the end of the copy. */
static char *copy_samples(const leaf_layout *l, uint32_t level, const int64_t first[3],
                          const uint32_t count[3], const sample_box *box, char *out) {
    const uint32_t *nodes = l->level[level].dims;
    const size_t size = sample_size(l->type);
    const row_part part = row_part_of(first[0], count[0], nodes[0]);
    for (uint32_t k = 0; k < count[2]; k++) {
        const uint32_t z = clamped(first[2] + k, nodes[2]) - box->origin[2];
        const char *slice = box->slices[z] + (part.from - box->origin[0]) * size;
        assert(z < box->size[2]);
        for (uint32_t j = 0; j < count[1]; j++) {
            const uint32_t y = clamped(first[1] + j, nodes[1]) - box->origin[1];
            assert(y < box->size[1]);
            if (y + AHEAD < box->size[1])
                fetch_row(slice + (y + AHEAD) * box->row_bytes, part.there * size);
            out = copy_row(out, slice + y * box->row_bytes, &part, size);
        }
    }
    return out;
}

/* The nodes along an axis of which the treelet has samples, [*first, *last]. */
static void nodes_of(const leaf_layout *l, uint32_t t, const leaf_payload *p, int a,
                     uint32_t *first, uint32_t *last) {
    const int64_t from = ((int64_t)l->place[t][a] << l->cells_log2) - l->halo;
    const uint32_t nodes = l->level[l->level_of[t]].dims[a];
    *first = clamped(from, nodes);
    *last = clamped(from + p->samples[a] - 1, nodes);
}

bool treelet_build_quiet(const leaf_layout *l, uint32_t t, const sample_box *box) {
    const leaf_payload p = leaf_layout_payload(l, t);
    const uint32_t across = slice_tiles_along(l->level[l->level_of[t]].dims[0]);
    uint32_t first[3], last[3], busy = 0;
    if (!box->busy)
        return false;
    for (int a = 0; a < 3; a++)
        nodes_of(l, t, &p, a, &first[a], &last[a]);
    for (uint32_t z = first[2]; z <= last[2] && !busy; z++)
        for (uint32_t y = first[1] / SLICE_TILE; y <= last[1] / SLICE_TILE; y++)
            for (uint32_t x = first[0] / SLICE_TILE; x <= last[0] / SLICE_TILE; x++)
                busy |= box->busy[z - box->origin[2]][(size_t)y * across + x];
    return !busy;
}

void treelet_build(const leaf_layout *l, uint32_t t, const sample_box *box,
                   grid_codes_scratch *scratch, void *payload, grid_summary *summary) {
    const leaf_payload p = leaf_layout_payload(l, t);
    int64_t first[3];
    for (int a = 0; a < 3; a++)
        first[a] = ((int64_t)l->place[t][a] << l->cells_log2) - l->halo;
    copy_samples(l, l->level_of[t], first, p.samples, box, (char *)payload + p.samples_at);
    *summary = grid_codes_make(l, t, scratch, payload);
}

void treelet_build_shell(const leaf_layout *l, uint32_t parent, const sample_box *box,
                         void *samples) {
    family_part parts[FAMILY_PARTS_MAX];
    const uint32_t count = grid_family_parts(l, parent, parts), b = 2U << l->cells_log2;
    char *out = samples;
    for (uint32_t i = 0; i < count; i++) {
        int64_t first[3];
        for (int a = 0; a < 3; a++)
            first[a] = (int64_t)l->place[parent][a] * b - l->halo + parts[i].at[a];
        out = copy_samples(l, l->level_of[parent] - 1U, first, parts[i].size, box, out);
    }
}
