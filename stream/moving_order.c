#include "stream/moving_order.h"

#include <string.h>

#include "formats/mesh/mesh_morton.h"

/* Digits of 11 bits: six passes for 63 bits, and counts that stay in the nearest cache. */
enum { DIGIT_BITS = 11, DIGITS = 1 << DIGIT_BITS };

typedef struct keyed {
    uint64_t key;
    uint32_t number;
} keyed;

size_t moving_order_memory(uint32_t triangles) {
    return 2 * (size_t)triangles * sizeof(keyed) + 1024;
}

static void make_keys(const moving_source *s, const float bounds[6], keyed *out) {
    const mesh_lattice l = mesh_lattice_of(bounds);
    for (uint32_t i = 0; i < s->triangles; i++) {
        float p[3][3];
        for (int k = 0; k < 3; k++)
            memcpy(p[k], s->positions[s->rows[i][k]], sizeof p[k]);
        out[i] = (keyed){mesh_morton_triangle(&l, (const float(*)[3])p), i};
    }
}

/* Sort by one digit, and keep the order of what has the same. Returns false where all have. */
static bool sort_digit(const keyed *from, keyed *to, uint32_t count, int shift) {
    uint32_t next[DIGITS] = {0}, sum = 0;
    for (uint32_t i = 0; i < count; i++)
        next[from[i].key >> shift & (DIGITS - 1)]++;
    if (next[from[0].key >> shift & (DIGITS - 1)] == count)
        return false;
    for (uint32_t d = 0; d < DIGITS; d++) {
        const uint32_t some = next[d];
        next[d] = sum;
        sum += some;
    }
    for (uint32_t i = 0; i < count; i++)
        to[next[from[i].key >> shift & (DIGITS - 1)]++] = from[i];
    return true;
}

status moving_order_sort(mem *m, const moving_source *s, const float bounds[6],
                         uint32_t numbers[]) {
    keyed *block = mem_array(m, 2 * (size_t)s->triangles, sizeof *block);
    if (!block)
        return ST_NOMEM;
    keyed *now = block, *other = block + s->triangles;
    make_keys(s, bounds, now);
    for (int shift = 0; shift < MESH_MORTON_BITS; shift += DIGIT_BITS)
        if (sort_digit(now, other, s->triangles, shift)) {
            keyed *sorted = other;
            other = now;
            now = sorted;
        }
    for (uint32_t i = 0; i < s->triangles; i++)
        numbers[i] = now[i].number;
    mem_free(m, block);
    return ST_OK;
}
