#include "render/experiments/experiments.h"

#include <string.h>

#include "render/experiments/intersect_walk.h"
#include "render/experiments/isopolygon_cache.h"
#include "render/experiments/mesh_packet.h"
#include "render/experiments/preintegrated_integrator.h"
#include "render/experiments/stepping_integrator.h"
#include "render/experiments/walk_choices.h"
#include "render/frame/laboratory.h"
#include "render/mesh/mesh_kind.h"
#include "render/ray/open_volume.h"

CPU_KERNELS(tile_fn, mesh_packet_kernels, NULL, mesh_packet);

/* Use packets instead of tiles. */
static status use_packets(leafcast *v) {
    if (v->kind != &mesh_kind)
        return status_describe(ST_USAGE, "packets are for meshes: in a %s, tiles of rays walk",
                               v->kind->name);
    v->kernels.tile = mesh_packet_kernels[v->kernels.isa];
    return ST_OK;
}

/* Keep isopolygons with their treelets. */
static void load(const leafcast *v, loader_options *o) {
    if (v->kind == &mesh_kind)
        o->derived =
            isopolygon_cache_kind(v->experiments.isopolygons == LEAFCAST_ISOPOLYGONS_PRECOMPUTE);
}

static status begin_steps(frame *f, const leafcast_scene *scene, const laboratory_medium *medium,
                          void **out) {
    enum { TABLE = 256 };
    const leafcast_scene_experiments *e = scene->experiments;
    preintegrated_look *look = *out = mem_zalloc(f->m, sizeof *look);
    if (!look)
        return ST_NOMEM;
    stepping_look *steps = &look->steps;
    *steps = (stepping_look){.medium = medium->transfer,
                             .step = e->step * medium->cell_size,
                             .opaque = e->opaque > 0.0 ? e->opaque : 0.9999};
    memcpy(steps->background, scene->background, sizeof scene->background);
    f->integrator = &stepping_integrator;
    f->look = look;
    if (e->summing != LEAFCAST_PREINTEGRATED)
        return ST_OK;
    f->integrator = &preintegrated_integrator;
    return preintegrated_table_make(&look->table, f->m, f->threads, steps->medium, medium->range,
                                    steps->step, e->table > 0 ? e->table : TABLE);
}

static void end_steps(mem *m, void *of) {
    preintegrated_look *look = of;
    if (!look)
        return;
    preintegrated_table_release(&look->table, m);
    mem_free(m, look);
}

const laboratory laboratory_table = {.walk_named = walk_choice_named,
                                     .walk_by = intersect_walk_by,
                                     .load = load,
                                     .use_packets = use_packets,
                                     .begin_steps = begin_steps,
                                     .end_steps = end_steps};

const laboratory *const experiments_linked = &laboratory_table;
