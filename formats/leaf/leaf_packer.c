#include "formats/leaf/leaf_packer.h"

#include <zstd.h>

#include "formats/leaf/grid_coding.h"
#include "formats/leaf/stream_coding.h"

struct leaf_packer {
    const leaf_layout *layout;
    box_coder *boxes;        /* of a grid */
    const leaf_coder *coder; /* of others, and: */
    stream_coding *streams;
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

status leaf_packer_create(mem *m, const leaf_layout *l, const leaf_coder *coder,
                          const uint32_t counts[4], const leaf_parameters *p, leaf_packer **out) {
    const int level = p->zstd_level ? p->zstd_level : ZSTD_CLEVEL_DEFAULT;
    *out = NULL;
    if (p->codec == LEAF_CODEC_RAW)
        return ST_OK;
    leaf_packer *k = mem_zalloc(m, sizeof *k);
    if (!k)
        return ST_NOMEM;
    k->layout = l;
    k->coder = coder;
    const status st = coder
                          ? stream_coding_create(m, coder, counts, level, &k->streams)
                          : box_coder_create(m, l->type, leaf_layout_code_max(l), level, &k->boxes);
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
    stream_coding_destroy(k->streams);
    box_coder_destroy(k->boxes);
    mem_free(m, k);
}

/* zstd tells a context's size only after it has compressed something. Here that is noise: streams
 * as long as they can be. */
static uint64_t grid_memory(leaf_packer *k, char *noise) {
    const leaf_layout *l = k->layout;
    const uint32_t samples = (uint32_t)leaf_layout_code_max(l), rows = samples / BOX_ROW_MAX;
    const coded_box box = {{BOX_ROW_MAX, rows, 1}, {1, BOX_ROW_MAX, BOX_ROW_MAX * rows}, noise};
    uint32_t next = 1;
    for (size_t i = 0; i < samples * sample_size(l->type); i++) {
        next = next * 1664525U + 1013904223U;
        noise[i] = (char)(next >> 24);
    }
    (void)box_coder_encode(k->boxes, &box, 1, noise + leaf_layout_stored_max(l));
    return box_coder_outside(k->boxes) + box_coder_memory(l->type, samples);
}

static uint64_t streams_memory(leaf_packer *k, const uint32_t counts[4], char *zeros) {
    const float bounds[6] = {0};
    (void)stream_coding_pack(k->streams, LEAF_BLOCK_TOPOLOGY, counts, bounds, zeros,
                             zeros + k->coder->bytes(LEAF_BLOCK_TOPOLOGY, counts));
    return stream_coding_outside(k->streams) + stream_coding_memory(k->coder, counts);
}

status leaf_packer_memory(mem *m, const leaf_layout *l, const leaf_coder *coder,
                          const uint32_t counts[4], const leaf_parameters *p, uint64_t *out) {
    leaf_packer *k = NULL;
    *out = 0;
    if (p->codec == LEAF_CODEC_RAW)
        return ST_OK;
    status st = leaf_packer_create(m, l, coder, counts, p, &k);
    const size_t bytes =
        coder ? coder->bytes(LEAF_BLOCK_TOPOLOGY, counts) : leaf_layout_stored_max(l);
    char *room = st == ST_OK ? mem_zalloc(m, 2 * bytes) : NULL;
    if (room)
        *out = coder ? streams_memory(k, counts, room) : grid_memory(k, room);
    else if (st == ST_OK)
        st = ST_NOMEM;
    leaf_packer_destroy(m, k);
    mem_free(m, room);
    return st;
}

size_t leaf_packer_pack(leaf_packer *k, uint32_t p, const void *payload, void *pack) {
    return grid_coding_pack(k->layout, p, k->boxes, payload, pack);
}

box_coder *leaf_packer_boxes(leaf_packer *k) {
    return k->boxes;
}

size_t leaf_packer_pack_streams(leaf_packer *k, leaf_block block, const uint32_t counts[4],
                                const float bounds[6], const void *payload, void *pack,
                                const void **stored) {
    const size_t size = stream_coding_pack(k->streams, block, counts, bounds, payload, pack);
    *stored = size ? pack : payload;
    return size ? size : k->coder->bytes(block, counts);
}
