#include "formats/leaf/stream_coding.h"

#include <zstd.h>

struct stream_coding {
    mem *m;
    const leaf_coder *coder;
    ZSTD_CCtx *zstd;
    uint8_t *streams;
    void *scratch;
    size_t room;
    int level;
};

size_t stream_coding_room(const leaf_coder *coder, const uint32_t counts[4]) {
    size_t most = 0;
    for (int block = LEAF_BLOCK_TOPOLOGY; block <= LEAF_BLOCK_POSITIONS; block++) {
        const size_t room = coder->room((leaf_block)block, counts);
        most = room > most ? room : most;
    }
    return most;
}

size_t stream_coding_memory(const leaf_coder *coder, const uint32_t counts[4]) {
    return sizeof(stream_coding) + stream_coding_room(coder, counts) + coder->scratch(counts) + 256;
}

size_t stream_coding_outside(const stream_coding *c) {
    return ZSTD_sizeof_CCtx(c->zstd);
}

status stream_coding_create(mem *m, const leaf_coder *coder, const uint32_t counts[4], int level,
                            stream_coding **out) {
    *out = NULL;
    stream_coding *c = mem_zalloc(m, sizeof *c);
    if (!c)
        return ST_NOMEM;
    c->m = m;
    c->coder = coder;
    c->level = level;
    c->room = stream_coding_room(coder, counts);
    c->streams = mem_alloc(m, c->room);
    c->scratch = mem_alloc(m, coder->scratch(counts) + 1);
    status st = c->streams && c->scratch ? ST_OK : ST_NOMEM;
    if (st == ST_OK && !(c->zstd = ZSTD_createCCtx()))
        st = status_describe(ST_NOMEM, "no room for a compressor");
    if (st != ST_OK) {
        stream_coding_destroy(c);
        return st;
    }
    *out = c;
    return ST_OK;
}

void stream_coding_destroy(stream_coding *c) {
    if (!c)
        return;
    ZSTD_freeCCtx(c->zstd);
    mem_free(c->m, c->streams);
    mem_free(c->m, c->scratch);
    mem_free(c->m, c);
}

/* Compress streams into one frame, each in blocks of its own. Returns its bytes; 0: more than room.
 */
static size_t compress(const stream_coding *c, const coded_streams *s, void *to, size_t room) {
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

size_t stream_coding_pack(stream_coding *c, leaf_block block, const uint32_t counts[4],
                          const float bounds[6], const void *payload, void *pack) {
    coded_streams s = {.bytes = c->streams, .room = c->room};
    c->coder->encode(block, counts, bounds, payload, c->scratch, &s);
    return compress(c, &s, pack, c->coder->bytes(block, counts) - 1);
}
