#include "formats/leaf/deviation.h"

#include <float.h>
#include <math.h>

/* ---- Codes ---- */

uint16_t deviation_code(double d) {
    uint32_t bits;
    if (!(d <= (double)FLT_MAX))
        return DEVIATION_UNKNOWN;
    float f = (float)d;
    if ((double)f < d)
        f = nextafterf(f, INFINITY);
    memcpy(&bits, &f, sizeof bits);
    return (uint16_t)((bits + 0xFFFFu) >> 16);
}

/* ---- Where codes are ---- */

uint64_t deviation_bytes(const leaf_header *h) {
    uint64_t finest = 1;
    if (h->bare)
        return 0;
    for (int a = 0; a < 3; a++)
        finest *= ((h->dims[a] - 2) >> h->cells_log2) + 1;
    const uint64_t sets = (uint64_t)h->fields * h->steps;
    return ((h->treelets - finest) * sets << 3 * (h->cells_log2 - DEVIATION_BRICK_LOG2)) *
           sizeof(uint16_t);
}

static bool has_cells(const leaf_layout *l, const leaf_payload *p, uint32_t i) {
    const uint32_t side = deviation_side(l);
    const uint32_t at[3] = {i % side, i / side % side, i / side / side};
    bool any = true;
    for (int a = 0; a < 3; a++)
        any &= at[a] << DEVIATION_BRICK_LOG2 < p->cells[a];
    return any;
}

bool deviation_has_cells(const leaf_layout *l, uint32_t t, uint32_t brick) {
    const leaf_payload p = leaf_layout_payload(l, t);
    return has_cells(l, &p, brick);
}

bool deviation_sound(const leaf_layout *l, const uint16_t *codes, size_t *brick) {
    const uint32_t bricks = deviation_bricks(l), coarse = l->level[0].first;
    for (uint32_t t = 0; t < coarse; t++) {
        const leaf_payload p = leaf_layout_payload(l, t);
        for (uint32_t i = 0; i < bricks; i++) {
            const unsigned most = has_cells(l, &p, i) ? DEVIATION_UNKNOWN : 0;
            for (uint32_t set = 0; set < l->sets; set++) {
                *brick = deviation_at(l, set, t) + i;
                if (codes[*brick] > most)
                    return false;
            }
        }
    }
    return true;
}

/* The greatest deviation over the cells [first, end) of coarse treelet t. */
static double most_over(const leaf_layout *l, const uint16_t *codes, uint32_t set, uint32_t t,
                        const uint32_t first[3], const uint32_t end[3]) {
    const uint16_t *of = codes + deviation_at(l, set, t);
    uint16_t most = 0;
    for (uint32_t z = first[2]; z < end[2]; z = (z / DEVIATION_BRICK + 1) * DEVIATION_BRICK)
        for (uint32_t y = first[1]; y < end[1]; y = (y / DEVIATION_BRICK + 1) * DEVIATION_BRICK)
            for (uint32_t x = first[0]; x < end[0];
                 x = (x / DEVIATION_BRICK + 1) * DEVIATION_BRICK) {
                const uint16_t code = of[deviation_brick(l, x, y, z)];
                most = code > most ? code : most;
            }
    return deviation_value(most);
}

double deviation_over(const leaf_layout *l, const uint16_t *codes, uint32_t set, uint32_t t,
                      uint32_t k, uint32_t *up) {
    uint32_t place[3], first[3], end[3];
    for (int a = 0; a < 3; a++) {
        const uint64_t from = (uint64_t)l->place[t][a] << l->cells_log2;
        const uint64_t to = from + (1u << l->cells_log2);
        const uint64_t last = to < l->level[0].cells[a] ? to : l->level[0].cells[a];
        place[a] = (uint32_t)(from >> k >> l->cells_log2);
        first[a] = (uint32_t)(from >> k) - (place[a] << l->cells_log2);
        end[a] = (uint32_t)((last - 1) >> k) + 1 - (place[a] << l->cells_log2);
    }
    *up = leaf_layout_find(l, k, place);
    return most_over(l, codes, set, *up, first, end);
}

/* ---- Two levels ---- */

/* The coordinate of a node, also behind the end: as in a level's planes, the last cell of level 0
 * is repeated there. */
static double coordinate(const double *axis, uint32_t last, uint64_t node) {
    return node <= last ? axis[node]
                        : axis[last] + (double)(node - last) * (axis[last] - axis[last - 1]);
}

double deviation_weight(const double *axis, uint32_t last, uint32_t fine, uint32_t i) {
    const double from = coordinate(axis, last, (uint64_t)2 * i << fine);
    const double at = coordinate(axis, last, ((uint64_t)2 * i + 1) << fine);
    const double to = coordinate(axis, last, ((uint64_t)2 * i + 2) << fine);
    return (at - from) / (to - from);
}

/* On each of three axes the weight errs by at most 2^-51. The product with it and two sums err by
 * as much, relative to numbers up to twice the largest value. All that is less than 2^-46 of that
 * value. */
double deviation_rounding(sample_type type, bool rectilinear, const double range[2],
                          uint32_t level) {
    if ((type != SAMPLE_F32 && !rectilinear) || !(range[0] <= range[1]))
        return 0.0;
    return level * 0x1p-45 * fmax(fabs(range[0]), fabs(range[1]));
}
