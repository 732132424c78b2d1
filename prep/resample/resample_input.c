#include "prep/resample/resample_input.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "formats/base/file.h"
#include "formats/base/partial.h"
#include "formats/curvilinear/curvilinear_input_kind.h"
#include "formats/leaf/leaf_tell.h"
#include "formats/mesh/mesh_input_kind.h"
#include "prep/curvilinear/curvilinear_files.h"
#include "prep/mesh/mesh_convert.h"
#include "prep/mesh/mixed_treelet.h"
#include "prep/resample/resample_cells.h"

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

/* Reading the mesh is half of the whole job, or a bit more. */
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

/* A conversion to a treelet file. */
typedef struct conversion {
    mem *m;
    const resample_source *s;
    const char *output;
    progress p;
} conversion;

static status convert_mesh(const conversion *c, void *own) {
    mesh_options o = mesh_options_default();
    mesh_result result;
    o.threads = c->s->threads;
    o.force = true;
    o.cells = c->s->whole_cells ? &mixed_treelets : NULL;
    if (c->m->limit)
        o.memory = c->m->limit;
    return mesh_convert_run(c->m, own, c->output, &o, &c->p, &result);
}

static status convert_zones(const conversion *c, void *own) {
    const char *const paths[1] = {c->s->path};
    curvilinear_files files = {.m = c->m,
                               .of = {.paths = paths, .sets = {.fields = 1, .steps = 1}},
                               .hints = c->s->hints.curvilinear,
                               .first = own};
    const curvilinear_options o = {.file = leaf_parameters_default(),
                                   .memory = c->m->limit ? c->m->limit : UINT64_MAX,
                                   .threads = c->s->threads,
                                   .force = true};
    curvilinear_result result;
    status st = curvilinear_files_check(&files);
    if (st == ST_OK) {
        const curvilinear_series series = curvilinear_files_series(&files);
        st = curvilinear_convert(c->m, &series, curvilinear_input_name(own), c->output, &o, &c->p,
                                 &result);
    }
    curvilinear_files_release(&files);
    return st;
}

static const struct {
    const input_kind *of;
    status (*convert)(const conversion *c, void *own);
} conversions[] = {{&mesh_input_kind, convert_mesh}, {&curvilinear_input_kind, convert_zones}};
enum { CONVERSIONS = sizeof conversions / sizeof *conversions };

static status convert_input(const conversion *c, const input *in) {
    const resample_source *s = c->s;
    int i = 0;
    while (i < CONVERSIONS && conversions[i].of != in->kind)
        i++;
    if (i == CONVERSIONS)
        return status_describe(
            ST_UNSUPPORTED, "%s: a %s, which %s; resampled are meshes and curvilinear grids",
            s->path, in->kind->name,
            in->kind->traits(in->own) & INPUT_LATTICE ? "is regular already: convert takes it"
                                                      : "fills no volume: convert takes it");
    const status st =
        s->opened ? s->opened(s->ctx, in->kind->traits(in->own), in->kind->format(in->own)) : ST_OK;
    return st == ST_OK ? conversions[i].convert(c, in->own) : st;
}

static status convert(mem *m, const resample_source *s, const char *path, const progress *p) {
    half h = {p};
    const conversion c = {m, s, path, {.report = report_half, .stop = stop_half, .ctx = &h}};
    input in;
    status st = input_open(m, s->path, &s->hints, &in);
    if (st == ST_OK)
        st = convert_input(&c, &in);
    input_close(&in);
    return st;
}

/* Convert to SCRATCH.partial-N.leaf, which nobody else writes while SCRATCH.partial-N is locked.
 * The file has a name only until it is open. The next run finds what a killed one left. */
static status open_scratch(mem *m, const resample_source *s, const char *scratch, const progress *p,
                           leaf_file **out) {
    const size_t size = strlen(scratch) + PARTIAL_ROOM;
    char *name = mem_alloc(m, size), *path = mem_alloc(m, size);
    const int fd = name && path ? partial_open(scratch, name) : -1;
    status st = name && path ? ST_OK : ST_NOMEM;
    if (st == ST_OK && fd < 0)
        st = file_failed(errno, scratch, "cannot create a temporary file beside");
    if (st == ST_OK) {
        snprintf(path, size, "%s.leaf", name);
        st = convert(m, s, path, p);
        if (st == ST_OK)
            st = leaf_file_open(m, path, out);
        (void)unlink(path);
        (void)unlink(name);
        close(fd);
    }
    mem_free(m, path);
    mem_free(m, name);
    return st;
}

static status open_mesh(mem *m, const resample_source *s, const progress *p, leaf_file **out) {
    char *path = NULL;
    status st = out_file_scratch_path(m, s->beside, "leafcast-resample", &path);
    if (st == ST_OK)
        st = open_scratch(m, s, path, p, out);
    mem_free(m, path);
    return st;
}

status resample_input_open(mem *m, const resample_source *s, const progress *p, leaf_file **out) {
    leaf_file *f = NULL;
    status st =
        resample_input_is_leaf(s->path) ? leaf_file_open(m, s->path, &f) : open_mesh(m, s, p, &f);
    if (st == ST_OK && !resample_cells_of(f)) {
        const leaf_teller *teller = leaf_teller_of(f);
        const char *kind = teller->is_surface ? "surface" : teller->name;
        leaf_file_close(f);
        return status_describe(
            ST_UNSUPPORTED,
            "%s: a %s, of which none is resampled; meshes and curvilinear grids are", s->path,
            kind);
    }
    *out = f;
    return st;
}
