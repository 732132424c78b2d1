#include "tests/support/naive_deviation.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "tests/support/naive_bytes.h"

typedef long double real;

enum { BRICK = 8 };

static char why[256];

/* The deviation of a brick of a level, by its place in the level's bricks. */
static real stored(const naive_leaf *leaf, const unsigned char *codes, long set, int level,
                   const long brick[3]) {
    const long side = (1L << leaf->cells_log2) / BRICK;
    long coarse = 0, t = -1;
    for (long i = 0; i < leaf->treelet_count; i++) {
        const naive_treelet *x = &leaf->treelets[i];
        coarse += x->level > 0;
        if (x->level == level && x->at[0] == brick[0] / side && x->at[1] == brick[1] / side &&
            x->at[2] == brick[2] / side)
            t = i;
    }
    const long in = brick[0] % side + side * (brick[1] % side + side * (brick[2] % side));
    const long at = (set * coarse + t) * side * side * side + in;
    const uint64_t code = naive_number(codes + 2 * at, 2);
    const uint32_t bits = (uint32_t)code << 16;
    float value;
    memcpy(&value, &bits, sizeof value);
    return (real)value;
}

/* Where node i of a level lies on an axis. */
static real place(const naive_leaf *leaf, int a, int level, long i) {
    const long node = i << level, last = leaf->dims[a] - 1;
    if (!leaf->rectilinear)
        return node;
    const double *axis = leaf->axis[a];
    return node <= last
               ? (real)axis[node]
               : (real)axis[last] + (real)(node - last) * ((real)axis[last] - (real)axis[last - 1]);
}

/* The interpolant of a level at a point, in the cell that has it; NaN: there is no value. */
static real value_at(const naive_leaf *leaf, int level, const real p[3]) {
    const naive_level *v = &leaf->level[level];
    real sum = 0;
    long cell[3];
    real at[3];
    for (int a = 0; a < 3; a++) {
        cell[a] = 0;
        while (cell[a] + 1 < v->cells[a] && place(leaf, a, level, cell[a] + 1) <= p[a])
            cell[a]++;
        const real lo = place(leaf, a, level, cell[a]), hi = place(leaf, a, level, cell[a] + 1);
        at[a] = (p[a] - lo) / (hi - lo);
    }
    for (int c = 0; c < 8; c++) {
        real weight = 1;
        for (int a = 0; a < 3; a++)
            weight *= c >> a & 1 ? at[a] : 1 - at[a];
        const float f = naive_leaf_sample(leaf, level, cell[0] + (c & 1), cell[1] + (c >> 1 & 1),
                                          cell[2] + (c >> 2));
        if (!isfinite(f))
            return (real)NAN;
        sum += weight * (real)f;
    }
    return sum;
}

/* The greatest difference of two levels in a box of cells of the finer one, at its nodes. */
static real most_off(const naive_leaf *leaf, int fine, int coarse, const long from[3],
                     const long cells[3]) {
    real most = 0;
    for (long z = 0; z <= cells[2]; z++)
        for (long y = 0; y <= cells[1]; y++)
            for (long x = 0; x <= cells[0]; x++) {
                const long i[3] = {from[0] + x, from[1] + y, from[2] + z};
                const float f = naive_leaf_sample(leaf, fine, i[0], i[1], i[2]);
                real p[3];
                for (int a = 0; a < 3; a++)
                    p[a] = place(leaf, a, fine, i[a]);
                const real off = fabsl((real)f - value_at(leaf, coarse, p));
                most = isfinite(f) && off <= most ? most
                       : isfinite(f) && off >= 0  ? off
                                                  : (real)INFINITY;
                if (most == (real)INFINITY)
                    return most;
            }
    return most;
}

/* The cells of level `fine` that a brick of level `coarse` has, or a part of it. */
static void cells_of(const naive_leaf *leaf, int fine, const long first[3], long width,
                     long cells[3]) {
    for (int a = 0; a < 3; a++) {
        const long left = leaf->level[fine].cells[a] - first[a];
        cells[a] = left < width ? left : width;
    }
}

/* By the level below, with what is stored there. */
static real carried(const naive_leaf *leaf, const unsigned char *codes, long set, int level,
                    const long brick[3]) {
    real most = 0;
    for (int o = 0; o < 8; o++) {
        long below[3], first[3], cells[3];
        for (int a = 0; a < 3; a++) {
            below[a] = 2 * brick[a] + (o >> a & 1);
            first[a] = below[a] * BRICK;
        }
        cells_of(leaf, level - 1, first, BRICK, cells);
        if (cells[0] <= 0 || cells[1] <= 0 || cells[2] <= 0)
            continue;
        const real before = level > 1 ? stored(leaf, codes, set, level - 1, below) : 0;
        most = fmaxl(most, before + most_off(leaf, level - 1, level, first, cells));
    }
    return most;
}

static bool check_brick(const naive_leaf *leaf, const unsigned char *codes, long set, int level,
                        const long brick[3], long *known) {
    const real has = stored(leaf, codes, set, level, brick);
    const real least = carried(leaf, codes, set, level, brick);
    const real slack =
        level * 0x1p-44L * fmaxl(fabsl((real)leaf->value_min), fabsl((real)leaf->value_max));
    const bool integers = leaf->sample_type != 5 && !leaf->rectilinear;
    long first[3], cells[3];
    for (int a = 0; a < 3; a++)
        first[a] = brick[a] * BRICK << level;
    cells_of(leaf, 0, first, (long)BRICK << level, cells);
    const real off = least < (real)INFINITY ? most_off(leaf, 0, level, first, cells) : 0;
    *known += has < (real)INFINITY;
    const real most = least * (1 + 0x1p-6L) + (integers ? 0 : 2 * slack);
    const bool tight =
        least == (real)INFINITY || (integers && least == 0) ? has == least : has <= most;
    if (has >= least && tight && off <= has && (least > 0 || !integers || off == 0))
        return true;
    snprintf(why, sizeof why,
             "level %d, brick %ld %ld %ld: %Lg is stored, %Lg follows, the levels are %Lg off",
             level, brick[0], brick[1], brick[2], has, least, off);
    return false;
}

static uint64_t next_random(uint64_t *state) {
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return *state >> 33;
}

/* Anywhere in the volume. */
static bool check_point(const naive_leaf *leaf, const unsigned char *codes, long set,
                        uint64_t *state) {
    real p[3];
    long cell[3];
    for (int a = 0; a < 3; a++) {
        cell[a] = (long)(next_random(state) % (uint64_t)leaf->level[0].cells[a]);
        const real lo = place(leaf, a, 0, cell[a]), hi = place(leaf, a, 0, cell[a] + 1);
        p[a] = lo + (hi - lo) * (real)(next_random(state) % 1025) / 1024;
    }
    const real truth = value_at(leaf, 0, p);
    for (int level = 1; level < leaf->levels; level++) {
        long brick[3];
        for (int a = 0; a < 3; a++)
            brick[a] = (cell[a] >> level) / BRICK;
        const real has = stored(leaf, codes, set, level, brick);
        const real seen = value_at(leaf, level, p);
        if (has == (real)INFINITY || fabsl(seen - truth) <= has * (1 + 1e-15L))
            continue;
        snprintf(why, sizeof why, "at %Lg %Lg %Lg level %d has %Lg, not %Lg +- %Lg", p[0], p[1],
                 p[2], level, seen, truth, has);
        return false;
    }
    return true;
}

const char *naive_deviation_check(const naive_leaf *leaf, long set, long points, uint64_t seed,
                                  long *known) {
    const unsigned char *codes = leaf->sections.deviations;
    *known = 0;
    if (!codes)
        return "there is no section";
    for (int level = 1; level < leaf->levels; level++) {
        const long *cells = leaf->level[level].cells;
        for (long z = 0; z * BRICK < cells[2]; z++)
            for (long y = 0; y * BRICK < cells[1]; y++)
                for (long x = 0; x * BRICK < cells[0]; x++) {
                    const long brick[3] = {x, y, z};
                    if (!check_brick(leaf, codes, set, level, brick, known))
                        return why;
                }
    }
    for (long i = 0; i < points; i++)
        if (!check_point(leaf, codes, set, &seed))
            return why;
    return NULL;
}
