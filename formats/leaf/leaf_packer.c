#include "formats/leaf/leaf_packer.h"

#include <zstd.h>

struct leaf_packer {
    ZSTD_CCtx *context;
    int level;
};

leaf_parameters leaf_parameters_default(void) {
    return (leaf_parameters){
        .cells_log2 = 5, .halo = 1, .run_align_log2 = 12, .codec = LEAF_CODEC_RAW};
}

static ZSTD_CCtx *new_context(void) {
    ZSTD_CCtx *context = ZSTD_createCCtx();
    if (!context)
        (void)status_describe(ST_NOMEM, "no room for a compressor");
    return context;
}

status leaf_packer_create(mem *m, const leaf_parameters *p, leaf_packer **out) {
    *out = NULL;
    if (p->codec == LEAF_CODEC_RAW)
        return ST_OK;
    leaf_packer *k = mem_zalloc(m, sizeof *k);
    if (!k)
        return ST_NOMEM;
    k->level = p->zstd_level;
    k->context = new_context();
    if (!k->context) {
        mem_free(m, k);
        return ST_NOMEM;
    }
    *out = k;
    return ST_OK;
}

void leaf_packer_destroy(mem *m, leaf_packer *k) {
    if (!k)
        return;
    ZSTD_freeCCtx(k->context);
    mem_free(m, k);
}

/* zstd tells a context's size only after it has compressed something. So compress a payload of
 * zeros. */
status leaf_packer_memory(mem *m, size_t payload_max, const leaf_parameters *p, uint64_t *out) {
    *out = 0;
    if (p->codec == LEAF_CODEC_RAW)
        return ST_OK;
    const size_t bytes = payload_max;
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

size_t leaf_packer_pack(leaf_packer *k, const void *payload, size_t bytes, void *pack,
                        const void **stored) {
    size_t size = ZSTD_compressCCtx(k->context, pack, bytes - 1, payload, bytes, k->level);
    *stored = ZSTD_isError(size) ? payload : pack;
    return ZSTD_isError(size) ? bytes : size;
}
