/* leaf_writer_directory.c - the sections of a treelet file. Those of one set lie before the
 * payloads, and their sizes are known from the start; those of several sets lie behind, and are
 * compressed: sets are much alike.
 */
#include <string.h>

#include <zstd.h>

#include "formats/base/hash.h"
#include "formats/leaf/leaf_check.h"
#include "formats/leaf/leaf_writer_private.h"

/* ---- places ---- */

static bool any(const uint32_t *links, uint32_t count) {
    for (uint32_t p = 0; links && p < count; p++)
        if (links[p])
            return true;
    return false;
}

/* Whether the file has a section of this kind. */
static bool has_section(const leaf_writer *w, uint32_t kind) {
    const uint32_t payloads = w->layout.payloads;
    if (!leaf_section_bytes(&w->header, kind))
        return false;
    return kind == LEAF_SECTION_FIELDS       ? w->names != NULL
           : kind == LEAF_SECTION_TIMES      ? w->times != NULL
           : kind == LEAF_SECTION_COARSE     ? w->parts != NULL
           : kind == LEAF_SECTION_SAME       ? any(w->same, payloads)
           : kind == LEAF_SECTION_BASES      ? any(w->bases, payloads)
           : kind == LEAF_SECTION_HISTOGRAMS ? w->histograms != NULL
           : kind == LEAF_SECTION_DEVIATIONS ? w->deviations != NULL
           : kind == LEAF_SECTION_WORLD      ? world_frame_is_told(&w->frame)
                                             : true;
}

static void add_section(leaf_writer *w, uint32_t kind) {
    leaf_header *h = &w->header;
    if (has_section(w, kind))
        w->table[h->sections++] = (leaf_section){
            .kind = kind, .version = LEAF_SECTION_PLAIN, .bytes = leaf_section_bytes(h, kind)};
}

static void list_sections(leaf_writer *w) {
    w->header.sections = 0;
    for (uint32_t kind = 1; kind <= LEAF_SECTION_LAST; kind++)
        add_section(w, kind);
    for (uint32_t i = 1; i <= LEAF_ANCILLARY_LAST; i++)
        add_section(w, LEAF_SECTION_ANCILLARY | i);
}

/* Whether the directory lies behind the payloads. */
static bool is_behind(const leaf_writer *w) {
    return leaf_is_behind(&w->header);
}

uint64_t leaf_writer_payloads_at(const leaf_writer *w) {
    const leaf_section *last = &w->table[w->header.sections - 1];
    return is_behind(w) ? LEAF_HEADER_BYTES : last->offset + last->bytes;
}

void leaf_writer_place_sections(leaf_writer *w) {
    uint64_t end;
    list_sections(w);
    end = LEAF_HEADER_BYTES + w->header.sections * sizeof *w->table;
    for (uint32_t i = 0; i < w->header.sections; i++) {
        w->table[i].offset = leaf_layout_aligned(end, LEAF_ALIGN_LOG2);
        end = w->table[i].offset + w->table[i].bytes;
    }
    w->next = (leaf_placing){.end = leaf_writer_payloads_at(w)};
}

uint64_t leaf_writer_place(leaf_writer *w, uint32_t p) {
    const leaf_links links = leaf_writer_links(w);
    const uint64_t bytes = leaf_writer_is_same(w, p) ? 0 : w->sizes[p];
    const uint64_t at = leaf_placing_next(&w->next, &w->layout, p, bytes, w->p.run_align_log2);
    w->offsets[p] = at;
    if (leaf_writer_is_same(w, p))
        w->offsets[p] =
            w->same[p] & LEAF_LINK_BEFORE ? 0 : w->offsets[leaf_layout_home(&w->layout, &links, p)];
    return bytes;
}

/* ---- writing ---- */

static const void *bytes_of(const leaf_writer *w, uint32_t kind) {
    const void *arrays[LEAF_SECTION_LAST] = {
        w->ranges,    w->own,      w->flags,  w->offsets, w->sizes,    w->checksums,
        w->axes,      w->bounds,   w->counts, w->names,   w->times,    w->parts,
        w->p.outside, w->p.chunks, w->same,   w->bases,   w->p.slices, w->zones};
    const void *ancillary[LEAF_ANCILLARY_LAST] = {w->histograms, w->deviations, &w->frame};
    return leaf_section_ancillary(kind) ? ancillary[kind - LEAF_SECTION_ANCILLARY - 1]
                                        : arrays[kind - 1];
}

static status write_bytes(leaf_writer *w, leaf_section *s, const void *bytes) {
    s->checksum = hash_bytes(bytes, (size_t)s->bytes);
    return out_file_write_at(w->out, s->offset, bytes, (size_t)s->bytes);
}

static status write_plain(leaf_writer *w, leaf_section *s) {
    return write_bytes(w, s, bytes_of(w, s->kind));
}

/* A section while it is compressed, with a piece of it in memory. */
typedef struct packing {
    ZSTD_CCtx *zstd;
    hash_stream *hash;
    char *piece;
    uint64_t bytes; /* so far */
} packing;

enum { PIECE_BYTES = 64 << 10 };

/* Compress the next piece of the output. *more: whether there is another. */
static status pack_piece(leaf_writer *w, const leaf_section *s, packing *x, ZSTD_inBuffer *in,
                         bool *more) {
    ZSTD_outBuffer out = {x->piece, PIECE_BYTES, 0};
    const size_t left = ZSTD_compressStream2(x->zstd, &out, in, ZSTD_e_end);
    if (ZSTD_isError(left))
        return status_describe(ST_NOMEM, "section %u: %s", s->kind, ZSTD_getErrorName(left));
    *more = left > 0;
    hash_stream_add(x->hash, x->piece, out.pos);
    x->bytes += out.pos;
    if (x->bytes >= s->bytes)
        return ST_OK;
    return out_file_write_at(w->out, s->offset + x->bytes - out.pos, x->piece, out.pos);
}

/* Write a section as a frame, if that is smaller. */
static status pack(leaf_writer *w, leaf_section *s, packing *x) {
    ZSTD_inBuffer in = {bytes_of(w, s->kind), (size_t)s->bytes, 0};
    status st = ST_OK;
    (void)ZSTD_CCtx_setPledgedSrcSize(x->zstd, s->bytes);
    for (bool more = true; more && st == ST_OK && x->bytes < s->bytes;)
        st = pack_piece(w, s, x, &in, &more);
    const uint64_t sum = hash_stream_end(x->hash);
    if (st != ST_OK || x->bytes >= s->bytes)
        return st == ST_OK ? write_plain(w, s) : st;
    s->version = LEAF_SECTION_ZSTD;
    s->bytes = x->bytes;
    s->checksum = sum;
    return ST_OK;
}

/* Sections of a set lie as far apart as it is long: the window should hold more than one. */
static status write_packed(leaf_writer *w, leaf_section *s) {
    enum { LEVEL = 3, WINDOW_LOG = 22 };
    packing x = {.zstd = ZSTD_createCCtx(),
                 .hash = hash_stream_begin(),
                 .piece = mem_alloc(w->m, PIECE_BYTES)};
    status st = x.piece ? ST_OK : ST_NOMEM;
    if (st == ST_OK && (!x.zstd || !x.hash))
        st = status_describe(ST_NOMEM, "no room for a compressor");
    if (st == ST_OK) {
        (void)ZSTD_CCtx_setParameter(x.zstd, ZSTD_c_compressionLevel, LEVEL);
        (void)ZSTD_CCtx_setParameter(x.zstd, ZSTD_c_windowLog, WINDOW_LOG);
        st = pack(w, s, &x);
    } else if (x.hash) {
        (void)hash_stream_end(x.hash);
    }
    ZSTD_freeCCtx(x.zstd);
    mem_free(w->m, x.piece);
    return st;
}

/* Write the sections behind one another from the table's end on. *end: of the last. */
static status write_behind(leaf_writer *w, uint64_t *end) {
    leaf_header *h = &w->header;
    status st = ST_OK;
    list_sections(w);
    *end = h->directory + h->sections * sizeof *w->table;
    for (uint32_t i = 0; i < h->sections && st == ST_OK; i++) {
        leaf_section *s = &w->table[i];
        s->offset = leaf_layout_aligned(*end, LEAF_ALIGN_LOG2);
        /* What coarse grids there are is known only in the end: leaf_writer_write_parts(). */
        st = s->kind == LEAF_SECTION_COARSE ? write_plain(w, s) : write_packed(w, s);
        *end = s->offset + s->bytes;
    }
    return st;
}

static status write_zeros(leaf_writer *w, uint64_t from, uint64_t to) {
    static const char zeros[512];
    status st = ST_OK;
    for (uint64_t size; st == ST_OK && from < to; from += size) {
        size = to - from < sizeof zeros ? to - from : sizeof zeros;
        st = out_file_write_at(w->out, from, zeros, (size_t)size);
    }
    return st;
}

status leaf_writer_write_directory(leaf_writer *w, uint64_t end) {
    leaf_header *h = &w->header;
    status st = ST_OK;
    if (is_behind(w)) {
        h->directory = leaf_layout_aligned(end, LEAF_ALIGN_LOG2);
        st = write_behind(w, &end);
    }
    for (uint32_t i = 0; i < h->sections && st == ST_OK && !is_behind(w); i++)
        st = write_plain(w, &w->table[i]);
    h->file_bytes = leaf_layout_aligned(end, w->p.run_align_log2);
    /* The gaps before are holes, which read as zeros. */
    return st == ST_OK ? write_zeros(w, end, h->file_bytes) : st;
}

status leaf_writer_write_parts(leaf_writer *w) {
    status st = ST_OK;
    for (uint32_t i = 0; i < w->header.sections && st == ST_OK; i++)
        if (w->table[i].kind == LEAF_SECTION_COARSE)
            st = write_bytes(w, &w->table[i], w->parts);
    return st;
}
