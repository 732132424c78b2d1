#include "prep/import/packed_slices.h"

#include <assert.h>

static const uint64_t slab_least = (uint64_t)4 << 20; /* a slab takes several chunks if they are
                                                         shallow */

static uint64_t at_most(uint64_t a, uint64_t b) {
    return a < b ? a : b;
}

static uint32_t slab_depth(const packed_slices *s) {
    const uint64_t room = s->m->limit / 2 / s->slice_bytes;
    uint64_t depth = at_most(s->chunk_depth ? s->chunk_depth : 1, s->dims[2]);
    for (uint64_t parts = 2; depth > 1 && depth > room; parts++)
        depth = (s->chunk_depth + parts - 1) / parts;
    const uint64_t several = slab_least / (depth * s->slice_bytes);
    if (several > 1 && several * depth <= room)
        depth *= several;
    return (uint32_t)at_most(depth, s->dims[2]);
}

status packed_slices_begin(packed_slices *s) {
    assert(s->m->limit);
    if (s->chunk_bytes > s->m->limit / 4)
        return status_describe(ST_NOMEM,
                               "%s: %s: a chunk has %.1f MiB: --memory of at least four times that "
                               "is needed",
                               s->file, s->field, (double)s->chunk_bytes / 0x1p20);
    s->slice_bytes = (uint64_t)s->dims[0] * s->dims[1] * packed_bytes(&s->packed);
    s->depth = slab_depth(s);
    s->slab = mem_alloc(s->m, s->depth * s->slice_bytes);
    return s->slab ? ST_OK : ST_NOMEM;
}

void packed_slices_end(packed_slices *s) {
    if (s->slab)
        mem_free(s->m, s->slab);
    if (s->scales)
        mem_free(s->m, s->scales);
    s->slab = NULL;
    s->scales = NULL;
}

/* If a chunk needs several slabs, end the slab with the chunk. */
static uint32_t slab_end(const packed_slices *s, uint32_t first) {
    const uint64_t deep = s->chunk_depth;
    const uint64_t end = at_most((uint64_t)first + s->depth, s->dims[2]);
    return (uint32_t)(deep > s->depth ? at_most(end, (first / deep + 1) * deep) : end);
}

static status load(packed_slices *s, uint32_t first) {
    const uint32_t count = slab_end(s, first) - first;
    status st = s->load(s->ctx, first, count, s->slab);
    s->slab_first = first;
    s->slab_count = st == ST_OK ? count : 0;
    return st;
}

status packed_slices_read(packed_slices *s, uint32_t first, uint32_t count, void *slices) {
    const uint64_t samples = (uint64_t)s->dims[0] * s->dims[1];
    const size_t width = sample_size(packed_type(&s->packed));
    char *out = slices;
    for (uint32_t z = first, n; z < first + count; z += n) {
        status st = z < s->slab_first + s->slab_count ? ST_OK : load(s, z);
        if (st != ST_OK)
            return st;
        n = (uint32_t)at_most(first + count, s->slab_first + s->slab_count) - z;
        if (s->scales) {
            n = 1;
            s->packed.scale = s->scales[2 * (size_t)z];
            s->packed.offset = s->scales[2 * (size_t)z + 1];
        }
        const char *in = (char *)s->slab + (z - s->slab_first) * s->slice_bytes;
        const size_t bad = packed_unpack(&s->packed, in, out, n * samples);
        if (bad < n * samples)
            return packed_inexact(s->file, s->field, z, samples, bad);
        out += n * samples * width;
    }
    return ST_OK;
}
