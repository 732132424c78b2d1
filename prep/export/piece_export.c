#include "prep/export/piece_export.h"

#include <string.h>
#include <unistd.h>

#include "formats/base/file.h"
#include "prep/export/weld.h"

enum { BATCH_PER_THREAD = 4, SPARE_BYTES = 256 << 10 };

/* A buffer that loses its contents when it grows. */
typedef struct buffer {
    void *bytes;
    size_t room;
} buffer;

/* Buffers of a thread. */
typedef struct bench {
    piece p;
    buffer order, numbers, scratch, encoded;
    uint32_t owned;
} bench;

/* Result of one piece of the batch. */
typedef struct result {
    uint32_t vertices, cells, corners, shares;
    hash_id *keys;
    char *encoded;
    size_t size;
} result;

typedef struct job {
    mem *m;
    const piece_export *e;
    piece_info *info;
    pool *workers;
    weld *weld; /* NULL: the format has loose triangles */
    bench *benches;
    result *results; /* one per piece of the batch */
    uint32_t batch, first;
    /* Numbers of each piece's first cell and of its first corner; one more entry for the end. */
    uint64_t *first_cell, *first_corner;
    piece_layout layout;
    uint64_t *array_at; /* offsets of the arrays in the file */
    int array;          /* array that is being written to standard output */
    out_file *file;     /* NULL: standard output */
} job;

static status reserve(job *j, buffer *b, size_t size) {
    if (size <= b->room)
        return ST_OK;
    mem_free(j->m, b->bytes);
    b->room = 0;
    b->bytes = mem_alloc(j->m, size + size / 4);
    if (!b->bytes)
        return ST_NOMEM;
    b->room = size + size / 4;
    return ST_OK;
}

/* ---- the first pass ---- */

static status make(job *j, uint32_t index, int worker) {
    piece *p = &j->benches[worker].p;
    status st = j->e->source->make(j->e->source->ctx, index, worker, p);
    if (st == ST_OK && j->e->format->loose)
        piece_drop_flat(p);
    return st;
}

static status count_one(void *ctx, size_t i, int worker) {
    job *j = ctx;
    const piece *p = &j->benches[worker].p;
    result *r = &j->results[i];
    status st = make(j, j->first + (uint32_t)i, worker);
    if (st != ST_OK)
        return st;
    *r = (result){
        .vertices = p->vertices, .cells = p->cells, .corners = p->corners, .shares = p->shares};
    if (!j->weld || p->shares == 0)
        return ST_OK;
    r->keys = mem_alloc(j->m, p->shares * sizeof *r->keys);
    if (!r->keys)
        return ST_NOMEM;
    for (uint32_t k = 0; k < p->shares; k++)
        r->keys[k] = p->share[k].key;
    return ST_OK;
}

static uint32_t batch_from(const job *j, uint32_t first) {
    const uint32_t left = j->e->source->pieces - first;
    return left < j->batch ? left : j->batch;
}

static status take_counts(job *j, uint32_t count) {
    status st = ST_OK;
    for (uint32_t i = 0; st == ST_OK && i < count; i++) {
        const result *r = &j->results[i];
        const uint32_t index = j->first + i;
        j->first_cell[index + 1] = j->first_cell[index] + r->cells;
        j->first_corner[index + 1] = j->first_corner[index] + r->corners;
        if (j->weld)
            st = weld_add(j->weld, r->vertices, r->keys, r->shares);
    }
    return st;
}

static void drop_results(job *j) {
    for (uint32_t i = 0; i < j->batch; i++) {
        mem_free(j->m, j->results[i].keys);
        mem_free(j->m, j->results[i].encoded);
        j->results[i] = (result){.keys = NULL};
    }
}

static void drop_scratch(job *j) {
    for (int i = 0; i < j->e->threads; i++) {
        bench *b = &j->benches[i];
        piece_release(&b->p);
        mem_free(j->m, b->order.bytes);
        mem_free(j->m, b->numbers.bytes);
        mem_free(j->m, b->scratch.bytes);
        mem_free(j->m, b->encoded.bytes);
        *b = (bench){.p = {.m = j->m}};
    }
}

/* Run a batch of pieces through body(), then take(). Halve the batch while memory is short. *count:
 * pieces in the batch. */
static status run_batch(job *j, pool_body body, status (*take)(job *j, uint32_t count),
                        uint32_t *count) {
    for (;;) {
        *count = batch_from(j, j->first);
        status st = pool_run(j->workers, *count, body, j);
        const bool small = st == ST_NOMEM && j->batch > 1;
        if (st == ST_OK)
            st = take(j, *count);
        drop_results(j);
        if (!small)
            return st;
        drop_scratch(j);
        j->batch /= 2;
    }
}

static status count_all(job *j) {
    const uint32_t pieces = j->e->source->pieces;
    status st = ST_OK;
    for (uint32_t count; st == ST_OK && j->first < pieces; j->first += count) {
        st = run_batch(j, count_one, take_counts, &count);
        if (st == ST_OK)
            st = progress_step(j->e->p, "surface", 0.4 * (j->first + count) / pieces);
    }
    if (st == ST_OK && j->weld)
        st = weld_end(j->weld, SPARE_BYTES);
    j->info->cells = j->first_cell[pieces];
    j->info->corners = j->first_corner[pieces];
    j->info->vertices = st == ST_OK && j->weld ? weld_vertices(j->weld) : 3 * j->info->cells;
    return st;
}

/* ---- the second pass ---- */

static status number(job *j, uint32_t index, bench *b) {
    const piece *p = &b->p;
    b->owned = p->vertices;
    if (!j->weld)
        return ST_OK;
    status st = reserve(j, &b->order, p->vertices * sizeof(uint32_t));
    if (st == ST_OK)
        st = reserve(j, &b->numbers, p->vertices * sizeof(uint64_t));
    if (st == ST_OK)
        st = reserve(j, &b->scratch, p->vertices * sizeof(uint64_t));
    if (st != ST_OK)
        return st;
    b->owned = weld_owned(j->weld, index, p, b->order.bytes);
    return weld_numbers(j->weld, index, p, b->numbers.bytes, b->scratch.bytes);
}

/* Encode a piece's elements of an array into b->encoded. */
static status encode(job *j, uint32_t index, bench *b, const piece_array *a, size_t *size) {
    const piece_view view = {.info = j->info,
                             .p = &b->p,
                             .order = b->order.bytes,
                             .owned = b->owned,
                             .numbers = b->numbers.bytes,
                             .first_corner = j->first_corner[index]};
    const uint32_t counts[PIECE_DOMAINS] = {b->owned, b->p.cells, b->p.corners};
    *size = counts[a->of] * a->stride;
    status st = reserve(j, &b->encoded, *size);
    if (st == ST_OK && *size > 0)
        (void)a->encode(&view, a, b->encoded.bytes);
    return st;
}

static status prepare(job *j, uint32_t index, int worker) {
    const piece *p = &j->benches[worker].p;
    status st = make(j, index, worker);
    if (st != ST_OK)
        return st;
    if (p->cells != j->first_cell[index + 1] - j->first_cell[index] ||
        p->corners != j->first_corner[index + 1] - j->first_corner[index] ||
        (j->weld && !weld_knows(j->weld, index, p)))
        return status_describe(ST_IO, "the treelet file changed while it was read");
    return number(j, index, &j->benches[worker]);
}

static uint64_t first_of(const job *j, uint32_t index, piece_domain of) {
    switch (of) {
    case PIECE_CELLS: return j->first_cell[index];
    case PIECE_CORNERS: return j->first_corner[index];
    default: return weld_first(j->weld, index);
    }
}

/* Write all arrays of a piece to the file. */
static status write_one(void *ctx, size_t i, int worker) {
    job *j = ctx;
    const uint32_t index = j->first + (uint32_t)i;
    bench *b = &j->benches[worker];
    status st = prepare(j, index, worker);
    for (int k = 0; st == ST_OK && k < j->layout.count; k++) {
        const piece_array *a = &j->layout.arrays[k];
        const uint64_t element = first_of(j, index, a->of);
        size_t size;
        st = encode(j, index, b, a, &size);
        if (st == ST_OK && size > 0)
            st = out_file_write_at(j->file, j->array_at[k] + element * a->stride, b->encoded.bytes,
                                   size);
    }
    return st;
}

/* For standard output: encode one array of a piece, and keep it until its turn. */
static status keep_one(void *ctx, size_t i, int worker) {
    job *j = ctx;
    const uint32_t index = j->first + (uint32_t)i;
    bench *b = &j->benches[worker];
    result *r = &j->results[i];
    status st = prepare(j, index, worker);
    if (st == ST_OK)
        st = encode(j, index, b, &j->layout.arrays[j->array], &r->size);
    if (st != ST_OK || r->size == 0)
        return st;
    r->encoded = mem_alloc(j->m, r->size);
    if (!r->encoded)
        return ST_NOMEM;
    memcpy(r->encoded, b->encoded.bytes, r->size);
    return ST_OK;
}

static status to_stdout(const void *bytes, size_t size) {
    return file_write_all(STDOUT_FILENO, "standard output", NULL, bytes, size);
}

/* Write the kept elements. Output to a file keeps none. */
static status pass_on(job *j, uint32_t count) {
    status st = ST_OK;
    for (uint32_t i = 0; st == ST_OK && i < count; i++)
        if (j->results[i].size > 0)
            st = to_stdout(j->results[i].encoded, j->results[i].size);
    return st;
}

/* Run all pieces through body(), as part number `part` of `parts` of the second pass. */
static status go_through(job *j, pool_body body, int part, int parts) {
    const uint32_t pieces = j->e->source->pieces;
    status st = ST_OK;
    j->first = 0;
    for (uint32_t count; st == ST_OK && j->first < pieces; j->first += count) {
        st = run_batch(j, body, pass_on, &count);
        const double done = (part + (double)(j->first + count) / pieces) / parts;
        if (st == ST_OK)
            st = progress_step(j->e->p, "surface", 0.4 + 0.6 * done);
    }
    return st;
}

static status write_stream(job *j) {
    const piece_layout *l = &j->layout;
    status st = ST_OK;
    for (j->array = 0; st == ST_OK && j->array < l->count; j->array++) {
        const head_text *before = &l->arrays[j->array].before;
        st = to_stdout(before->text, before->size);
        if (st == ST_OK)
            st = go_through(j, keep_one, j->array, l->count);
    }
    return st == ST_OK && l->tail.size > 0 ? to_stdout(l->tail.text, l->tail.size) : st;
}

static status write_text(job *j, uint64_t *at, const head_text *text) {
    status st = text->size > 0 ? out_file_write_at(j->file, *at, text->text, text->size) : ST_OK;
    *at += text->size;
    return st;
}

static status write_file(job *j) {
    const piece_layout *l = &j->layout;
    uint64_t at = 0;
    status st = ST_OK;
    for (int k = 0; st == ST_OK && k < l->count; k++) {
        const piece_array *a = &l->arrays[k];
        st = write_text(j, &at, &a->before);
        j->array_at[k] = at;
        at += a->stride * piece_elements(j->info, a->of);
    }
    if (st == ST_OK)
        st = write_text(j, &at, &l->tail);
    return st == ST_OK ? go_through(j, write_one, 0, 1) : st;
}

/* ---- all of it ---- */

static status allocate(job *j) {
    const piece_export *e = j->e;
    const size_t pieces = e->source->pieces;
    j->batch = (uint32_t)e->threads * BATCH_PER_THREAD;
    status st = pool_create(j->m, e->threads, &j->workers);
    if (st == ST_OK && !e->format->loose)
        st = weld_create(j->m, j->workers, e->beside, e->source->pieces, &j->weld);
    if (st != ST_OK)
        return st;
    j->benches = mem_array(j->m, (size_t)e->threads, sizeof *j->benches);
    j->results = mem_array(j->m, j->batch, sizeof *j->results);
    j->first_cell = mem_array(j->m, pieces + 1, sizeof *j->first_cell);
    j->first_corner = mem_array(j->m, pieces + 1, sizeof *j->first_corner);
    if (!j->benches || !j->results || !j->first_cell || !j->first_corner)
        return ST_NOMEM;
    for (int i = 0; i < e->threads; i++)
        j->benches[i].p.m = j->m;
    return ST_OK;
}

static void release(job *j) {
    if (j->benches)
        drop_scratch(j);
    mem_free(j->m, j->benches);
    mem_free(j->m, j->results);
    mem_free(j->m, j->first_cell);
    mem_free(j->m, j->first_corner);
    mem_free(j->m, j->array_at);
    piece_layout_release(&j->layout);
    weld_destroy(j->weld);
    pool_destroy(j->workers);
    out_file_discard(j->file);
}

static status lay_out(job *j) {
    status st = j->e->format->lay_out(j->m, j->info, &j->layout);
    if (st == ST_OK &&
        !(j->array_at = mem_array(j->m, (size_t)j->layout.count, sizeof *j->array_at)))
        st = ST_NOMEM;
    return st;
}

status piece_export_run(mem *m, const piece_export *e, piece_info *info) {
    job j = {.m = m, .e = e, .info = info, .layout = {.m = m, .tail = {.m = m}}};
    const bool stream = strcmp(e->path, "-") == 0;
    status st = stream ? ST_OK : out_file_create(m, e->path, e->force, &j.file);
    if (st == ST_OK)
        st = allocate(&j);
    if (st == ST_OK)
        st = count_all(&j);
    if (st == ST_OK)
        st = lay_out(&j);
    if (st == ST_OK)
        st = stream ? write_stream(&j) : write_file(&j);
    if (st == ST_OK && !stream) {
        st = out_file_commit(j.file);
        j.file = NULL;
    }
    release(&j);
    return st == ST_OK ? progress_step(e->p, "surface", 1) : st;
}
