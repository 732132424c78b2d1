/* leafcast_map.c - counts of wanted, resident and seen treelets: in blocks of the volume, at steps;
 * and the steps that have a value.
 */
#include <float.h>
#include <math.h>
#include <stddef.h>
#include <string.h>

#include "formats/leaf/leaf_stats.h"
#include "render/door/arguments.h"
#include "render/door/leafcast_device.h"
#include "render/door/leafcast_volume.h"
#include "render/ray/kind.h"

/* Find the blocks first .. last along an axis that a treelet from lo to hi overlaps. A block that
 * the treelet only touches does not count, nor does an overlap within rounding (1e-9 block). */
static void reach(double lo, double hi, uint32_t blocks, uint32_t *first, uint32_t *last) {
    const double most = blocks - 1.0, rounding = 1e-9;
    *first = (uint32_t)fmin(fmax(floor(lo * blocks + rounding), 0.0), most);
    *last = (uint32_t)fmin(fmax(ceil(hi * blocks - rounding) - 1.0, *first), most);
}

static void count(const leafcast *v, uint32_t t, const uint32_t blocks[3], leafcast_block *map) {
    /* Unwanted treelets may be resident, too: points and slices bring them in. */
    const bool wanted = v->treelets->own[t];
    const bool resident = wanted && loader_is_ready(v->treelets, t);
    const leafcast_block one = {.treelets = 1,
                                .wanted = wanted,
                                .resident = resident,
                                .seen = resident &&
                                        atomic_load_explicit(&v->touched[t], memory_order_relaxed)};
    double span[2][3];
    uint32_t lo[3], hi[3];
    v->kind->walks->span(v, t, span);
    for (int a = 0; a < 3; a++)
        reach(span[0][a], span[1][a], blocks[a], &lo[a], &hi[a]);
    for (uint32_t z = lo[2]; z <= hi[2]; z++)
        for (uint32_t y = lo[1]; y <= hi[1]; y++)
            for (uint32_t x = lo[0]; x <= hi[0]; x++) {
                leafcast_block *b = &map[((size_t)z * blocks[1] + y) * blocks[0] + x];
                b->treelets += one.treelets;
                b->wanted += one.wanted;
                b->resident += one.resident;
                b->seen += one.seen;
            }
}

static status check(const leafcast *v, uint32_t level, const uint32_t blocks[3]) {
    for (int a = 0; a < 3; a++)
        if (blocks[a] < 1 || blocks[a] > LEAFCAST_BLOCKS_MAX)
            return status_describe(ST_USAGE, "a map of %u blocks along an axis: 1 to %d", blocks[a],
                                   LEAFCAST_BLOCKS_MAX);
    return leaf_file_check_level(v->file, level);
}

leafcast_status leafcast_map_treelets(leafcast *v, uint32_t level, const uint32_t blocks[3],
                                      leafcast_block *map) {
    live_hold h;
    status st = arguments_check_volume(__func__, v);
    if (st == ST_OK)
        st = public_needs(__func__, "blocks map", (const void *[]){blocks, map});
    if (st == ST_OK)
        st = check(v, level, blocks);
    if (st != ST_OK)
        return public_status(st);
    const leaf_level *of = &v->file->layout.level[level];
    memset(map, 0, (size_t)blocks[0] * blocks[1] * blocks[2] * sizeof *map);
    volume_lock(v, &h);
    const leafcast *shown = v->is_between ? v->between : v;
    for (uint32_t t = of->first; t < of->first + of->count; t++)
        count(shown, t, blocks, map);
    volume_unlock(v, &h);
    return LEAFCAST_OK;
}

_Static_assert(sizeof(leafcast_holding) == sizeof(loader_holding) &&
                   offsetof(leafcast_holding, resident) == offsetof(loader_holding, resident),
               "the public counts are the loader's");

leafcast_status leafcast_map_steps(leafcast *v, uint32_t field, uint32_t steps,
                                   leafcast_holding *holdings) {
    live_hold h;
    status st = arguments_check_volume(__func__, v);
    if (st == ST_OK)
        st = public_needs(__func__, "holdings", (const void *[]){holdings});
    if (st == ST_OK)
        st = public_in_range(__func__, "steps", steps, 1, UINT32_MAX);
    if (st == ST_OK)
        st = volume_check_set(v, field, steps - 1);
    if (st != ST_OK)
        return public_status(st);
    volume_lock(v, &h);
    const leafcast *shown = v->is_between ? v->between : v;
    const uint32_t first = leaf_layout_set(&v->file->layout, field, v->live ? v->step : 0);
    if (shown != v)
        volume_seek_same(v, shown);
    loader_count_sets(v->treelets, first, steps, shown->touched, (loader_holding *)holdings);
    volume_unlock(v, &h);
    return LEAFCAST_OK;
}

static status check_find(const leafcast *v, uint32_t field, double lo, double hi, uint32_t steps) {
    status st = public_in_range("leafcast_find_steps", "lo", lo, -DBL_MAX, DBL_MAX);
    if (st == ST_OK)
        st = public_in_range("leafcast_find_steps", "hi", hi, lo, DBL_MAX);
    if (st == ST_OK)
        st = public_in_range("leafcast_find_steps", "steps", steps, 1, UINT32_MAX);
    return st == ST_OK ? volume_check_set(v, field, steps - 1) : st;
}

leafcast_status leafcast_find_steps(const leafcast *v, uint32_t field, double lo, double hi,
                                    uint32_t steps, uint8_t *has, uint32_t *first) {
    status st = public_needs(__func__, "volume first", (const void *[]){v, first});
    if (st == ST_OK)
        st = check_find(v, field, lo, hi, steps);
    if (st != ST_OK)
        return public_status(st);
    const value_limits at = {value_limits_threshold(lo), value_limits_threshold(hi)};
    uint32_t found = steps;
    live_hold h;
    const uint32_t from = volume_hold(v, 0, &h);
    for (uint32_t step = 0; step < steps && (has || found == steps); step++) {
        const uint32_t set = leaf_layout_set(&v->file->layout, field, from + step);
        const bool here = leaf_stats_meets(v->file, set, at);
        found = here && found == steps ? step : found;
        if (has)
            has[step] = here;
    }
    volume_let_go(v, &h);
    *first = found;
    return LEAFCAST_OK;
}
