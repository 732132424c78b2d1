#include "prep/export/zarr_writer.h"

#include <endian.h>
#include <jansson.h>
#include <stdlib.h>
#include <string.h>
#include <zstd.h>

#include "formats/base/out_folder.h"
#include "formats/base/pool.h"
#include "formats/grid/ngff_units.h"
#include "formats/leaf/leaf_unpacker.h"
#include "prep/export/grid_box.h"
#include "prep/export/head_text.h"

/* SIDE: of a chunk, in samples. LEVEL: of zstd. SPARE_BYTES: memory that is kept free when threads
 * are planned. */
enum { SIDE = 64, LEVEL = 3, NAME_ROOM = 64, SPARE_BYTES = 64 << 10 };

/* Buffers of a thread. */
typedef struct bench {
    char *samples, *payload, *packed;
    leaf_unpacker *unpacker;
    ZSTD_CCtx *zstd;
} bench;

typedef struct writer {
    mem *m;
    const sample_export *e;
    out_folder *out;
    pool *workers;
    int threads;
    bench *benches;
    uint32_t side[3], chunks[3]; /* samples per chunk; chunks per step */
    size_t width, chunk, payload, bound;
    uint32_t step, layer; /* the current ones */
} writer;

/* ---- limits of the format ---- */

status zarr_writer_check(const grid *g) {
    bool plain = !grid_is_rectilinear(g);
    for (int row = 0; row < 3; row++)
        for (int a = 0; a < 3; a++)
            plain &= row == a ? g->to_world[row][a] > 0 : g->to_world[row][a] == 0;
    if (plain)
        return ST_OK;
    return status_describe(ST_UNSUPPORTED,
                           "OME-Zarr has a spacing and an origin; this grid's axes are %s, which "
                           ".nrrd can hold",
                           grid_is_rectilinear(g) ? "uneven"
                                                  : "turned, sheared or reversed in the world");
}

const char *zarr_writer_loses(const grid *g) {
    return g->frame.axes != WORLD_UNTOLD
               ? "OME-Zarr does not say which way the world's axes point in a body; convert --axes "
                 "says it again"
               : NULL;
}

const char *zarr_writer_loses_times(const sample_times *times) {
    return times->uneven ? "the steps are at uneven times, which OME-Zarr cannot say: they count "
                           "0, 1, .. there"
                         : NULL;
}

/* ---- JSON ---- */

/* Add a text as a quoted JSON string. */
static void add_text(head_text *h, const char *text) {
    json_t *string = json_string(text);
    char *quoted = string ? json_dumps(string, JSON_ENCODE_ANY) : NULL;
    if (quoted)
        head_text_add(h, "%s", quoted);
    else if (h->st == ST_OK)
        h->st = ST_NOMEM;
    free(quoted);
    json_decref(string);
}

static void add_axis(head_text *h, const char *name, const char *type, const char *unit) {
    head_text_add(h, "{\"name\": \"%s\", \"type\": \"%s\"", name, type);
    if (unit[0]) {
        head_text_add(h, ", \"unit\": ");
        add_text(h, ngff_units_name(unit));
    }
    head_text_add(h, "}%s", strcmp(name, "x") ? ", " : "");
}

/* Add a transformation by name: a number for time if there is one, then the map's diagonal or last
 * column. */
static void add_numbers(head_text *h, const char *name, const grid *g, bool origin,
                        const double *time) {
    head_text_add(h, "{\"type\": \"%s\", \"%s\": [", name, name);
    if (time) {
        head_text_number(h, *time);
        head_text_add(h, ", ");
    }
    for (int a = 2; a >= 0; a--) {
        head_text_number(h, g->to_world[a][origin ? 3 : a]);
        head_text_add(h, a ? ", " : "]}");
    }
}

static void add_attributes(head_text *h, const grid *g, const sample_times *times) {
    const bool steps = times->steps > 1;
    head_text_add(h, "{\"multiscales\": [{\n  \"version\": \"0.4\",");
    if (g->name[0]) {
        head_text_add(h, "\n  \"name\": ");
        add_text(h, g->name);
        head_text_add(h, ",");
    }
    head_text_add(h, "\n  \"axes\": [");
    if (steps)
        add_axis(h, "t", "time", times->unit);
    for (int a = 2; a >= 0; a--)
        add_axis(h, (const char *[]){"x", "y", "z"}[a], "space", g->frame.unit[a]);
    head_text_add(h,
                  "],\n  \"datasets\": [{\"path\": \"0\", \"coordinateTransformations\": [\n    ");
    add_numbers(h, "scale", g, false, steps ? &times->apart : NULL);
    head_text_add(h, ",\n    ");
    add_numbers(h, "translation", g, true, steps ? &times->first : NULL);
    head_text_add(h, "]}]\n}]}\n");
}

static void add_sizes(head_text *h, const char *key, const uint32_t *steps, const uint32_t of[3]) {
    head_text_add(h, "\"%s\": [", key);
    if (steps)
        head_text_add(h, "%u, ", *steps);
    head_text_add(h, "%u, %u, %u], ", of[2], of[1], of[0]);
}

static const char *type_name(sample_type type) {
    switch (type) {
    case SAMPLE_U8: return "|u1";
    case SAMPLE_I8: return "|i1";
    case SAMPLE_U16: return "<u2";
    case SAMPLE_I16: return "<i2";
    default: return "<f4";
    }
}

static void add_array(head_text *h, const writer *w, const grid *g) {
    static const uint32_t one = 1;
    const uint32_t *steps = &w->e->times->steps;
    head_text_add(h, "{");
    add_sizes(h, "shape", *steps > 1 ? steps : NULL, g->dims);
    add_sizes(h, "chunks", *steps > 1 ? &one : NULL, w->side);
    head_text_add(h,
                  "\"dtype\": \"%s\", \"fill_value\": 0, \"order\": \"C\", \"filters\": null, "
                  "\"dimension_separator\": \"/\", \"compressor\": {\"id\": \"zstd\", \"level\": "
                  "%d}, \"zarr_format\": 2}\n",
                  type_name(g->type), LEVEL);
}

static status put_text(writer *w, const char *name, head_text *h) {
    status st = h->st;
    if (st == ST_OK)
        st = out_folder_put(w->out, name, h->text, h->size);
    head_text_release(h);
    return st;
}

static status put_heads(writer *w, const grid *g) {
    head_text group = {.m = w->m}, attributes = group, array = group;
    head_text_add(&group, "{\"zarr_format\": 2}\n");
    add_attributes(&attributes, g, w->e->times);
    add_array(&array, w, g);
    status st = put_text(w, ".zgroup", &group);
    if (st == ST_OK)
        st = put_text(w, ".zattrs", &attributes);
    if (st == ST_OK)
        st = put_text(w, "0/.zarray", &array);
    head_text_release(&attributes);
    head_text_release(&array);
    return st;
}

/* ---- a chunk ---- */

static status load_box(const writer *w, const bench *b, const grid_box *box, uint32_t set) {
    const leaf_layout *l = &w->e->f->layout;
    uint32_t first[3], count[3], place[3];
    status st = ST_OK;
    grid_box_treelets(box, l, first, count);
    for (uint32_t i = 0; i < count[0] * count[1] * count[2] && st == ST_OK; i++) {
        place[0] = first[0] + i % count[0];
        place[1] = first[1] + i / count[0] % count[1];
        place[2] = first[2] + i / count[0] / count[1];
        const uint32_t t = leaf_layout_find(l, box->level, place);
        st = leaf_file_load(w->e->f, leaf_layout_samples(l, set, t), b->unpacker, b->payload);
        if (st == ST_OK)
            grid_box_copy(box, l, place, b->payload);
    }
    return st;
}

/* Spread rows of the box to those of a whole chunk, in place and so from the last row. Samples
 * beyond the grid are 0. */
static void spread(const writer *w, const bench *b, const grid_box *box) {
    const size_t row = w->side[0] * w->width;
    const size_t own = (box->end[0] - box->lo[0]) * w->width;
    const uint32_t rows = box->end[1] - box->lo[1], slices = box->end[2] - box->lo[2];
    if (own == row && rows == w->side[1] && slices == w->side[2])
        return;
    for (uint32_t z = w->side[2]; z-- > 0;)
        for (uint32_t y = w->side[1]; y-- > 0;) {
            char *to = b->samples + ((size_t)z * w->side[1] + y) * row;
            const bool there = z < slices && y < rows;
            if (there)
                memmove(to, b->samples + ((size_t)z * rows + y) * own, own);
            memset(to + (there ? own : 0), 0, there ? row - own : row);
        }
}

static status put_chunk(const writer *w, const bench *b, const uint32_t at[3]) {
    char name[NAME_ROOM];
    if (__BYTE_ORDER == __BIG_ENDIAN)
        sample_swap(w->e->f->layout.type, b->samples, w->chunk / w->width);
    const size_t size =
        ZSTD_compressCCtx(b->zstd, b->packed, w->bound, b->samples, w->chunk, LEVEL);
    if (ZSTD_isError(size))
        return status_describe(ST_NOMEM, "zstd: %s", ZSTD_getErrorName(size));
    if (w->e->times->steps > 1)
        snprintf(name, sizeof name, "0/%u/%u/%u/%u", w->step, at[2], at[1], at[0]);
    else
        snprintf(name, sizeof name, "0/%u/%u/%u", at[2], at[1], at[0]);
    return out_folder_put(w->out, name, b->packed, size);
}

static status write_chunk(void *ctx, size_t index, int worker) {
    const writer *w = ctx;
    const bench *b = &w->benches[worker];
    const uint32_t at[3] = {(uint32_t)(index % w->chunks[0]), (uint32_t)(index / w->chunks[0]),
                            w->layer};
    grid_box box = grid_box_of(w->e->part);
    for (int a = 0; a < 3; a++) {
        box.lo[a] += at[a] * w->side[a];
        if (box.end[a] - box.lo[a] > w->side[a])
            box.end[a] = box.lo[a] + w->side[a];
    }
    box.samples = b->samples;
    status st = load_box(w, b, &box, w->e->sets[w->step]);
    if (st != ST_OK)
        return st;
    spread(w, b, &box);
    return put_chunk(w, b, at);
}

static status write_chunks(writer *w) {
    const uint32_t steps = w->e->times->steps;
    status st = ST_OK;
    for (w->step = 0; w->step < steps && st == ST_OK; w->step++)
        for (w->layer = 0; w->layer < w->chunks[2] && st == ST_OK; w->layer++) {
            st = pool_run(w->workers, (size_t)w->chunks[0] * w->chunks[1], write_chunk, w);
            if (st == ST_OK)
                st = progress_step(w->e->p, "export",
                                   (w->step + (w->layer + 1.0) / w->chunks[2]) / steps);
        }
    return st;
}

/* ---- memory ---- */

/* zstd allocates its tables and another copy of the chunk outside of mem. */
static uint64_t bench_bytes(const writer *w) {
    return w->chunk + w->bound + w->payload + leaf_unpacker_memory(w->e->f) + w->chunk + (1 << 20);
}

static status plan(writer *w) {
    const uint64_t fixed = mem_used(w->m) + SPARE_BYTES, each = bench_bytes(w);
    w->threads = w->e->threads;
    if (!w->m->limit)
        return ST_OK;
    if (fixed + each > w->m->limit)
        return status_describe(
            ST_NOMEM,
            "a memory budget of %llu KiB is too small: a chunk of this grid needs %llu KiB",
            (unsigned long long)(w->m->limit >> 10),
            (unsigned long long)(((fixed + each) >> 10) + 1));
    while (w->threads > 1 && fixed + (uint64_t)w->threads * each > w->m->limit)
        w->threads--;
    return ST_OK;
}

static status make_benches(writer *w) {
    w->benches = mem_zalloc(w->m, (size_t)w->threads * sizeof *w->benches);
    for (int i = 0; w->benches && i < w->threads; i++) {
        bench *b = &w->benches[i];
        b->samples = mem_alloc(w->m, w->chunk);
        b->payload = mem_alloc(w->m, w->payload);
        b->packed = mem_alloc(w->m, w->bound);
        b->zstd = ZSTD_createCCtx();
        if (!b->samples || !b->payload || !b->packed || !b->zstd)
            return ST_NOMEM;
        const status st = leaf_unpacker_create(w->m, w->e->f, &b->unpacker);
        if (st != ST_OK)
            return st;
    }
    return w->benches ? ST_OK : ST_NOMEM;
}

static void release(writer *w) {
    pool_destroy(w->workers);
    for (int i = 0; w->benches && i < w->threads; i++) {
        mem_free(w->m, w->benches[i].samples);
        mem_free(w->m, w->benches[i].payload);
        mem_free(w->m, w->benches[i].packed);
        leaf_unpacker_destroy(w->benches[i].unpacker);
        ZSTD_freeCCtx(w->benches[i].zstd);
    }
    mem_free(w->m, w->benches);
}

/* ---- all of it ---- */

static void measure(writer *w, const grid *g) {
    w->width = sample_size(g->type);
    w->chunk = w->width;
    for (int a = 0; a < 3; a++) {
        w->side[a] = g->dims[a] < SIDE ? g->dims[a] : SIDE;
        w->chunks[a] = (g->dims[a] + w->side[a] - 1) / w->side[a];
        w->chunk *= w->side[a];
    }
    w->payload = leaf_layout_aligned(leaf_layout_payload_max(&w->e->f->layout), LEAF_ALIGN_LOG2);
    w->bound = ZSTD_compressBound(w->chunk);
}

status zarr_writer_run(mem *m, const sample_export *e) {
    writer w = {.m = m, .e = e};
    grid g = {.dims = {0}};
    status st = grid_part_describe(m, e->f, e->part, &g);
    if (st == ST_OK) {
        measure(&w, &g);
        st = plan(&w);
    }
    if (st == ST_OK)
        st = pool_create(m, w.threads, &w.workers);
    if (st == ST_OK)
        st = make_benches(&w);
    if (st == ST_OK)
        st = out_folder_create(m, e->path, &w.out);
    if (st == ST_OK)
        st = put_heads(&w, &g);
    if (st == ST_OK)
        st = write_chunks(&w);
    if (st == ST_OK)
        st = out_folder_commit(w.out);
    else
        out_folder_discard(w.out);
    release(&w);
    grid_release(&g, m);
    return st;
}
