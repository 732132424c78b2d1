#include "render/door/coarse_preview.h"

#include "formats/leaf/coarse_pair.h"
#include "formats/leaf/leaf_between.h"
#include "formats/leaf/leaf_geometry.h"
#include "render/door/leafcast_device.h"

enum { SHARE_LOG2 = 3 };

/* The grid's bytes of the device's budget; 0: the device has no budget. */
static size_t share_of(const leafcast *v) {
    return v->m->limit >> SHARE_LOG2;
}

size_t coarse_preview_bytes(const leafcast *v) {
    return v->coarse ? share_of(v) : 0;
}

static bool is_held(const leafcast *v) {
    return v->coarse && v->coarse->frames > 0;
}

size_t coarse_preview_held(const leafcast *v) {
    return is_held(v) ? share_of(v) : 0;
}

void coarse_preview_end(leafcast *v) {
    if (!v->coarse || is_held(v))
        return;
    volume_release(v->coarse);
    v->coarse = NULL;
}

/* Open the coarse grid of a set of f, or if `inner` the one inside that where there is one. *out =
 * NULL: there is none. */
static status open_one(mem *m, const leaf_file *f, uint32_t set, bool inner, leaf_file **out) {
    *out = NULL;
    status st = leaf_file_has_coarse(f, set) ? leaf_file_open_coarse(m, f, set, out) : ST_OK;
    leaf_file *outer = *out;
    if (!outer || !inner || !leaf_file_has_coarse(outer, 0))
        return st;
    *out = NULL;
    st = leaf_file_open_coarse(m, outer, 0, out);
    leaf_file_close(outer);
    return st;
}

uint32_t coarse_preview_levels(leafcast *v) {
    leaf_file *outer = NULL, *inner = NULL;
    uint32_t levels = 0;
    v->cell_levels = v->file->layout.sampled;
    if (open_one(v->m, leaf_file_stores(v->file), 0, false, &outer) == ST_OK && outer) {
        levels = outer->layout.sampled;
        v->coarse_is_grid = outer->geometry->has_map;
        v->cell_levels += v->coarse_is_grid ? 0 : levels;
        if (open_one(v->m, outer, 0, false, &inner) == ST_OK && inner)
            levels += inner->layout.sampled;
    }
    leaf_file_close(inner);
    leaf_file_close(outer);
    return levels;
}

/* Whether what is shown of v is between steps whose grids can be blended: those of samples. Where
 * points move, grids have data in different places: a blend would have some where both have, and
 * of no cell. */
static bool is_blended(const leafcast *v) {
    return v->file->below && v->coarse_is_grid && !leaf_layout_moves(&v->file->layout);
}

/* The set whose grid is shown, or that and the next one's blend: else the nearest step's. */
static uint32_t set_of(const leafcast *v, const leafcast_shown *shown) {
    const leaf_layout *stored = &leaf_file_stores(v->file)->layout;
    const bool next = !is_blended(v) && shown->between >= 0.5;
    return leaf_layout_set(stored, shown->field, shown->step + next);
}

/* Open the file of a set's grid, or one between this and the next set's. *out = NULL: there is
 * none. */
static status open_file(const leafcast *v, uint32_t set, bool inner, leaf_file **out) {
    leaf_file *pair = NULL;
    if (!is_blended(v))
        return open_one(v->m, leaf_file_stores(v->file), set, inner, out);
    if (!coarse_pair_has(leaf_file_stores(v->file), set))
        return ST_OK;
    status st = coarse_pair_open(v->m, v->file->below, set, &pair);
    if (st == ST_OK)
        st = leaf_between_open(v->m, pair, v->device->isa, out);
    if (st == ST_OK)
        (*out)->owns_below = true;
    else
        leaf_file_close(pair);
    return st;
}

/* v->coarse stays NULL where there is no grid. */
static status open_coarse(leafcast *v, uint32_t set, bool inner) {
    leafcast_options options = v->options;
    leafcast_experiments experiments = v->experiments;
    experiments.packets = 0;
    options.experiments = &experiments;
    options.backend = LEAFCAST_BACKEND_ARENA;
    leafcast *coarse = volume_on(v->device, &options);
    if (!coarse)
        return ST_NOMEM;
    const size_t before = mem_used(v->m);
    status st = open_file(v, set, inner, &coarse->file);
    if (st == ST_OK && coarse->file)
        st = volume_open_file(coarse);
    if (st != ST_OK || !coarse->file) {
        volume_release(coarse);
        return st;
    }
    coarse->base_bytes = mem_used(v->m) - before;
    v->coarse = coarse;
    v->coarse_set = set;
    v->coarse_inner = inner;
    return ST_OK;
}

/* Whether what is open is of samples. */
static bool is_sampled(const leafcast *coarse) {
    return coarse->file->geometry->has_map;
}

/* Allow as many treelets as the grid's share holds. Returns false if not even one fits, or not all
 * of what has no coarser ones. */
static bool make_slots(const leafcast *v) {
    const leafcast *coarse = v->coarse;
    const size_t slot = loader_slot_bytes(coarse->treelets), share = share_of(v);
    size_t slots = coarse->file->layout.treelets;
    if (share) {
        const size_t room = share > coarse->base_bytes ? (share - coarse->base_bytes) / slot : 0;
        slots = room < slots ? room : slots;
    }
    if (slots > 0)
        loader_set_capacity(coarse->treelets, (uint32_t)slots, 0);
    return slots > 0 && (is_sampled(coarse) || slots == coarse->file->layout.treelets);
}

/* Load the coarsest level, which is one treelet, and wait for it. */
static status load_root(loader *l) {
    loader_request root = {0, 0};
    loader_forget_failures(l);
    return l->own[0] && !loader_lookup(l, 0) ? loader_admit(l, &root, 1) : ST_OK;
}

/* What is no grid has no coarser level that is there at once: wait for all that is seen of it. */
static status wait_for_cells(const leafcast *coarse) {
    return is_sampled(coarse) ? ST_OK : loader_settle(coarse->treelets);
}

/* Whether what stands for the first set has a grid inside. */
static bool has_inner(const leafcast *v) {
    return !v->coarse_is_grid && v->preview_levels > v->file->layout.sampled + 1;
}

/* Whether the open grid is that of a set, or the one inside it. */
static bool is_of(const leafcast *v, uint32_t set, bool inner) {
    return v->coarse_set == set && v->coarse_inner == inner;
}

/* Open the grid of the set that is shown of v, or the one inside that, also where there is no room
 * for the other. *out = NULL: there is no grid, or no room for it. */
static status open_shown(leafcast *v, const leafcast_shown *shown, bool inner, leafcast **out) {
    const uint32_t set = set_of(v, shown);
    *out = NULL;
    if (!is_of(v, set, inner))
        coarse_preview_end(v);
    if (v->coarse && !is_of(v, set, inner))
        return ST_OK;
    const status st = v->coarse ? ST_OK : open_coarse(v, set, inner);
    if (st != ST_OK || !v->coarse)
        return st == ST_NOMEM ? ST_OK : st;
    if (make_slots(v))
        *out = v->coarse;
    else
        coarse_preview_end(v);
    if (*out || inner || !has_inner(v))
        return ST_OK;
    const status instead = open_shown(v, shown, true, out);
    v->coarse_inner = false; /* it is what is asked for */
    return instead;
}

leafcast_shown coarse_preview_shown(leafcast *coarse, const leafcast_shown *shown) {
    leafcast_shown grid = *shown;
    grid.volume = coarse;
    grid.field = grid.step = 0;
    return grid;
}

/* The scene for rays through a grid: without the cells' normals, and with the grid's levels. */
static leafcast_scene scene_of_grid(const leafcast_scene *scene, leafcast_lod lod, uint32_t level) {
    leafcast_scene of = *scene;
    of.smooth_normals = false;
    of.lod = lod;
    of.lod_level = level;
    return of;
}

status coarse_preview_begin(leafcast *v, const leafcast_scene *scene, const leafcast_shown *shown,
                            tracer *tr, const tracer **out) {
    const leafcast_scene whole = scene_of_grid(scene, LEAFCAST_LOD_EXACT, 0);
    leafcast *coarse = NULL;
    *out = NULL;
    status st = scene->preview ? open_shown(v, shown, false, &coarse) : ST_OK;
    if (!coarse)
        return st;
    const leafcast_shown grid = coarse_preview_shown(coarse, shown);
    const interest nothing = {.count = 0};
    volume_show_beside(&grid, &nothing);
    coarse->seek = v->seek;
    st = load_root(coarse->treelets);
    if (st == ST_OK)
        st = volume_tracer(coarse, &whole, NULL, tr); /* forgets what was queued */
    if (st == ST_NOMEM)
        coarse_preview_end(v);
    if (st != ST_OK)
        return st == ST_NOMEM ? ST_OK : st;
    loader_sweep(coarse->treelets);
    *out = tr;
    return wait_for_cells(coarse);
}

status coarse_preview_instead(leafcast *v, const leafcast_scene *scene, const leafcast_shown *shown,
                              leafcast **out) {
    const bool asked = scene->preview && scene->lod == LEAFCAST_LOD_LEVEL && scene->lod_level > 0;
    *out = NULL;
    const bool inner = has_inner(v) && scene->lod_level > 1;
    return asked ? open_shown(v, shown, inner, out) : ST_OK;
}

status coarse_preview_show(leafcast *coarse, const leafcast_scene *scene,
                           const leafcast_shown *shown, const interest *beside, const camera *c,
                           tracer *tr) {
    const bool inside = is_sampled(coarse) && !shown->volume->coarse_is_grid;
    const uint32_t last = coarse->file->layout.sampled - 1, level_there = scene->lod_level - 1,
                   asked = inside && level_there ? level_there - 1 : level_there;
    const leafcast_scene level =
        scene_of_grid(scene, LEAFCAST_LOD_LEVEL, asked < last ? asked : last);
    const leafcast_shown grid = coarse_preview_shown(coarse, shown);
    volume_show_beside(&grid, beside);
    coarse->seek = shown->volume->seek;
    status st = load_root(coarse->treelets);
    if (st == ST_OK)
        st = volume_tracer(coarse, &level, c, tr);
    if (st == ST_OK)
        loader_sweep_level(coarse->treelets, tr->target_level, UINT64_MAX);
    if (st == ST_OK)
        st = wait_for_cells(coarse);
    tr->doubts = false; /* how far the grid is from the cells is not known */
    return st;
}

void coarse_preview_stats(const leafcast *v, leafcast_stats *stats) {
    const loader_stats l = loader_statistics(v->coarse->treelets);
    stats->bytes_read += l.bytes_read;
    stats->bytes_read_ever += l.bytes_read_ever;
    stats->bytes_resident += l.bytes_resident;
}
