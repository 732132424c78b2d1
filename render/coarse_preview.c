#include "render/coarse_preview.h"

#include <string.h>

enum { SHARE_LOG2 = 3 };

size_t coarse_preview_bytes(const leafcast *v) {
    return v->coarse ? v->coarse->budget.limit : 0;
}

void coarse_preview_end(leafcast *v) {
    leafcast_close(v->coarse);
    v->coarse = NULL;
}

static status open_coarse(leafcast *v, uint32_t set) {
    mem outside;
    mem_init(&outside, 0);
    leafcast *coarse = mem_zalloc(&outside, sizeof *coarse);
    if (!coarse)
        return ST_NOMEM;
    coarse->options = v->options;
    coarse->options.threads = 1;
    coarse->options.packets = 0;
    coarse->options.backend = LEAFCAST_BACKEND_ARENA;
    coarse->kernels = v->kernels;
    coarse->readers = loader_readers(v->treelets);
    mem_init(&coarse->budget, v->budget.limit >> SHARE_LOG2);
    status st = leaf_file_open_coarse(&coarse->budget, v->file, set, &coarse->file);
    if (st == ST_OK)
        st = volume_open_file(coarse);
    if (st != ST_OK) {
        leafcast_close(coarse);
        return st;
    }
    v->coarse = coarse;
    v->coarse_set = set;
    return ST_OK;
}

/* As many treelets as its budget holds; false: not even one. */
static bool make_places(leafcast *coarse) {
    const size_t place = loader_place_bytes(coarse->treelets);
    size_t places = coarse->file->layout.treelets;
    if (coarse->budget.limit) {
        const size_t room = coarse->budget.limit > coarse->base_bytes
                                ? (coarse->budget.limit - coarse->base_bytes) / place
                                : 0;
        places = room < places ? room : places;
    }
    if (places > 0)
        loader_set_capacity(coarse->treelets, (uint32_t)places, 0);
    return places > 0;
}

/* The coarsest level, which is one treelet, at once; the others behind it. */
static status begin_loading(loader *l) {
    status st = ST_OK;
    loader_request root = {0, 0};
    loader_forget_failures(l);
    if (l->own[0] && !loader_lookup(l, 0))
        st = loader_admit(l, &root, 1);
    if (st == ST_OK)
        loader_sweep(l);
    return st;
}

status coarse_preview_begin(leafcast *v, const leafcast_scene *scene, tracer *tr,
                            const tracer **out) {
    *out = NULL;
    if (!scene->preview)
        return ST_OK;
    const uint32_t set = leaf_layout_set(&v->file->layout, v->field, v->step);
    if (v->coarse && v->coarse_set != set)
        coarse_preview_end(v);
    if (!leaf_file_has_coarse(v->file, set))
        return ST_OK;
    status st = v->coarse ? ST_OK : open_coarse(v, set);
    if (st == ST_NOMEM)
        return ST_OK;
    if (st != ST_OK)
        return st;
    leafcast *coarse = v->coarse;
    if (!make_places(coarse)) {
        coarse_preview_end(v);
        return ST_OK;
    }
    leafcast_scene whole = *scene;
    whole.smooth_normals = false; /* a grid has others */
    whole.lod = LEAFCAST_LOD_EXACT;
    if (coarse->surface_count != v->surface_count ||
        memcmp(coarse->surfaces, v->surfaces, (size_t)v->surface_count * sizeof *v->surfaces) != 0)
        (void)leafcast_select(coarse, v->surfaces, v->surface_count);
    st = begin_loading(coarse->treelets);
    if (st == ST_OK)
        st = volume_tracer(coarse, &whole, NULL, tr);
    if (st == ST_OK)
        *out = tr;
    return st;
}

void coarse_preview_stats(const leafcast *v, leafcast_stats *stats) {
    const loader_stats l = loader_statistics(v->coarse->treelets);
    stats->bytes_read += l.bytes_read;
    stats->bytes_resident += l.bytes_resident;
    stats->bytes_peak += mem_peak(&v->coarse->budget);
}
