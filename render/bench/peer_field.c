#include "render/bench/peer_field.h"

#include <string.h>

#include "formats/leaf/leaf_unpacker.h"

typedef struct loading {
    peer_field *field;
    leaf_file *leaf;
    struct buffers {
        leaf_unpacker *unpacker;
        void *payload;
    } * buffers; /* a worker's each */
} loading;

/* The rows of a treelet that are its own: the nodes of its far faces belong to the next, or to the
 * last. */
static void copy_samples(const loading *l, uint32_t t, const void *payload) {
    const leaf_payload p = leaf_layout_payload(&l->leaf->layout, t);
    const leaf_layout *layout = &l->leaf->layout;
    const uint32_t h = layout->halo, *dims = l->field->dims;
    uint32_t base[3], own[3];
    for (int a = 0; a < 3; a++) {
        base[a] = layout->place[t][a] << layout->cells_log2;
        own[a] = p.cells[a] + (base[a] + p.cells[a] + 1 == dims[a]);
    }
    const char *samples = (const char *)payload + p.samples_at;
    for (uint32_t z = 0; z < own[2]; z++)
        for (uint32_t y = 0; y < own[1]; y++) {
            const size_t from = h + p.samples[0] * (y + h + (size_t)p.samples[1] * (z + h));
            float *to =
                l->field->samples + peer_field_at(l->field, base[0], base[1] + y, base[2] + z);
            for (uint32_t x = 0; x < own[0]; x++)
                to[x] = sample_get(layout->type, samples, from + x);
        }
}

static status load_treelet(void *ctx, size_t index, int worker) {
    const loading *l = ctx;
    const uint32_t t = l->leaf->layout.level[0].first + (uint32_t)index;
    struct buffers *b = &l->buffers[worker];
    status st = leaf_file_load(l->leaf, t, b->unpacker, b->payload);
    if (st == ST_OK)
        copy_samples(l, t, b->payload);
    return st;
}

static status make_buffers(mem *m, loading *l, int workers) {
    const size_t bytes = leaf_layout_payload_max(&l->leaf->layout);
    l->buffers = mem_array(m, (size_t)workers, sizeof *l->buffers);
    if (!l->buffers)
        return ST_NOMEM;
    for (int i = 0; i < workers; i++) {
        l->buffers[i].payload = mem_alloc(m, bytes);
        const status st = l->buffers[i].payload
                              ? leaf_unpacker_create(m, l->leaf, &l->buffers[i].unpacker)
                              : ST_NOMEM;
        if (st != ST_OK)
            return st;
    }
    return ST_OK;
}

static void release_buffers(mem *m, loading *l, int workers) {
    for (int i = 0; l->buffers && i < workers; i++) {
        leaf_unpacker_destroy(l->buffers[i].unpacker);
        mem_free(m, l->buffers[i].payload);
    }
    mem_free(m, l->buffers);
}

static status make_arrays(peer_field *f, const leaf_file *leaf) {
    size_t count = 1;
    for (int a = 0; a < 3; a++) {
        f->dims[a] = leaf->header.dims[a];
        count *= f->dims[a];
        f->axis[a] = mem_array(f->m, f->dims[a], sizeof *f->axis[a]);
        if (!f->axis[a])
            return ST_NOMEM;
        memcpy(f->axis[a], leaf->axis[a], f->dims[a] * sizeof *f->axis[a]);
    }
    affine_init(&f->space, leaf->header.to_world);
    f->samples = mem_array(f->m, count, sizeof *f->samples);
    return f->samples ? ST_OK : ST_NOMEM;
}

status peer_field_load(mem *m, const char *path, pool *threads, peer_field *field) {
    loading l = {.field = field};
    *field = (peer_field){.m = m};
    status st = leaf_file_open(m, path, &l.leaf);
    if (st == ST_OK && l.leaf->header.non_finite > 0)
        st = status_describe(ST_UNSUPPORTED, "%s: a sample is not finite: no mesh to compare with",
                             path);
    if (st == ST_OK)
        st = make_arrays(field, l.leaf);
    if (st == ST_OK)
        st = make_buffers(m, &l, pool_threads(threads));
    if (st == ST_OK)
        st = pool_run(threads, l.leaf->layout.level[0].count, load_treelet, &l);
    release_buffers(m, &l, pool_threads(threads));
    leaf_file_close(l.leaf);
    return st;
}

void peer_field_release(peer_field *f) {
    for (int a = 0; a < 3; a++)
        mem_free(f->m, f->axis[a]);
    mem_free(f->m, f->samples);
    *f = (peer_field){0};
}
