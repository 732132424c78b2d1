#include "prep/resample_input.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "formats/base/file.h"
#include "prep/mesh_convert.h"

bool resample_input_is_leaf(const char *path) {
    char magic[sizeof LEAF_MAGIC - 1];
    mem m;
    file *f = NULL;
    mem_init(&m, 0);
    const bool is = strcmp(path, "-") != 0 && file_open(&m, path, &f) == ST_OK &&
                    file_read_at(f, 0, magic, sizeof magic) == ST_OK &&
                    memcmp(magic, LEAF_MAGIC, sizeof magic) == 0;
    file_close(f);
    return is;
}

/* Reading it is half of the whole job, rather more than less. */
typedef struct half {
    const progress *p;
} half;

static void report_half(void *ctx, const char *stage, double fraction) {
    const half *h = ctx;
    if (h->p && h->p->report)
        h->p->report(h->p->ctx, stage, fraction / 2);
}

static bool stop_half(void *ctx) {
    const half *h = ctx;
    return h->p && h->p->stop && h->p->stop(h->p->ctx);
}

static status convert(mem *m, const resample_source *s, const char *path, const progress *p) {
    half h = {p};
    const progress first = {.report = report_half, .stop = stop_half, .ctx = &h};
    mesh_options o = mesh_options_default();
    o.threads = s->threads;
    if (m->limit)
        o.memory = m->limit;
    mesh *x = NULL;
    mesh_result result;
    status st = mesh_open(m, s->path, &s->hints, &x);
    if (st == ST_OK)
        st = mesh_convert_run(m, x, path, &o, &first, &result);
    mesh_close(x);
    return st;
}

static char *scratch_name(mem *m, const resample_source *s) {
    const char *folder = getenv("TMPDIR");
    if (!folder || !*folder)
        folder = "/tmp";
    const char *before = s->beside ? s->beside : folder;
    const size_t size = strlen(before) + 64;
    char *path = mem_alloc(m, size);
    if (path)
        snprintf(path, size, "%s%s.mesh-%ld.leaf", before, s->beside ? "" : "/leafcast-resample",
                 (long)getpid());
    return path;
}

static status open_mesh(mem *m, const resample_source *s, const progress *p, leaf_file **out) {
    char *path = scratch_name(m, s);
    if (!path)
        return ST_NOMEM;
    status st = convert(m, s, path, p);
    if (st == ST_OK) {
        st = leaf_file_open(m, path, out);
        (void)unlink(path);
    }
    mem_free(m, path);
    return st;
}

status resample_input_open(mem *m, const resample_source *s, const progress *p, leaf_file **out) {
    leaf_file *f = NULL;
    status st =
        resample_input_is_leaf(s->path) ? leaf_file_open(m, s->path, &f) : open_mesh(m, s, p, &f);
    if (st == ST_OK && !f->mesh) {
        leaf_file_close(f);
        return status_describe(ST_UNSUPPORTED, "%s: a grid, which needs no resampling", s->path);
    }
    *out = f;
    return st;
}
