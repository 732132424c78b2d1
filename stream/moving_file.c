#include "stream/moving_file.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/colour_field.h"
#include "formats/base/file.h"

static void fill_header(leaf_file *f, const moving_source *src, uint32_t treelets) {
    const uint32_t fields = src->values && src->colours ? MOVING_FIELDS_MAX : 1;
    f->header = (leaf_header){.version = LEAF_VERSION,
                              .kind = LEAF_KIND_TRIANGLES,
                              .sample_type = SAMPLE_F32,
                              .source_type = SAMPLE_F32,
                              .levels = 1,
                              .codec = LEAF_CODEC_RAW,
                              .fields = fields,
                              .steps = MOVING_STEPS,
                              .treelets = treelets,
                              .payload_bytes = src->vertices * sizeof(float[3]),
                              .file_bytes = src->vertices * sizeof(float[3]),
                              .value_min = (double)INFINITY,
                              .value_max = (double)-INFINITY,
                              .tets = src->triangles,
                              .vertices = src->vertices,
                              .treelet_tets = MOVING_TRIANGLES,
                              .moving = 1};
    f->header.to_world[0] = f->header.to_world[5] = f->header.to_world[10] = 1;
}

/* The treelets' triangles and vertices, which all else follows from. */
static status lay_out(leaf_file *f, const moving_surface *s) {
    leaf_cells_directory *d = f->besides;
    for (uint32_t t = 0; t < f->layout.treelets; t++) {
        const triangle_shape *shape = &s->treelets[t].at[0].shape;
        d->counts[t][0] = shape->triangles;
        d->counts[t][1] = shape->vertices;
        d->first[t + 1] = d->first[t] + shape->triangles;
    }
    leaf_layout_set_counts(&f->layout, (const uint32_t(*)[4])d->counts);
    return leaf_layout_init_flat(&f->layout, f->m);
}

static status allocate(leaf_file *f) {
    const leaf_header *h = &f->header;
    if (!leaf_layout_blocks(&f->layout, f->geometry, h->treelets, h->fields, h->steps, true))
        return status_describe(ST_UNSUPPORTED, "%llu treelets are too many for two steps",
                               (unsigned long long)h->treelets);
    status st = leaf_file_allocate_changing(f);
    if (st == ST_OK)
        st = f->geometry->allocate(f);
    f->step_bounds = mem_array(f->m, h->steps, sizeof *f->step_bounds);
    f->axis[0] = mem_array(f->m, 1, sizeof *f->axis[0]); /* never NULL */
    return st == ST_OK && !(f->step_bounds && f->axis[0]) ? ST_NOMEM : st;
}

static void name_fields(leaf_file *f, const moving_source *src) {
    const bool coloured = src->colours != NULL;
    snprintf(f->name, sizeof f->name, "moving");
    if (src->values)
        snprintf(f->names[0], sizeof f->names[0], "%s", src->name ? src->name : "value");
    if (coloured)
        snprintf(f->names[f->header.fields - 1], sizeof f->names[0], "%s", COLOUR_FIELD);
    memcpy(f->header.field, f->names[0], sizeof f->header.field);
}

/* What a field has in a treelet: the same at all steps. */
static void describe(leaf_file *f, uint32_t of, uint32_t t, const float *values, uint32_t count) {
    float range[2] = {INFINITY, -INFINITY};
    bool whole = true;
    for (uint32_t i = 0; i < count; i++) {
        whole = whole && isfinite(values[i]);
        if (isfinite(values[i])) {
            range[0] = fminf(range[0], values[i]);
            range[1] = fmaxf(range[1], values[i]);
        }
    }
    for (uint32_t step = 0; step < MOVING_STEPS; step++) {
        const uint32_t set = leaf_layout_set(&f->layout, of, step);
        const size_t at = leaf_layout_samples(&f->layout, set, t);
        for (int k = 0; k < 2; k++)
            f->own[at][k] = f->ranges[at][k] = range[k] + 0.0f; /* no -0 */
        f->flags[at] = whole ? 0 : LEAF_FLAG_NON_FINITE;
    }
    f->header.value_min = fmin(f->header.value_min, (double)range[0]);
    f->header.value_max = fmax(f->header.value_max, (double)range[1]);
}

status moving_file_make(moving_surface *s, const moving_source *src) {
    leaf_file *f = s->file = mem_zalloc(s->m, sizeof *f);
    if (!f)
        return ST_NOMEM;
    f->m = s->m;
    f->moving = s;
    f->geometry = leaf_geometry_of(LEAF_KIND_TRIANGLES);
    status st = file_open_memory(s->m, "the moving surface", "", 0, &f->source);
    fill_header(f, src, s->treelet_count);
    if (st == ST_OK)
        st = allocate(f);
    if (st == ST_OK)
        st = lay_out(f, s);
    if (st != ST_OK)
        return st;
    name_fields(f, src);
    for (uint32_t of = 0; of < f->header.fields; of++)
        for (uint32_t t = 0; t < s->treelet_count; t++)
            describe(f, of, t, s->values[of] + s->treelets[t].first,
                     s->treelets[t].at[0].shape.vertices);
    return ST_OK;
}

void moving_file_set_bounds(const leaf_file *f, uint32_t step, uint32_t t, const float box[6]) {
    const leaf_cells_directory *d = triangle_directory_of(f);
    memcpy(d->bounds[leaf_layout_bounds(&f->layout, step, t)], box, sizeof *d->bounds);
}

const float *moving_file_merge_bounds(const leaf_file *f, uint32_t step) {
    const leaf_layout *l = &f->layout;
    const float(*boxes)[6] =
        (const float(*)[6])triangle_directory_of(f)->bounds + leaf_layout_bounds(l, step, 0);
    float *all = f->step_bounds[step];
    memcpy(all, boxes[0], sizeof *boxes);
    for (uint32_t t = 1; t < l->treelets; t++)
        for (int a = 0; a < 3; a++) {
            all[a] = boxes[t][a] < all[a] ? boxes[t][a] : all[a];
            all[a + 3] = boxes[t][a + 3] > all[a + 3] ? boxes[t][a + 3] : all[a + 3];
        }
    for (uint32_t of = 0; of < f->header.fields; of++)
        f->versions[leaf_layout_set(l, of, step)]++;
    return all;
}
