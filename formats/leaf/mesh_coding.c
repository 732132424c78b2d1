#include "formats/leaf/mesh_coding.h"

#include <zstd.h>

struct mesh_coding {
    mem *m;
    ZSTD_CCtx *zstd;
    uint8_t *streams;
    void *scratch;
    size_t room;
    int level;
};

size_t mesh_coding_room(const uint32_t counts[4]) {
    size_t most = 0;
    for (int block = MESH_BLOCK_TOPOLOGY; block <= MESH_BLOCK_POSITIONS; block++) {
        const size_t room = mesh_coder_room((mesh_block)block, counts);
        most = room > most ? room : most;
    }
    return most;
}

size_t mesh_coding_memory(const uint32_t counts[4]) {
    return sizeof(mesh_coding) + mesh_coding_room(counts) +
           mesh_coder_scratch(MESH_BLOCK_TOPOLOGY, counts) + 256;
}

size_t mesh_coding_outside(const mesh_coding *c) {
    return ZSTD_sizeof_CCtx(c->zstd);
}

status mesh_coding_create(mem *m, const uint32_t counts[4], int level, mesh_coding **out) {
    *out = NULL;
    mesh_coding *c = mem_zalloc(m, sizeof *c);
    if (!c)
        return ST_NOMEM;
    c->m = m;
    c->level = level;
    c->room = mesh_coding_room(counts);
    c->streams = mem_alloc(m, c->room);
    c->scratch = mem_alloc(m, mesh_coder_scratch(MESH_BLOCK_TOPOLOGY, counts));
    status st = c->streams && c->scratch ? ST_OK : ST_NOMEM;
    if (st == ST_OK && !(c->zstd = ZSTD_createCCtx()))
        st = status_describe(ST_NOMEM, "no room for a compressor");
    if (st != ST_OK) {
        mesh_coding_destroy(c);
        return st;
    }
    *out = c;
    return ST_OK;
}

void mesh_coding_destroy(mesh_coding *c) {
    if (!c)
        return;
    ZSTD_freeCCtx(c->zstd);
    mem_free(c->m, c->streams);
    mem_free(c->m, c->scratch);
    mem_free(c->m, c);
}

/* Compress streams into one frame, each in blocks of its own. Returns its bytes; 0: more than room.
 */
static size_t compress(const mesh_coding *c, const coded_streams *s, void *to, size_t room) {
    ZSTD_outBuffer out = {.dst = to, .size = room};
    (void)ZSTD_CCtx_reset(c->zstd, ZSTD_reset_session_only);
    (void)ZSTD_CCtx_setParameter(c->zstd, ZSTD_c_compressionLevel, c->level);
    for (uint32_t i = 0; i < s->count; i++) {
        const size_t from = i ? s->end[i - 1] : 0;
        const bool last = i + 1 == s->count;
        ZSTD_inBuffer in = {.src = s->bytes + from, .size = s->end[i] - from};
        /* With all of the room taken and something left, it would never end. */
        const size_t left =
            ZSTD_compressStream2(c->zstd, &out, &in, last ? ZSTD_e_end : ZSTD_e_flush);
        if (left != 0)
            return 0;
    }
    return out.pos;
}

size_t mesh_coding_pack(mesh_coding *c, mesh_block block, const uint32_t counts[4],
                        const float bounds[6], const void *payload, void *pack) {
    coded_streams s = {.bytes = c->streams, .room = c->room};
    mesh_coder_encode(block, counts, bounds, payload, c->scratch, &s);
    return compress(c, &s, pack, mesh_coder_bytes(block, counts) - 1);
}
