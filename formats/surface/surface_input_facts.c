#include "formats/surface/surface_input_facts.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/num.h"
#include "formats/base/text.h"
#include "formats/input_collect.h"
#include "formats/mesh/mesh_input.h"
#include "formats/surface/surface_input_kind.h"

/* Facts of its own. */
typedef struct facts {
    mesh_report report;       /* if the values were read */
    float bounds[6];          /* lo, hi; likewise */
    bool counted;             /* the header says: */
    uint64_t vertices, faces; /* polygons and strips as the file has them */
} facts;

_Static_assert(sizeof(facts) <= sizeof((input_facts *)NULL)->own, "there is room");

static facts *own_of(input_facts *x) {
    return (facts *)(void *)x->own.bytes;
}

static const facts *facts_of(const input_facts *x) {
    return (const facts *)(const void *)x->own.bytes;
}

/* ---- the values ---- */

/* Every step-th value is drawn, few enough for the room. */
typedef struct drawing {
    mesh_input *surface;
    const progress *p;
    input_facts *x;
    histogram_cell *cells;
    uint32_t kept;
    uint64_t values, step;
} drawing;

static status take_points(void *ctx, uint64_t first, size_t count, const float (*xyz)[3]) {
    const drawing *d = ctx;
    float *bounds = own_of(d->x)->bounds;
    (void)first;
    for (size_t i = 0; i < count; i++)
        for (int a = 0; a < 3; a++) {
            bounds[a] = fminf(bounds[a], xyz[i][a]);
            bounds[a + 3] = fmaxf(bounds[a + 3], xyz[i][a]);
        }
    return progress_step(d->p, "reading", mesh_input_share(d->surface));
}

/* Drop every other value that is kept. */
static void thin(drawing *d) {
    for (uint32_t i = 0; i < d->kept; i += 2)
        d->cells[i / 2] = d->cells[i];
    d->kept = (d->kept + 1) / 2;
    d->step *= 2;
}

static status take_values(void *ctx, uint64_t first, size_t count, const float *values) {
    drawing *d = ctx;
    (void)first;
    for (size_t i = 0; i < count; i++, d->values++) {
        input_collect_value(d->x, (double)values[i]);
        if (d->kept == HISTOGRAM_DRAWS)
            thin(d);
        if (d->values % d->step == 0)
            d->cells[d->kept++] =
                (histogram_cell){.value = isfinite(values[i]) ? values[i] : NAN, .lo = 1, .hi = 0};
    }
    return progress_step(d->p, "reading", mesh_input_share(d->surface));
}

static status take_triangles(void *ctx, size_t count, const uint32_t (*ids)[3]) {
    const drawing *d = ctx;
    (void)count, (void)ids;
    return progress_step(d->p, "reading", mesh_input_share(d->surface));
}

static status read_values(mem *m, mesh_input *surface, const progress *p, input_facts *x) {
    drawing d = {.surface = surface, .p = p, .x = x, .step = 1};
    const mesh_sink sink = {
        .ctx = &d, .points = take_points, .values = take_values, .triangles = take_triangles};
    d.cells = mem_array(m, HISTOGRAM_DRAWS, sizeof *d.cells);
    status st = d.cells ? mesh_input_read(surface, &sink, &own_of(x)->report) : ST_NOMEM;
    if (st == ST_OK && own_of(x)->report.field[0])
        histogram_build(&x->values, d.cells, d.kept, SAMPLE_F32, x->range, d.values);
    mem_free(m, d.cells);
    return st;
}

typedef struct taking {
    input_facts *x;
    const char *by_default; /* "": no field is taken unasked */
} taking;

static void take_field(void *ctx, const char *name, int components) {
    taking *t = ctx;
    if (components > 0 && t->x->field_count == 0)
        t->by_default = name;
    input_collect_field(t->x, name, (uint32_t)abs(components));
}

static status ask(mem *m, void *input, const input_question *q, const progress *p, input_facts *x) {
    mesh_input *surface = input;
    facts *own = own_of(x);
    status st = ST_OK;
    *own = (facts){.bounds = {FLT_MAX, FLT_MAX, FLT_MAX, -FLT_MAX, -FLT_MAX, -FLT_MAX}};
    own->counted = mesh_input_counts(surface, &own->vertices, &own->faces);
    input_collect_name(x, mesh_input_name(surface));
    taking t = {x, ""};
    mesh_input_fields(surface, take_field, &t);
    if (q->opened)
        st = q->opened(q->ctx, x);
    if (st == ST_OK && !q->header_only)
        st = read_values(m, surface, p, x);
    const mesh_hints *hints = &q->hints.mesh;
    const char *asked = hints->field ? hints->field : t.by_default;
    text_name(x->field, sizeof x->field, x->read ? own->report.field : asked);
    for (uint32_t i = 0; i < x->field_count && i < INPUT_FACTS_FIELDS; i++)
        if (strcmp(x->fields[i].name, x->field) == 0)
            x->components = x->fields[i].components;
    x->component = (uint32_t)hints->component;
    return st;
}

/* ---- what is told ---- */

static void print_counts(const input_facts *x, const fact_sheet *to) {
    const facts *own = facts_of(x);
    const mesh_report *r = &own->report;
    if (own->counted && !x->read)
        fact_sheet_line(to, "surface", "%llu faces, %llu points by the header",
                        (unsigned long long)own->faces, (unsigned long long)own->vertices);
    if (!x->read)
        return;
    fact_sheet_line(to, "surface", "%llu triangles, %llu points", (unsigned long long)r->tets,
                    (unsigned long long)r->points);
    if (r->polygons)
        fact_sheet_line(to, "polygons", "%llu of four or more corners, cut into triangles%s",
                        (unsigned long long)r->polygons,
                        r->fanned ? "; some as if they were convex" : "");
    if (r->bad_indices + r->repeated)
        fact_sheet_line(to, "left out",
                        "%llu with an id that is no point, %llu with a vertex twice",
                        (unsigned long long)r->bad_indices, (unsigned long long)r->repeated);
    if (r->skipped + r->ghosts)
        fact_sheet_line(to, "skipped",
                        "%llu points and lines, %llu cells of other pieces or hidden",
                        (unsigned long long)r->skipped, (unsigned long long)r->ghosts);
}

static void print_surface(const input_facts *x, const fact_sheet *to) {
    const facts *own = facts_of(x);
    char n[2][NUM_TEXT_MAX];
    print_counts(x, to);
    if (x->field_count == 0)
        fact_sheet_line(to, "fields", "none");
    for (int a = 0; a < 3 && x->read && own->report.points > 0; a++)
        fact_sheet_line(to, a ? "" : "bounds", "%s .. %s", num_print((double)own->bounds[a], n[0]),
                        num_print((double)own->bounds[a + 3], n[1]));
}

static void tell(const input_facts *x, const fact_sheet *to) {
    const facts *own = facts_of(x);
    const mesh_report *r = &own->report;
    double bounds[6];
    for (int i = 0; i < 6; i++)
        bounds[i] = (double)own->bounds[i];
    print_surface(x, to);
    fact_sheet_reals(to, "bounds", bounds, x->read && r->points > 0 ? 6 : 0);
    if (own->counted)
        fact_sheet_whole(to, "faces", own->faces);
    if (x->read || own->counted)
        fact_sheet_whole(to, "vertices", x->read ? r->points : own->vertices);
    if (!x->read)
        return;
    fact_sheet_whole(to, "triangles", r->tets);
    fact_sheet_whole(to, "polygons", r->polygons);
    fact_sheet_whole(to, "fanned", r->fanned);
    fact_sheet_whole(to, "repeated", r->repeated);
    fact_sheet_whole(to, "bad", r->bad_indices);
    fact_sheet_whole(to, "skipped", r->skipped);
    fact_sheet_whole(to, "ghosts", r->ghosts);
}

const input_facts_kind surface_input_facts_kind = {
    .of = &surface_input_kind, .drawn = "values", .ask = ask, .tell = tell};
