#include "formats/leaf/leaf_packer.h"

#include <zstd.h>

#include "formats/leaf/grid_coding.h"

struct leaf_packer {
    const leaf_layout *layout;
    ZSTD_CCtx *context;
    box_coder *boxes; /* of a grid */
    int level;
};

leaf_parameters leaf_parameters_default(void) {
    return (leaf_parameters){
        .cells_log2 = 5, .halo = 1, .run_align_log2 = 12, .codec = LEAF_CODEC_RAW};
}

void leaf_parameters_compress(leaf_parameters *p, int level) {
    p->codec = LEAF_CODEC_ZSTD;
    p->zstd_level = level;
    p->run_align_log2 = LEAF_ALIGN_LOG2;
}

static status begin(mem *m, leaf_packer *k) {
    const leaf_layout *l = k->layout;
    if (l && l->coded)
        return box_coder_create(m, l->type, leaf_layout_code_max(l), k->level, &k->boxes);
    k->context = ZSTD_createCCtx();
    return k->context ? ST_OK : status_describe(ST_NOMEM, "no room for a compressor");
}

status leaf_packer_create(mem *m, const leaf_layout *l, const leaf_parameters *p,
                          leaf_packer **out) {
    *out = NULL;
    if (p->codec == LEAF_CODEC_RAW)
        return ST_OK;
    leaf_packer *k = mem_zalloc(m, sizeof *k);
    if (!k)
        return ST_NOMEM;
    k->layout = l;
    k->level = p->zstd_level ? p->zstd_level : ZSTD_CLEVEL_DEFAULT;
    const status st = begin(m, k);
    if (st != ST_OK) {
        mem_free(m, k);
        return st;
    }
    *out = k;
    return ST_OK;
}

void leaf_packer_destroy(mem *m, leaf_packer *k) {
    if (!k)
        return;
    ZSTD_freeCCtx(k->context);
    box_coder_destroy(k->boxes);
    mem_free(m, k);
}

/* zstd tells a context's size only after it has compressed something. So compress a payload of
 * zeros. */
static uint64_t memory_of(leaf_packer *k, char *sample, size_t bytes) {
    const leaf_layout *l = k->layout;
    if (!l || !l->coded) {
        (void)ZSTD_compressCCtx(k->context, sample + bytes, bytes - 1, sample, bytes, k->level);
        return ZSTD_sizeof_CCtx(k->context);
    }
    const uint32_t samples = (uint32_t)leaf_layout_code_max(l), rows = samples / BOX_ROW_MAX;
    const coded_box box = {{BOX_ROW_MAX, rows, 1}, {1, BOX_ROW_MAX, BOX_ROW_MAX * rows}, sample};
    (void)box_coder_encode(k->boxes, &box, 1, sample + bytes);
    return box_coder_outside(k->boxes) + box_coder_memory(l->type, samples);
}

status leaf_packer_memory(mem *m, const leaf_layout *l, size_t payload_max,
                          const leaf_parameters *p, uint64_t *out) {
    leaf_packer *k = NULL;
    *out = 0;
    if (p->codec == LEAF_CODEC_RAW)
        return ST_OK;
    status st = leaf_packer_create(m, l, p, &k);
    char *sample = st == ST_OK ? mem_zalloc(m, 2 * payload_max) : NULL;
    if (sample)
        *out = memory_of(k, sample, payload_max);
    else if (st == ST_OK)
        st = ST_NOMEM;
    leaf_packer_destroy(m, k);
    mem_free(m, sample);
    return st;
}

size_t leaf_packer_pack(leaf_packer *k, uint32_t p, const void *payload, size_t bytes, void *pack,
                        const void **stored) {
    if (k->boxes) {
        *stored = pack;
        return grid_coding_pack(k->layout, p, k->boxes, payload, pack);
    }
    const size_t size = ZSTD_compressCCtx(k->context, pack, bytes - 1, payload, bytes, k->level);
    *stored = ZSTD_isError(size) ? payload : pack;
    return ZSTD_isError(size) ? bytes : size;
}
