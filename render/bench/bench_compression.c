#include "render/bench/bench_compression.h"

#include <math.h>
#include <string.h>

#include <zstd.h>

#include "formats/base/clock.h"
#include "formats/leaf/box_coder.h"
#include "formats/leaf/leaf_unpacker.h"
#include "render/bench/bench_race.h"
#include "render/bench/bench_store.h"

/* A file and what was found. */
typedef struct contestant {
    const char *path;
    leaf_file *f;
    double load;         /* payload bytes a second of CPU time */
    double *warm, *cold; /* seconds of first pictures */
} contestant;

/* What both files hold. */
typedef struct holding {
    uint64_t raw;     /* bytes of samples of level 0; of a mesh, of raw payloads */
    uint64_t zstd;    /* bytes of these by zstd -3 */
    uint64_t samples; /* of the compressed file's payloads */
    double bits;      /* entropy of its streams */
} holding;

/* ---- samples of level 0, and zstd of them ---- */

/* Copy a treelet's own nodes into the whole. */
static void place_samples(const leaf_file *f, uint32_t t, const void *payload, char *all) {
    const leaf_layout *l = &f->layout;
    const leaf_payload p = leaf_layout_payload(l, t);
    const size_t size = sample_size(l->type);
    const uint32_t h = l->halo, *dims = l->level[0].dims, *place = l->place[t];
    for (uint32_t z = 0; z <= p.cells[2]; z++)
        for (uint32_t y = 0; y <= p.cells[1]; y++) {
            const size_t from = h + p.samples[0] * (y + h + (size_t)p.samples[1] * (z + h));
            const size_t row = ((size_t)place[1] << l->cells_log2) + y;
            const size_t slice = ((size_t)place[2] << l->cells_log2) + z;
            const size_t to =
                ((size_t)place[0] << l->cells_log2) + dims[0] * (row + (size_t)dims[1] * slice);
            memcpy(all + to * size, (const char *)payload + p.samples_at + from * size,
                   (p.cells[0] + 1) * size);
        }
}

static status gather_grid(mem *m, leaf_file *f, void *payload, char **all, size_t *bytes) {
    const leaf_level *level = &f->layout.level[0];
    *bytes = (size_t)level->dims[0] * level->dims[1] * level->dims[2] * sample_size(f->layout.type);
    *all = mem_alloc(m, *bytes);
    status st = *all ? ST_OK : ST_NOMEM;
    for (uint32_t t = level->first; t < level->first + level->count && st == ST_OK; t++) {
        st = leaf_file_load(f, t, NULL, payload);
        if (st == ST_OK)
            place_samples(f, t, payload, *all);
    }
    return st;
}

static status gather_mesh(mem *m, leaf_file *f, void *payload, char **all, size_t *bytes) {
    *bytes = 0;
    for (uint32_t p = 0; p < f->layout.payloads; p++)
        *bytes += leaf_layout_payload_bytes(&f->layout, p);
    *all = mem_alloc(m, *bytes);
    status st = *all ? ST_OK : ST_NOMEM;
    char *to = *all;
    for (uint32_t p = 0; p < f->layout.payloads && st == ST_OK; p++) {
        const size_t size = leaf_layout_payload_bytes(&f->layout, p);
        st = leaf_file_load(f, p, NULL, payload);
        memcpy(to, payload, size);
        to += size;
    }
    return st;
}

static status measure_raw(mem *m, leaf_file *f, holding *h) {
    char *all = NULL, *packed = NULL;
    size_t bytes = 0;
    void *payload = mem_alloc(m, leaf_layout_payload_max(&f->layout));
    status st = !payload  ? ST_NOMEM
                : f->mesh ? gather_mesh(m, f, payload, &all, &bytes)
                          : gather_grid(m, f, payload, &all, &bytes);
    h->raw = bytes;
    if (st == ST_OK && !(packed = mem_alloc(m, ZSTD_compressBound(bytes))))
        st = ST_NOMEM;
    if (st == ST_OK) {
        const size_t size = ZSTD_compress(packed, ZSTD_compressBound(bytes), all, bytes, 3);
        h->zstd = ZSTD_isError(size) ? bytes : size;
    }
    mem_free(m, packed);
    mem_free(m, all);
    mem_free(m, payload);
    return st;
}

/* ---- entropy of what is stored ---- */

static double entropy_of(const uint8_t *bytes, size_t n) {
    size_t times[256] = {0};
    double bits = 0;
    for (size_t i = 0; i < n; i++)
        times[bytes[i]]++;
    for (int i = 0; i < 256; i++)
        if (times[i])
            bits += (double)times[i] * log2((double)n / (double)times[i]);
    return bits;
}

static uint32_t number_at(const uint8_t *b) {
    return b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24;
}

/* Returns the bits of entropy of a code of boxes (FORMAT.md 10): the sum of its streams'. Plain
 * samples count as one stream. */
static double bits_of_code(const uint8_t *code, size_t bytes, uint8_t *room, size_t room_bytes) {
    const unsigned streams = (code[2] & BOX_BACKGROUND ? 1U : 0U) + code[3];
    double bits = 8.0 * LEAF_CODE_BYTES;
    if (!code[0])
        return bits + entropy_of(code + LEAF_CODE_BYTES, bytes - LEAF_CODE_BYTES);
    const uint8_t *at = code + LEAF_CODE_BYTES + 4 * streams;
    for (unsigned i = 0; i < streams; i++) {
        const size_t size = number_at(code + LEAF_CODE_BYTES + 4 * i);
        const size_t got = ZSTD_decompress(room, room_bytes, at, size);
        bits += ZSTD_isError(got) ? 0 : entropy_of(room, got);
        at += size;
    }
    return bits;
}

static status measure_entropy(mem *m, leaf_file *f, holding *h) {
    const size_t most = leaf_layout_stored_max(&f->layout);
    uint8_t *stored = mem_alloc(m, most), *room = mem_alloc(m, most);
    status st = stored && room ? ST_OK : ST_NOMEM;
    for (uint32_t p = 0; p < f->layout.payloads && st == ST_OK && f->layout.coded; p++) {
        if (!f->sizes[p])
            continue;
        st = leaf_file_fetch(f, p, stored);
        if (st == ST_OK)
            h->bits += bits_of_code(stored, (size_t)f->sizes[p], room, most);
        h->samples +=
            (leaf_layout_stored(&f->layout, p) - LEAF_CODE_BYTES) / sample_size(f->layout.type);
    }
    mem_free(m, stored);
    mem_free(m, room);
    return st;
}

/* ---- loading ---- */

/* Load all payloads that a treelet has, as a reader's thread does. */
static status load_all(mem *m, contestant *c) {
    leaf_unpacker *u = NULL;
    const leaf_layout *l = &c->f->layout;
    void *payload = mem_alloc(m, leaf_layout_payload_max(l));
    status st = payload ? leaf_unpacker_create(m, c->f, &u) : ST_NOMEM;
    const uint32_t payloads = l->payloads - l->sets * l->shells;
    uint64_t bytes = 0;
    const double start = clock_cpu_seconds();
    for (uint32_t p = 0; p < payloads && st == ST_OK; p++) {
        if (leaf_file_is_implied(c->f, p))
            continue;
        bytes += leaf_layout_payload_bytes(l, p);
        st = leaf_file_load(c->f, p, u, payload);
    }
    c->load = (double)bytes / fmax(clock_cpu_seconds() - start, 1e-9);
    leaf_unpacker_destroy(u);
    mem_free(m, payload);
    return st;
}

/* ---- first pictures ---- */

static status first_picture(const bench_job *job, const bench_subject *s, const char *path,
                            float *pixels, double *seconds) {
    const uint32_t side = job->view.camera.width;
    const size_t n = (size_t)side * side;
    const bench_entry e = {path, NULL, s->view.surfaces[0].isovalue, job->threads, 1.5, side};
    const leafcast_image image = {
        .size = sizeof(leafcast_image), .r = pixels, .g = pixels + n, .b = pixels + 2 * n};
    bench_racer r = {0};
    const double start = clock_seconds();
    status st = bench_race_enter(&e, &r);
    if (st == ST_OK)
        st = (status)leafcast_trace(r.volume, &r.scene, &r.camera, &image, NULL, NULL, NULL);
    *seconds = clock_seconds() - start;
    leafcast_close(r.volume);
    return st;
}

static status draw_in_turn(bench_job *job, const bench_subject *s, contestant c[2]) {
    const size_t n = (size_t)job->view.camera.width * job->view.camera.width;
    float *pixels = mem_array(&job->m, 3 * n, sizeof *pixels);
    double ignored;
    status st = pixels ? ST_OK : ST_NOMEM;
    for (int i = 0; i < 2 && st == ST_OK; i++)
        st = first_picture(job, s, c[i].path, pixels, &ignored);
    for (int run = 0; run < 2 * job->runs && st == ST_OK; run++)
        for (int i = 0; i < 2 && st == ST_OK; i++) {
            const bool cold = run % 2;
            if (cold)
                bench_store_forget(c[i].path);
            st = first_picture(job, s, c[i].path, pixels, &(cold ? c[i].cold : c[i].warm)[run / 2]);
        }
    mem_free(&job->m, pixels);
    return st;
}

/* ---- the suite ---- */

const char bench_compression_headings[] =
    "volume|raw MB|zstd -3|file|of zstd|bits|bytes/tet|load MB/s|raw MB/s|warm ms|+-|x raw|cold ms|"
    "x raw cold";

static void add_row(bench_job *job, const char *label, const holding *h, contestant c[2]) {
    bench_table *t = &job->table;
    const leaf_file *f = c[1].f;
    const double raw = (double)h->raw, bytes = (double)f->header.file_bytes;
    double spread;
    const double warm[2] = {bench_median(c[0].warm, job->runs, NULL),
                            bench_median(c[1].warm, job->runs, &spread)};
    const double cold[2] = {bench_median(c[0].cold, job->runs, NULL),
                            bench_median(c[1].cold, job->runs, NULL)};
    bench_table_add(t, "%s", label);
    bench_table_add(t, "%.2f", raw / 1e6);
    bench_table_add(t, "%.3f", (double)h->zstd / raw);
    bench_table_add(t, "%.3f", bytes / raw);
    bench_table_add(t, "%.3f", bytes / (double)h->zstd);
    bench_table_add(t, h->samples ? "%.2f" : "-", h->bits / fmax((double)h->samples, 1));
    bench_table_add(t, f->mesh ? "%.2f" : "-", bytes / fmax((double)f->header.tets, 1));
    bench_table_add(t, "%.0f", c[1].load / 1e6);
    bench_table_add(t, "%.0f", c[0].load / 1e6);
    bench_table_add(t, "%.1f", warm[1] * 1e3);
    bench_table_add(t, "%.1f", spread * 1e3);
    bench_table_add(t, "%.2f", warm[1] / warm[0]);
    bench_table_add(t, "%.1f", cold[1] * 1e3);
    bench_table_add(t, "%.2f", cold[1] / cold[0]);
}

static status open_both(bench_job *job, contestant c[2]) {
    status st = ST_OK;
    for (int i = 0; i < 2 && st == ST_OK; i++) {
        st = leaf_file_open(&job->m, c[i].path, &c[i].f);
        c[i].warm = mem_array(&job->m, (size_t)job->runs, sizeof *c[i].warm);
        c[i].cold = mem_array(&job->m, (size_t)job->runs, sizeof *c[i].cold);
        if (st == ST_OK && (!c[i].warm || !c[i].cold))
            st = ST_NOMEM;
    }
    return st;
}

static void close_both(bench_job *job, contestant c[2]) {
    for (int i = 0; i < 2; i++) {
        leaf_file_close(c[i].f);
        mem_free(&job->m, c[i].warm);
        mem_free(&job->m, c[i].cold);
    }
}

static status measure(bench_job *job, const bench_subject *s) {
    bench_stored small;
    holding h = {0};
    status st = bench_store_compressed(job->store, s->name, &small);
    contestant c[2] = {{.path = s->path}, {.path = small.path}};
    if (st == ST_OK)
        st = open_both(job, c);
    if (st == ST_OK)
        st = measure_raw(&job->m, c[0].f, &h);
    if (st == ST_OK)
        st = measure_entropy(&job->m, c[1].f, &h);
    for (int i = 0; i < 2 && st == ST_OK; i++)
        st = load_all(&job->m, &c[i]);
    if (st == ST_OK)
        st = draw_in_turn(job, s, c);
    if (st == ST_OK)
        add_row(job, s->label, &h, c);
    close_both(job, c);
    return st;
}

status bench_compression(bench_job *job) {
    static const char *const names[] = {"bonsai",      "engine",      "angiogram",   "ch2better",
                                        "teapot",      "ct-head-u16", "cranium-i16", "stent-f32",
                                        "fingers-f32", "bucky-32",    NULL};
    static const char *const brief[] = {"ml-32", "orbital-64", "bucky-12", NULL};
    bench_table_init(
        &job->table,
        "Compressed files (zstd:1): bytes over those of the raw samples (of a mesh, of "
        "raw payloads); bits of entropy a stored sample; payloads loaded by one thread, "
        "CPU time; first pictures, medians by the wall clock, interleaved",
        bench_compression_headings);
    return bench_suite_each(job, names, brief, measure);
}
