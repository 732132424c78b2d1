#include "formats/leaf/leaf_packer.h"

#include <zstd.h>

#include "formats/leaf/grid_coding.h"

struct leaf_packer {
    const leaf_layout *layout;
    box_coder *boxes;  /* of a grid */
    mesh_coding *mesh; /* of a mesh */
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

status leaf_packer_create(mem *m, const leaf_layout *l, const uint32_t counts[4],
                          const leaf_parameters *p, leaf_packer **out) {
    const int level = p->zstd_level ? p->zstd_level : ZSTD_CLEVEL_DEFAULT;
    *out = NULL;
    if (p->codec == LEAF_CODEC_RAW)
        return ST_OK;
    leaf_packer *k = mem_zalloc(m, sizeof *k);
    if (!k)
        return ST_NOMEM;
    k->layout = l;
    const status st = counts
                          ? mesh_coding_create(m, counts, level, &k->mesh)
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
    mesh_coding_destroy(k->mesh);
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

static uint64_t mesh_memory(leaf_packer *k, const uint32_t counts[4], char *zeros) {
    const float bounds[6] = {0};
    (void)mesh_coding_pack(k->mesh, MESH_BLOCK_TOPOLOGY, counts, bounds, zeros,
                           zeros + mesh_coder_bytes(MESH_BLOCK_TOPOLOGY, counts));
    return mesh_coding_outside(k->mesh) + mesh_coding_memory(counts);
}

status leaf_packer_memory(mem *m, const leaf_layout *l, const uint32_t counts[4],
                          const leaf_parameters *p, uint64_t *out) {
    leaf_packer *k = NULL;
    *out = 0;
    if (p->codec == LEAF_CODEC_RAW)
        return ST_OK;
    status st = leaf_packer_create(m, l, counts, p, &k);
    const size_t bytes =
        counts ? mesh_coder_bytes(MESH_BLOCK_TOPOLOGY, counts) : leaf_layout_stored_max(l);
    char *room = st == ST_OK ? mem_zalloc(m, 2 * bytes) : NULL;
    if (room)
        *out = counts ? mesh_memory(k, counts, room) : grid_memory(k, room);
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

size_t leaf_packer_pack_mesh(leaf_packer *k, mesh_block block, const uint32_t counts[4],
                             const float bounds[6], const void *payload, void *pack,
                             const void **stored) {
    const size_t size = mesh_coding_pack(k->mesh, block, counts, bounds, payload, pack);
    *stored = size ? pack : payload;
    return size ? size : mesh_coder_bytes(block, counts);
}
