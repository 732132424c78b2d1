#include "formats/mesh/mesh_input_facts.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "formats/base/num.h"
#include "formats/base/text.h"
#include "formats/input_collect.h"
#include "formats/leaf/histogram_draw.h"
#include "formats/mesh/mesh_input.h"
#include "formats/mesh/mesh_input_kind.h"

_Static_assert(sizeof(mesh_input_facts) <= sizeof((input_facts *)NULL)->own, "there is room");

const mesh_input_facts *mesh_input_facts_of(const input_facts *x) {
    return (const mesh_input_facts *)(const void *)x->own.bytes;
}

static mesh_input_facts *own_of(input_facts *x) {
    return (mesh_input_facts *)(void *)x->own.bytes;
}

/* ---- the values ---- */

/* Positions and values of all points, and every step-th tet, few enough for the room. */
typedef struct gathered {
    mem *m;
    mesh_input *mesh;
    const progress *p;
    input_facts *x;
    float (*xyz)[3];
    float *values;
    size_t xyz_room, value_room, points;
    uint32_t (*ids)[4];
    uint64_t tets, step;
    uint32_t kept;
} gathered;

static status grow(mem *m, void **array, size_t *room, size_t need, size_t size) {
    if (need <= *room)
        return ST_OK;
    const size_t more = need > 2 * *room ? need : 2 * *room;
    void *larger = mem_array(m, more, size);
    if (!larger)
        return ST_NOMEM;
    if (*array)
        memcpy(larger, *array, *room * size);
    mem_free(m, *array);
    *array = larger;
    *room = more;
    return ST_OK;
}

static status take_points(void *ctx, uint64_t first, size_t count, const float (*xyz)[3]) {
    gathered *g = ctx;
    void *array = g->xyz;
    status st = grow(g->m, &array, &g->xyz_room, (size_t)first + count, sizeof *g->xyz);
    g->xyz = array;
    if (st != ST_OK)
        return st;
    memcpy(g->xyz + first, xyz, count * sizeof *xyz);
    g->points = (size_t)first + count;
    for (size_t i = 0; i < count; i++)
        for (int a = 0; a < 3; a++) {
            own_of(g->x)->bounds[a] = fminf(own_of(g->x)->bounds[a], xyz[i][a]);
            own_of(g->x)->bounds[a + 3] = fmaxf(own_of(g->x)->bounds[a + 3], xyz[i][a]);
        }
    return progress_step(g->p, "reading", mesh_input_share(g->mesh));
}

static status take_values(void *ctx, uint64_t first, size_t count, const float *values) {
    gathered *g = ctx;
    void *array = g->values;
    status st = grow(g->m, &array, &g->value_room, (size_t)first + count, sizeof *g->values);
    g->values = array;
    if (st != ST_OK)
        return st;
    memcpy(g->values + first, values, count * sizeof *values);
    for (size_t i = 0; i < count; i++)
        input_collect_value(g->x, (double)values[i]);
    return progress_step(g->p, "reading", mesh_input_share(g->mesh));
}

/* Drop every other tet that is kept. */
static void thin(gathered *g) {
    for (uint32_t i = 0; i < g->kept; i += 2)
        memcpy(g->ids[i / 2], g->ids[i], sizeof *g->ids);
    g->kept = (g->kept + 1) / 2;
    g->step *= 2;
}

static status take_tets(void *ctx, size_t count, const uint32_t (*ids)[4]) {
    gathered *g = ctx;
    for (size_t i = 0; i < count; i++, g->tets++) {
        if (g->kept == HISTOGRAM_TETS)
            thin(g);
        if (g->tets % g->step == 0)
            memcpy(g->ids[g->kept++], ids[i], sizeof *g->ids);
    }
    return progress_step(g->p, "reading", mesh_input_share(g->mesh));
}

static status count_tets(gathered *g) {
    histogram_cell *cells = mem_array(g->m, g->kept, sizeof *cells);
    if (!cells)
        return ST_NOMEM;
    for (uint32_t i = 0; i < g->kept; i++) {
        const float *corners[4];
        float values[4];
        for (int c = 0; c < 4; c++) {
            corners[c] = g->xyz[g->ids[i][c]];
            values[c] = g->values[g->ids[i][c]];
        }
        cells[i] = histogram_tet(corners, values);
    }
    histogram_build(&g->x->values, cells, g->kept, SAMPLE_F32, g->x->range, g->tets);
    mem_free(g->m, cells);
    return ST_OK;
}

static status count_mesh(mem *m, mesh_input *x, const progress *p, input_facts *out) {
    gathered g = {.m = m, .mesh = x, .p = p, .x = out, .step = 1};
    const mesh_sink sink = {.ctx = &g,
                            .points = take_points,
                            .values = take_values,
                            .tets = take_tets,
                            .corners = true};
    g.ids = mem_array(m, HISTOGRAM_TETS, sizeof *g.ids);
    status st = g.ids ? mesh_input_read(x, &sink, &own_of(out)->report) : ST_NOMEM;
    if (st == ST_OK)
        st = count_tets(&g);
    out->needs_whole = own_of(out)->report.whole[CELL_QUADRATIC_TET] > 0;
    mem_free(m, g.ids);
    mem_free(m, g.xyz);
    mem_free(m, g.values);
    return st;
}

/* A name that comes again is another piece or step of that field. */
static void take_array(void *ctx, const char *name, int components) {
    input_facts *x = ctx;
    const uint32_t before = x->field_count;
    input_collect_field(x, name, (uint32_t)components);
    if (*name && x->field_count == before)
        input_collect_listed(x, name)->steps++;
}

/* listed: the format lists the array of each step. A field of one array has it at all steps. */
static void take_mesh_steps(input_facts *x, bool listed, uint32_t steps, const double *times) {
    x->steps = steps;
    for (uint32_t i = 0; i < x->field_count && i < INPUT_FACTS_FIELDS; i++)
        if (!listed || x->fields[i].steps == 1 || steps == 1)
            x->fields[i].steps = steps;
    if (times)
        input_collect_times(x, steps, times);
}

static status ask(mem *m, void *input, const input_question *q, const progress *p, input_facts *x) {
    mesh_input *found = input;
    status st = ST_OK;
    *own_of(x) =
        (mesh_input_facts){.bounds = {FLT_MAX, FLT_MAX, FLT_MAX, -FLT_MAX, -FLT_MAX, -FLT_MAX}};
    input_collect_name(x, mesh_input_name(found));
    mesh_input_fields(found, take_array, x);
    x->lacks_values = x->field_count == 0;
    take_mesh_steps(x, !mesh_input_names_files(found), mesh_input_steps(found),
                    mesh_input_times(found));
    if (q->opened)
        st = q->opened(q->ctx, x);
    if (st == ST_OK && !q->header_only)
        st = count_mesh(m, found, p, x);
    const mesh_hints *hints = &q->hints.mesh;
    const char *asked = hints->field ? hints->field : x->field_count ? x->fields[0].name : "";
    text_name(x->field, sizeof x->field, x->read ? own_of(x)->report.field : asked);
    for (uint32_t i = 0; i < x->field_count && i < INPUT_FACTS_FIELDS; i++)
        if (strcmp(x->fields[i].name, x->field) == 0)
            x->components = x->fields[i].components;
    x->component = (uint32_t)hints->component;
    return st;
}

/* ---- what is told ---- */

static void print_mesh(const input_facts *x, const fact_sheet *to) {
    const mesh_input_facts *own = mesh_input_facts_of(x);
    const mesh_report *r = &own->report;
    char n[2][NUM_TEXT_MAX];
    if (x->read)
        fact_sheet_line(to, "mesh", "%llu tets, %llu points", (unsigned long long)r->tets,
                        (unsigned long long)r->points);
    if (x->read && r->whole[CELL_QUADRATIC_TET])
        fact_sheet_line(to, "quadratic", "%llu of the tets, of which the corners count here",
                        (unsigned long long)r->whole[CELL_QUADRATIC_TET]);
    if (x->read && r->ghosts)
        fact_sheet_line(to, "ghosts", "%llu cells of other pieces, or hidden, are left out",
                        (unsigned long long)r->ghosts);
    if (x->field_count == 0)
        fact_sheet_line(to, "fields", "none");
    for (int a = 0; a < 3 && x->read && r->points > 0; a++)
        fact_sheet_line(to, a ? "" : "bounds", "%s .. %s", num_print((double)own->bounds[a], n[0]),
                        num_print((double)own->bounds[a + 3], n[1]));
}

static void tell(const input_facts *x, const fact_sheet *to) {
    const mesh_input_facts *own = mesh_input_facts_of(x);
    const mesh_report *r = &own->report;
    double bounds[6];
    for (int i = 0; i < 6; i++)
        bounds[i] = (double)own->bounds[i];
    print_mesh(x, to);
    fact_sheet_reals(to, "bounds", bounds, x->read && r->points > 0 ? 6 : 0);
    if (!x->read)
        return;
    fact_sheet_whole(to, "tets", r->tets);
    fact_sheet_whole(to, "quadratic", r->whole[CELL_QUADRATIC_TET]);
    fact_sheet_whole(to, "vertices", r->points);
    fact_sheet_whole(to, "repeated", r->repeated);
    fact_sheet_whole(to, "bad", r->bad_indices);
    fact_sheet_whole(to, "ghosts", r->ghosts);
}

const input_facts_kind mesh_input_facts_kind = {
    .of = &mesh_input_kind, .drawn = "tets", .ask = ask, .tell = tell};
