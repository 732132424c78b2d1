#include "formats/leaf_writer.h"

#include <assert.h>
#include <math.h>
#include <stdatomic.h>
#include <string.h>
#include <zstd.h>

#include "formats/base/file.h"
#include "formats/base/hash.h"
#include "formats/leaf_check.h"

struct leaf_writer {
    mem *m;
    leaf_parameters p;
    leaf_layout layout;
    leaf_header header;
    leaf_section table[LEAF_SECTION_AXES];
    /* The directory, an element a treelet. */
    float (*ranges)[2];
    float (*own)[2];
    uint8_t *flags;
    uint64_t *offsets, *sizes, *checksums;
    double *axes; /* rectilinear: all three, one after the other */
    out_file *out;
    /* Compressed payloads wait here until all sizes are known. */
    out_file *scratch;
    uint64_t *scratch_at;
    atomic_ullong scratch_end;
    void *copy_buffer;
};

struct leaf_packer {
    ZSTD_CCtx *context;
    int level;
};

leaf_parameters leaf_parameters_default(void) {
    return (leaf_parameters){
        .cells_log2 = 5, .halo = 1, .run_align_log2 = 12, .codec = LEAF_CODEC_RAW};
}

uint64_t leaf_writer_memory(const leaf_layout *l, leaf_codec codec) {
    const uint64_t place = 3 * sizeof(uint32_t) + sizeof(uint32_t) + 1; /* of leaf_layout */
    uint64_t each = 2 * sizeof(float[2]) + 1 + 3 * sizeof(uint64_t) + place;
    uint64_t bytes = sizeof(leaf_writer) + 4096;
    if (codec != LEAF_CODEC_RAW) {
        each += sizeof(uint64_t);
        bytes += leaf_layout_payload_max(l);
    }
    for (int a = 0; a < 3; a++)
        bytes += l->level[0].dims[a] * sizeof(double);
    return bytes + l->treelets * each;
}

/* ---- creating ---- */

static void fill_header(leaf_writer *w, const grid *g) {
    leaf_header *h = &w->header;
    memcpy(h->magic, LEAF_MAGIC, sizeof h->magic);
    h->version = LEAF_VERSION;
    h->kind = LEAF_KIND_GRID;
    h->sample_type = w->layout.type;
    h->source_type = g->type;
    memcpy(h->dims, g->dims, sizeof h->dims);
    h->levels = w->layout.levels;
    h->cells_log2 = w->p.cells_log2;
    h->halo = w->p.halo;
    h->block_log2 = LEAF_BLOCK_LOG2;
    h->run_align_log2 = w->p.run_align_log2;
    h->codec = w->p.codec;
    h->rectilinear = grid_is_rectilinear(g);
    h->fields = 1;
    h->steps = 1;
    h->sections = h->rectilinear ? LEAF_SECTION_AXES : LEAF_SECTION_AXES - 1;
    h->treelets = w->layout.treelets;
    memcpy(h->to_world, g->to_world, sizeof h->to_world);
    size_t length = strnlen(g->name, sizeof h->name - 1);
    memcpy(h->name, g->name, length);
}

/* Where the sections go; their sizes are known from the start. Returns where they end. */
static uint64_t place_sections(leaf_writer *w) {
    uint64_t end = LEAF_HEADER_BYTES + w->header.sections * sizeof *w->table;
    for (uint32_t kind = 1; kind <= w->header.sections; kind++) {
        leaf_section *s = &w->table[kind - 1];
        s->kind = kind;
        s->version = 1;
        s->offset = leaf_layout_aligned(end, LEAF_ALIGN_LOG2);
        s->bytes = leaf_section_bytes(&w->header, kind);
        end = s->offset + s->bytes;
    }
    return end;
}

/* With all sizes known, the payloads' places. */
static void place_payloads(leaf_writer *w) {
    const leaf_section *last = &w->table[w->header.sections - 1];
    uint64_t end = last->offset + last->bytes;
    w->header.payload_bytes = 0;
    for (uint32_t t = 0; t < w->layout.treelets; t++) {
        w->offsets[t] = leaf_layout_payload_at(&w->layout, t, end, w->p.run_align_log2);
        end = w->offsets[t] + w->sizes[t];
        w->header.payload_bytes += w->sizes[t];
    }
    w->header.file_bytes = leaf_layout_aligned(end, w->p.run_align_log2);
}

static status allocate(leaf_writer *w, const grid *g) {
    size_t n = w->layout.treelets;
    w->ranges = mem_array(w->m, n, sizeof *w->ranges);
    w->own = mem_array(w->m, n, sizeof *w->own);
    w->flags = mem_array(w->m, n, sizeof *w->flags);
    w->offsets = mem_array(w->m, n, sizeof *w->offsets);
    w->sizes = mem_array(w->m, n, sizeof *w->sizes);
    w->checksums = mem_array(w->m, n, sizeof *w->checksums);
    if (!w->ranges || !w->own || !w->flags || !w->offsets || !w->sizes || !w->checksums)
        return ST_NOMEM;
    if (w->p.codec != LEAF_CODEC_RAW) {
        w->scratch_at = mem_array(w->m, n, sizeof *w->scratch_at);
        w->copy_buffer = mem_alloc(w->m, leaf_layout_payload_max(&w->layout));
        if (!w->scratch_at || !w->copy_buffer)
            return ST_NOMEM;
    }
    if (grid_is_rectilinear(g)) {
        size_t nodes = (size_t)g->dims[0] + g->dims[1] + g->dims[2];
        w->axes = mem_array(w->m, nodes, sizeof *w->axes);
        if (!w->axes)
            return ST_NOMEM;
        double *to = w->axes;
        for (int a = 0; a < 3; to += g->dims[a++])
            memcpy(to, g->axis[a], g->dims[a] * sizeof *to);
    }
    return ST_OK;
}

status leaf_writer_create(mem *m, const char *path, bool force, const grid *g,
                          const leaf_parameters *p, leaf_writer **out) {
    leaf_writer *w = mem_zalloc(m, sizeof *w);
    if (!w)
        return ST_NOMEM;
    w->m = m;
    w->p = *p;
    status st =
        leaf_layout_init(&w->layout, m, g->dims, p->cells_log2, p->halo, sample_stored(g->type));
    if (st == ST_OK)
        st = allocate(w, g);
    if (st == ST_OK)
        st = out_file_create(m, path, force, &w->out);
    if (st == ST_OK && p->codec != LEAF_CODEC_RAW)
        st = out_file_scratch(m, path, &w->scratch);
    if (st != ST_OK) {
        leaf_writer_discard(w);
        return st;
    }
    fill_header(w, g);
    place_sections(w);
    if (p->codec == LEAF_CODEC_RAW) {
        for (uint32_t t = 0; t < w->layout.treelets; t++)
            w->sizes[t] = leaf_layout_payload(&w->layout, t).bytes;
        place_payloads(w);
    }
    *out = w;
    return ST_OK;
}

void leaf_writer_discard(leaf_writer *w) {
    if (!w)
        return;
    out_file_discard(w->out);
    out_file_discard(w->scratch);
    leaf_layout_release(&w->layout);
    mem_free(w->m, w->ranges);
    mem_free(w->m, w->own);
    mem_free(w->m, w->flags);
    mem_free(w->m, w->offsets);
    mem_free(w->m, w->sizes);
    mem_free(w->m, w->checksums);
    mem_free(w->m, w->scratch_at);
    mem_free(w->m, w->copy_buffer);
    mem_free(w->m, w->axes);
    mem_free(w->m, w);
}

const leaf_layout *leaf_writer_layout(const leaf_writer *w) {
    return &w->layout;
}

/* ---- payloads ---- */

size_t leaf_writer_pack_bytes(const leaf_layout *l, leaf_codec codec) {
    return codec == LEAF_CODEC_RAW ? 0 : leaf_layout_payload_max(l);
}

static ZSTD_CCtx *new_context(void) {
    ZSTD_CCtx *context = ZSTD_createCCtx();
    if (!context)
        (void)status_describe(ST_NOMEM, "no room for a compressor");
    return context;
}

status leaf_packer_create(const leaf_writer *w, leaf_packer **out) {
    *out = NULL;
    if (w->p.codec == LEAF_CODEC_RAW)
        return ST_OK;
    leaf_packer *k = mem_zalloc(w->m, sizeof *k);
    if (!k)
        return ST_NOMEM;
    k->level = w->p.zstd_level;
    k->context = new_context();
    if (!k->context) {
        mem_free(w->m, k);
        return ST_NOMEM;
    }
    *out = k;
    return ST_OK;
}

void leaf_packer_destroy(const leaf_writer *w, leaf_packer *k) {
    if (!k)
        return;
    ZSTD_freeCCtx(k->context);
    mem_free(w->m, k);
}

/* zstd tells the size of a context that has done the work, not beforehand; so let one do it. */
status leaf_packer_memory(mem *m, const leaf_layout *l, const leaf_parameters *p, uint64_t *out) {
    *out = 0;
    if (p->codec == LEAF_CODEC_RAW)
        return ST_OK;
    size_t bytes = leaf_layout_payload_max(l);
    char *sample = mem_zalloc(m, 2 * bytes);
    if (!sample)
        return ST_NOMEM;
    ZSTD_CCtx *context = new_context();
    if (context) {
        (void)ZSTD_compressCCtx(context, sample + bytes, bytes - 1, sample, bytes, p->zstd_level);
        *out = ZSTD_sizeof_CCtx(context);
    }
    ZSTD_freeCCtx(context);
    mem_free(m, sample);
    return context ? ST_OK : ST_NOMEM;
}

/* Compress where that makes it smaller; `stored` becomes the packed bytes or the payload itself. */
static size_t pack_payload(leaf_packer *k, const void *payload, size_t bytes, void *pack,
                           const void **stored) {
    size_t size = ZSTD_compressCCtx(k->context, pack, bytes - 1, payload, bytes, k->level);
    *stored = ZSTD_isError(size) ? payload : pack;
    return ZSTD_isError(size) ? bytes : size;
}

status leaf_writer_put(leaf_writer *w, leaf_packer *k, uint32_t t, const leaf_entry *entry,
                       const void *payload, void *pack) {
    assert(t < w->layout.treelets);
    const void *stored = payload;
    size_t size = leaf_layout_payload(&w->layout, t).bytes;
    if (k)
        size = pack_payload(k, payload, size, pack, &stored);
    memcpy(w->own[t], entry->own, sizeof entry->own);
    w->flags[t] = entry->flags;
    w->sizes[t] = size;
    w->checksums[t] = hash_bytes(stored, size);
    if (!k)
        return out_file_write_at(w->out, w->offsets[t], stored, size);
    w->scratch_at[t] = atomic_fetch_add(&w->scratch_end, size);
    return out_file_write_at(w->scratch, w->scratch_at[t], stored, size);
}

/* ---- finishing ---- */

static status copy_payloads(leaf_writer *w) {
    place_payloads(w);
    for (uint32_t t = 0; t < w->layout.treelets; t++) {
        size_t size = (size_t)w->sizes[t];
        status st = out_file_read_at(w->scratch, w->scratch_at[t], w->copy_buffer, size);
        if (st == ST_OK)
            st = out_file_write_at(w->out, w->offsets[t], w->copy_buffer, size);
        if (st != ST_OK)
            return st;
    }
    return ST_OK;
}

/* Children come behind their parents, so the last treelet goes first. */
static void merge_ranges(leaf_writer *w) {
    const leaf_layout *l = &w->layout;
    double lo = (double)INFINITY, hi = -(double)INFINITY;
    for (uint32_t t = l->treelets; t-- > 0;) {
        float *merged = w->ranges[t];
        memcpy(merged, w->own[t], sizeof w->own[t]);
        uint32_t child = l->first_child[t];
        for (int n = __builtin_popcount(leaf_layout_children(l, t)); n > 0; n--, child++) {
            merged[0] = w->ranges[child][0] < merged[0] ? w->ranges[child][0] : merged[0];
            merged[1] = w->ranges[child][1] > merged[1] ? w->ranges[child][1] : merged[1];
        }
        if (l->level_of[t] == 0) {
            lo = fmin(lo, (double)w->own[t][0]);
            hi = fmax(hi, (double)w->own[t][1]);
        }
    }
    w->header.value_min = lo;
    w->header.value_max = hi;
}

static status write_sections(leaf_writer *w) {
    const void *arrays[LEAF_SECTION_AXES] = {w->ranges, w->own,       w->flags, w->offsets,
                                             w->sizes,  w->checksums, w->axes};
    for (uint32_t i = 0; i < w->header.sections; i++) {
        leaf_section *s = &w->table[i];
        s->checksum = hash_bytes(arrays[i], (size_t)s->bytes);
        status st = out_file_write_at(w->out, s->offset, arrays[i], (size_t)s->bytes);
        if (st != ST_OK)
            return st;
    }
    return ST_OK;
}

/* Nothing but zeros between the last payload and the end; the gaps before are holes, which read as
 * zeros. */
static status write_end(leaf_writer *w) {
    static const char zeros[512];
    uint32_t last = w->layout.treelets - 1;
    for (uint64_t at = w->offsets[last] + w->sizes[last]; at < w->header.file_bytes;) {
        uint64_t left = w->header.file_bytes - at;
        size_t size = left < sizeof zeros ? (size_t)left : sizeof zeros;
        status st = out_file_write_at(w->out, at, zeros, size);
        if (st != ST_OK)
            return st;
        at += size;
    }
    return ST_OK;
}

static status write_header(leaf_writer *w, const leaf_facts *facts) {
    leaf_header *h = &w->header;
    h->non_finite = facts->non_finite;
    h->rounding_error = facts->rounding_error;
    memcpy(h->provenance, facts->provenance, strnlen(facts->provenance, sizeof h->provenance - 1));
    hash_id id = leaf_header_id(h, w->table);
    h->id[0] = id.lo;
    h->id[1] = id.hi;
    h->checksum = leaf_header_checksum(h);
    status st =
        out_file_write_at(w->out, LEAF_HEADER_BYTES, w->table, h->sections * sizeof *w->table);
    return st == ST_OK ? out_file_write_at(w->out, 0, h, sizeof *h) : st;
}

status leaf_writer_finish(leaf_writer *w, const leaf_facts *facts, leaf_header *header) {
    status st = w->p.codec == LEAF_CODEC_RAW ? ST_OK : copy_payloads(w);
    if (st == ST_OK) {
        merge_ranges(w);
        st = write_sections(w);
    }
    if (st == ST_OK)
        st = write_end(w);
    if (st == ST_OK)
        st = write_header(w, facts);
    if (st == ST_OK) {
        if (header)
            *header = w->header;
        st = out_file_commit(w->out);
        w->out = NULL;
    }
    leaf_writer_discard(w);
    return st;
}
