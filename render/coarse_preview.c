#include "render/coarse_preview.h"

#include "render/leafcast_device.h"

enum { SHARE_LOG2 = 3 };

/* Of the device's budget, if it has one. */
static size_t share_of(const leafcast *v) {
    return v->m->limit >> SHARE_LOG2;
}

size_t coarse_preview_bytes(const leafcast *v) {
    return v->coarse ? share_of(v) : 0;
}

void coarse_preview_end(leafcast *v) {
    if (v->coarse)
        volume_release(v->coarse);
    v->coarse = NULL;
}

static status open_coarse(leafcast *v, uint32_t set) {
    leafcast_options options = v->options;
    leafcast_experiments experiments = v->experiments;
    experiments.packets = 0;
    options.experiments = &experiments;
    options.backend = LEAFCAST_BACKEND_ARENA;
    leafcast *coarse = volume_on(v->device, &options);
    if (!coarse)
        return ST_NOMEM;
    const size_t before = mem_used(v->m);
    status st = leaf_file_open_coarse(v->m, v->file, set, &coarse->file);
    if (st == ST_OK)
        st = volume_open_file(coarse);
    if (st != ST_OK) {
        volume_release(coarse);
        return st;
    }
    coarse->base_bytes = mem_used(v->m) - before;
    v->coarse = coarse;
    v->coarse_set = set;
    return ST_OK;
}

/* As many treelets as its share holds; false: not even one. */
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
    return slots > 0;
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

status coarse_preview_begin(leafcast *v, const leafcast_scene *scene, const leafcast_shown *shown,
                            tracer *tr, const tracer **out) {
    *out = NULL;
    if (!scene->preview)
        return ST_OK;
    const uint32_t set = leaf_layout_set(&v->file->layout, shown->field, shown->step);
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
    if (!make_slots(v)) {
        coarse_preview_end(v);
        return ST_OK;
    }
    leafcast_scene whole = *scene;
    whole.smooth_normals = false; /* a grid has others */
    whole.lod = LEAFCAST_LOD_EXACT;
    volume_show(coarse, 0, 0, shown->surfaces, shown->count);
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
    stats->bytes_read_ever += l.bytes_read_ever;
    stats->bytes_resident += l.bytes_resident;
}
