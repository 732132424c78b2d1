#include "formats/curvilinear/curvilinear_input_facts.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "formats/base/num.h"
#include "formats/base/text.h"
#include "formats/curvilinear/curvilinear_input.h"
#include "formats/curvilinear/curvilinear_input_kind.h"
#include "formats/input_collect.h"
#include "formats/leaf/histogram_draw.h"

_Static_assert(sizeof(curvilinear_input_facts) <= sizeof((input_facts *)NULL)->own,
               "there is room");

const curvilinear_input_facts *curvilinear_input_facts_of(const input_facts *x) {
    return (const curvilinear_input_facts *)(const void *)x->own.bytes;
}

static curvilinear_input_facts *own_of(input_facts *x) {
    return (curvilinear_input_facts *)(void *)x->own.bytes;
}

/* ---- planes ---- */

/* A plane of a zone, and whether each is a node. */
typedef struct plane {
    float (*places)[3];
    float *values;
    uint8_t *is_node;
} plane;

/* A pass over all planes. */
typedef struct sweep {
    const curvilinear_source *from;
    input_facts *x;
    const progress *p;
    plane planes[2]; /* plane k of a zone is planes[k % 2] */
    histogram_run run;
    histogram_cell *cells;
    uint32_t drawn;  /* how many of them are measured */
    uint64_t before; /* nodes of the planes before */
} sweep;

static uint64_t plane_nodes(const uint32_t nodes[3]) {
    return (uint64_t)nodes[0] * nodes[1];
}

static status make_planes(mem *m, sweep *s) {
    uint64_t most = 0;
    for (uint32_t z = 0; z < s->from->zones; z++)
        most = plane_nodes(s->from->nodes[z]) > most ? plane_nodes(s->from->nodes[z]) : most;
    for (int i = 0; i < 2; i++) {
        plane *p = &s->planes[i];
        p->places = mem_array(m, most, sizeof *p->places);
        p->values = mem_array(m, most, sizeof *p->values);
        p->is_node = mem_array(m, most, 1);
        if (!p->places || !p->values || !p->is_node)
            return ST_NOMEM;
        memset(p->is_node, 1, most);
    }
    return ST_OK;
}

static void free_planes(mem *m, sweep *s) {
    for (int i = 0; i < 2; i++) {
        mem_free(m, s->planes[i].places);
        mem_free(m, s->planes[i].values);
        mem_free(m, s->planes[i].is_node);
    }
}

static status read_plane(const curvilinear_source *from, uint32_t zone, uint32_t k, plane *p) {
    status st = from->places(from->own, zone, k, 1, p->places);
    if (st == ST_OK)
        st = from->values(from->own, zone, 0, k, 1, p->values);
    if (st == ST_OK && from->blanked)
        st = from->blanks(from->own, zone, k, 1, p->is_node);
    return st;
}

static void collect_plane(input_facts *x, const plane *p, uint64_t count) {
    curvilinear_input_facts *own = own_of(x);
    for (uint64_t n = 0; n < count; n++) {
        own->blanked += !p->is_node[n];
        if (!p->is_node[n])
            continue;
        input_collect_value(x, (double)p->values[n]);
        for (int a = 0; a < 3; a++) {
            own->bounds[a] = fminf(own->bounds[a], p->places[n][a]);
            own->bounds[a + 3] = fmaxf(own->bounds[a + 3], p->places[n][a]);
        }
    }
}

/* ---- cells ---- */

/* Returns whether all corners of the cell from node n of plane k on are nodes. */
static bool is_cell(const sweep *s, const uint32_t nodes[3], uint32_t k, uint64_t n) {
    const uint8_t *low = s->planes[k % 2].is_node + n, *high = s->planes[(k + 1) % 2].is_node + n;
    const uint32_t row = nodes[0];
    return !(low[0] & CURVILINEAR_HIDDEN) && low[0] && low[1] && low[row] && low[row + 1] &&
           high[0] && high[1] && high[row] && high[row + 1];
}

static uint64_t count_cells(const sweep *s, const uint32_t nodes[3], uint32_t k) {
    uint64_t count = 0;
    for (uint64_t j = 0; j + 1 < nodes[1]; j++)
        for (uint32_t i = 0; i + 1 < nodes[0]; i++)
            count += is_cell(s, nodes, k, j * nodes[0] + i);
    return count;
}

/* A node where no cell begins, or one that is not finite. */
static histogram_cell node_alone(float value) {
    return (histogram_cell){.value = value, .lo = INFINITY, .hi = -INFINITY};
}

/* Measure node n of plane k, and the cell that begins there if there is one. */
static histogram_cell measure(const sweep *s, const uint32_t nodes[3], uint32_t k, uint64_t n) {
    const plane *at = &s->planes[k % 2];
    const bool inside =
        k + 1 < nodes[2] && n % nodes[0] + 1 < nodes[0] && n / nodes[0] + 1 < nodes[1];
    const float *corners[8];
    float values[8];
    if (!inside || !is_cell(s, nodes, k, n))
        return node_alone(at->is_node[n] && isfinite(at->values[n]) ? at->values[n] : NAN);
    for (uint32_t c = 0; c < 8; c++) {
        const plane *p = &s->planes[(k + (c >> 2)) % 2];
        const uint64_t node = n + (c & 1) + (c >> 1 & 1) * nodes[0];
        corners[c] = p->places[node];
        values[c] = p->values[node];
    }
    histogram_cell cell = histogram_hex(corners, values);
    cell.value = isfinite(values[0]) ? values[0] : NAN;
    return cell;
}

/* Measure the nodes of plane k that are drawn. The next plane is there, or it is the last. */
static void draw_plane(sweep *s, const uint32_t nodes[3], uint32_t k) {
    const uint64_t count = plane_nodes(nodes);
    for (; s->drawn < s->run.count; s->drawn++) {
        const uint64_t node = histogram_draw_tet(&s->run, s->drawn) - s->before;
        if (node >= count)
            break;
        s->cells[s->drawn] = measure(s, nodes, k, node);
    }
    s->before += count;
}

static status sweep_zone(sweep *s, uint32_t zone) {
    const uint32_t *nodes = s->from->nodes[zone];
    curvilinear_input_facts *own = own_of(s->x);
    for (uint32_t k = 0; k <= nodes[2]; k++) {
        plane *p = &s->planes[k % 2];
        status st = k < nodes[2] ? read_plane(s->from, zone, k, p) : ST_OK;
        if (st != ST_OK)
            return st;
        if (k < nodes[2])
            collect_plane(s->x, p, plane_nodes(nodes));
        if (k > 0 && k < nodes[2])
            own->cells += count_cells(s, nodes, k - 1);
        if (k > 0)
            draw_plane(s, nodes, k - 1);
        st = progress_step(s->p, "reading", (double)s->before / (double)own->total);
        if (st != ST_OK)
            return st;
    }
    return ST_OK;
}

static status count_grid(mem *m, const curvilinear_source *from, const progress *p,
                         input_facts *x) {
    sweep s = {.from = from, .x = x, .p = p};
    s.run = histogram_draw_tets(own_of(x)->total, 1);
    s.cells = mem_array(m, s.run.count, sizeof *s.cells);
    status st = make_planes(m, &s);
    if (!s.cells)
        st = ST_NOMEM;
    for (uint32_t z = 0; st == ST_OK && z < from->zones; z++)
        st = sweep_zone(&s, z);
    if (st == ST_OK)
        histogram_build(&x->values, s.cells, s.run.count, SAMPLE_F32, x->range, own_of(x)->total);
    mem_free(m, s.cells);
    free_planes(m, &s);
    return st;
}

/* ---- the facts ---- */

static void take_zones(curvilinear_input_facts *own, const curvilinear_source *from) {
    *own = (curvilinear_input_facts){
        .zones = from->zones, .bounds = {FLT_MAX, FLT_MAX, FLT_MAX, -FLT_MAX, -FLT_MAX, -FLT_MAX}};
    for (uint32_t z = 0; z < from->zones; z++) {
        own->total += plane_nodes(from->nodes[z]) * from->nodes[z][2];
        if (z < CURVILINEAR_FACTS_ZONES)
            memcpy(own->nodes[z], from->nodes[z], sizeof own->nodes[z]);
    }
}

static void take_fields(input_facts *x, curvilinear_input *from) {
    const double *times;
    uint32_t components;
    for (uint32_t i = 0; i < curvilinear_input_fields(from); i++) {
        const char *name = curvilinear_input_field(from, i, &components);
        input_collect_field(x, name, components);
    }
    for (uint32_t i = 0; i < x->field_count && i < INPUT_FACTS_FIELDS; i++)
        x->fields[i].steps = curvilinear_input_steps(from, &times);
    x->lacks_values = x->field_count == 0;
    text_name(x->field, sizeof x->field, curvilinear_input_taken(from, 0, &x->component));
    const input_field *taken = *x->field ? input_collect_listed(x, x->field) : NULL;
    x->components = taken ? taken->components : 1;
}

static status ask(mem *m, void *input, const input_question *q, const progress *p, input_facts *x) {
    curvilinear_input_facts *own = own_of(x);
    const curvilinear_source *from = curvilinear_input_source(input);
    const double *flow = curvilinear_input_conditions(input), *times;
    status st = ST_OK;
    take_zones(own, from);
    own->flows = flow != NULL;
    if (flow)
        memcpy(own->flow, flow, sizeof own->flow);
    input_collect_name(x, curvilinear_input_name(input));
    take_fields(x, input);
    x->steps = curvilinear_input_steps(input, &times);
    if (times && x->steps > 1)
        input_collect_times(x, x->steps, times);
    text_name(x->frame.time_unit, sizeof x->frame.time_unit, curvilinear_input_time_unit(input));
    if (q->opened)
        st = q->opened(q->ctx, x);
    if (st == ST_OK && !q->header_only)
        st = count_grid(m, from, p, x);
    return st;
}

static void print_zones(const curvilinear_input_facts *own, const fact_sheet *to) {
    for (uint32_t z = 0; z < own->zones && z < CURVILINEAR_FACTS_ZONES; z++)
        fact_sheet_line(to, z ? "" : "zones", "%u x %u x %u nodes", own->nodes[z][0],
                        own->nodes[z][1], own->nodes[z][2]);
    if (own->zones > CURVILINEAR_FACTS_ZONES)
        fact_sheet_line(to, "", ".. %u in all", own->zones);
}

static void print_grid(const input_facts *x, const fact_sheet *to) {
    const curvilinear_input_facts *own = curvilinear_input_facts_of(x);
    char n[4][NUM_TEXT_MAX];
    print_zones(own, to);
    if (x->read)
        fact_sheet_line(to, "grid", "%llu nodes, %llu cells", (unsigned long long)own->total,
                        (unsigned long long)own->cells);
    if (x->read && own->blanked)
        fact_sheet_line(to, "blanked", "%llu nodes are no part of the grid",
                        (unsigned long long)own->blanked);
    if (own->flows)
        fact_sheet_line(to, "flow", "Mach %s, angle of attack %s, Reynolds number %s, time %s",
                        num_print(own->flow[0], n[0]), num_print(own->flow[1], n[1]),
                        num_print(own->flow[2], n[2]), num_print(own->flow[3], n[3]));
    if (x->field_count == 0)
        fact_sheet_line(to, "fields", "none");
    for (int a = 0; a < 3 && x->read && own->bounds[0] <= own->bounds[3]; a++)
        fact_sheet_line(to, a ? "" : "bounds", "%s .. %s", num_print((double)own->bounds[a], n[0]),
                        num_print((double)own->bounds[a + 3], n[1]));
}

static json_t *zones_json(const curvilinear_input_facts *own) {
    json_t *zones = json_array();
    for (uint32_t z = 0; z < own->zones && z < CURVILINEAR_FACTS_ZONES; z++)
        json_array_append_new(zones, json_pack("[I, I, I]", (json_int_t)own->nodes[z][0],
                                               (json_int_t)own->nodes[z][1],
                                               (json_int_t)own->nodes[z][2]));
    return zones;
}

static void tell(const input_facts *x, const fact_sheet *to) {
    const curvilinear_input_facts *own = curvilinear_input_facts_of(x);
    double bounds[6];
    for (int i = 0; i < 6; i++)
        bounds[i] = (double)own->bounds[i];
    print_grid(x, to);
    if (to->values)
        fact_sheet_json(to, "zones", zones_json(own));
    fact_sheet_whole(to, "nodes", own->total);
    fact_sheet_reals(to, "flow", own->flow, own->flows ? 4 : 0);
    fact_sheet_reals(to, "bounds", bounds, x->read && own->bounds[0] <= own->bounds[3] ? 6 : 0);
    if (!x->read)
        return;
    fact_sheet_whole(to, "cells", own->cells);
    fact_sheet_whole(to, "blanked", own->blanked);
}

const input_facts_kind curvilinear_input_facts_kind = {
    .of = &curvilinear_input_kind, .drawn = "nodes", .ask = ask, .tell = tell};
