#include "render/curved/hex_kind.h"

#include "formats/base/box3.h"
#include "render/look/box_projection.h"
#include "render/ray/open_volume.h"

/* What rays need beside treelets: v->own, tr->own. */
typedef struct hex_rays {
    double tolerance;
} hex_rays;

double hex_kind_tolerance(const tracer *tr) {
    const hex_rays *own = tr->own;
    return own->tolerance;
}

status hex_kind_open(leafcast *v) {
    const leaf_header *h = &v->file->header;
    hex_rays *own = v->own = mem_zalloc(v->m, sizeof *own);
    if (!own)
        return ST_NOMEM;
    own->tolerance = hex_walk_tolerance(h->value_min, h->value_max);
    return ST_OK;
}

void hex_kind_close(leafcast *v) {
    mem_free(v->m, v->own);
}

void hex_kind_aim(leafcast *v, const leafcast_scene *scene, const struct camera *c, tracer *tr) {
    (void)scene, (void)c;
    tr->own = v->own;
    tr->boxed = tr->preview;
    box3_of_floats(v->file->header.bounds, tr->box);
}

segments_error hex_kind_error(const tracer *tr, const ray *r, const double range[2]) {
    return hex_walk_error(tr->box, hex_kind_tolerance(tr), r, range);
}

status hex_kind_project(leafcast *v, const struct camera *c, struct projection *out) {
    box_projection_init(out, v->file->header.bounds, c);
    return ST_OK;
}

size_t hex_kind_projection_bytes(const leaf_layout *layout) {
    (void)layout;
    return 0;
}
