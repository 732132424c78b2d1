#include "formats/curvilinear/plot3d.h"

#include <math.h>
#include <stdio.h>

#include "formats/curvilinear/plot3d_file.h"
#include "formats/curvilinear/plot3d_flow.h"

typedef struct plot3d {
    mem *m;
    plot3d_words words;
    plot3d_file grid, solution, functions; /* .f is NULL: there is none */
    uint32_t steps;
    double *times; /* of each; NULL: it has no solution */
    double conditions[PLOT3D_CONDITIONS];
    char name[32]; /* of the field last asked for */
    double numbers[PLOT3D_FLOW_NUMBERS][PLOT3D_CHUNK];
    int32_t blanks[PLOT3D_CHUNK];
} plot3d;

/* Whether so many bytes may be text of so many numbers, or of a third more: with IBLANK. */
static bool may_hold(uint64_t bytes, uint64_t numbers) {
    enum { BYTES_MOST = 64 }; /* of a number */
    return numbers <= bytes / 2 + 1 && bytes / BYTES_MOST <= numbers + numbers / 2;
}

enum { TEXT_ZONES = 2000 }; /* of more a word must tell that it is text */

/* Numbers are counted when it is opened. What begins with whole numbers is a grid if as many bytes
 * follow as it may have: other tables of numbers have other sizes. */
static bool is_text(const uint8_t *start, size_t size, uint64_t bytes) {
    uint8_t wholes[4 * (1 + 3 * TEXT_ZONES)];
    bool is = false;
    if (!plot3d_text_known(start, size))
        return false;
    const size_t count = plot3d_text_wholes_at(start, size, sizeof wholes / 4, wholes);
    for (unsigned multi = 0; multi <= PLOT3D_MULTI && !is; multi += PLOT3D_MULTI) {
        plot3d_head h;
        is = plot3d_head_read(PLOT3D_GRID, PLOT3D_TEXT | multi, wholes, 4 * count, &h) &&
             may_hold(bytes, h.length);
    }
    return is;
}

static bool known(const char *path, const uint8_t *start, size_t size, uint64_t bytes) {
    (void)path;
    plot3d_head heads[PLOT3D_LAYOUTS];
    return plot3d_head_find(PLOT3D_GRID, &(plot3d_words){0}, 0, start, size, bytes, 0, heads) ==
               1 ||
           is_text(start, size, bytes);
}

static void close_files(void *state) {
    plot3d *p = state;
    if (!p)
        return;
    plot3d_file_release(&p->grid);
    plot3d_file_release(&p->solution);
    plot3d_file_release(&p->functions);
    mem_free(p->m, p->times);
    mem_free(p->m, p);
}

/* ---- steps ---- */

/* The file of a step: one file may be for all of them. NULL: there is none. */
static const char *file_of(const path_list *files, uint32_t step) {
    return files->count == 0 ? NULL : files->paths[files->count == 1 ? 0 : step];
}

static status open_with(plot3d *p, const path_list *files, uint32_t step, plot3d_content content,
                        plot3d_file *out) {
    const char *path = file_of(files, step);
    return path ? plot3d_file_open(p->m, path, content, &p->words, &p->grid, out) : ST_OK;
}

/* Open what goes with the grid at a step. */
static status open_step(plot3d *p, const curvilinear_hints *h, uint32_t step) {
    plot3d_file_release(&p->solution);
    plot3d_file_release(&p->functions);
    status st = open_with(p, &h->solutions, step, PLOT3D_SOLUTION, &p->solution);
    if (st == ST_OK && p->solution.f)
        st = plot3d_file_conditions(&p->solution, p->conditions);
    if (st == ST_OK)
        st = open_with(p, &h->functions, step, PLOT3D_FUNCTIONS, &p->functions);
    return st;
}

static status count_steps(plot3d *p, const curvilinear_hints *h) {
    const int solutions = h->solutions.count, functions = h->functions.count;
    if (solutions > 1 && functions > 1 && solutions != functions)
        return status_describe(ST_USAGE,
                               "%s: %d solutions and %d files of functions, expected as many of "
                               "both, or one",
                               file_path(p->grid.f), solutions, functions);
    const int most = solutions > functions ? solutions : functions;
    p->steps = most > 1 ? (uint32_t)most : 1;
    return ST_OK;
}

/* Open the files of all steps: one that is absent, or of another grid, must not show up after
 * hours. Note their times. */
static status look_at_steps(plot3d *p, const curvilinear_hints *h) {
    status st = ST_OK;
    p->times = h->solutions.count ? mem_array(p->m, p->steps, sizeof *p->times) : NULL;
    if (h->solutions.count && !p->times)
        return ST_NOMEM;
    for (uint32_t i = 0; st == ST_OK && i < p->steps; i++) {
        st = open_step(p, h, i);
        if (p->times)
            p->times[i] = p->conditions[PLOT3D_CONDITIONS - 1];
    }
    return st;
}

static status seek_step(curvilinear_opening *o, void *state) {
    plot3d *p = state;
    const curvilinear_hints *h = &o->hints;
    if (h->step >= p->steps)
        return status_describe(ST_USAGE, "%s: no step %u: there %s %u, counted from 0",
                               file_path(p->grid.f), h->step, p->steps == 1 ? "is" : "are",
                               p->steps);
    const status st = open_step(p, h, h->step);
    o->fields = (p->solution.f ? PLOT3D_FLOWS : 0) + p->functions.numbers;
    return st;
}

static uint32_t tell_steps(const void *state, const double **times) {
    const plot3d *p = state;
    *times = p->times;
    return p->steps;
}

static status open_files(curvilinear_opening *o, void **state) {
    plot3d *p = *state = mem_zalloc(o->m, sizeof *p);
    if (!p)
        return ST_NOMEM;
    p->m = o->m;
    const curvilinear_hints *h = &o->hints;
    status st = plot3d_words_parse(h->layout, &p->words);
    if (st == ST_OK)
        st = plot3d_file_open(o->m, byte_stream_path(o->data), PLOT3D_GRID, &p->words, NULL,
                              &p->grid);
    o->zones = p->grid.zones;
    o->nodes = (const uint32_t(*)[3])p->grid.nodes;
    o->blanked = p->grid.layout & PLOT3D_BLANKS;
    o->still = true;
    if (st == ST_OK)
        st = count_steps(p, h);
    if (st == ST_OK && p->steps > 1)
        st = look_at_steps(p, h);
    return st == ST_OK ? seek_step(o, p) : st;
}

static const double *conditions(const void *state) {
    const plot3d *p = state;
    return p->solution.f ? p->conditions : NULL;
}

/* ---- fields ---- */

/* A field: of the solution, or else one of the functions. */
static const plot3d_flow *find_flow(const plot3d *p, uint32_t *field) {
    if (p->solution.f && *field < PLOT3D_FLOWS)
        return &plot3d_flows[*field];
    *field -= p->solution.f ? PLOT3D_FLOWS : 0;
    return NULL;
}

static const char *name_field(void *state, uint32_t field, uint32_t *components) {
    plot3d *p = state;
    const plot3d_flow *flow = find_flow(p, &field);
    *components = flow ? flow->components : 1;
    snprintf(p->name, sizeof p->name, "function_%u", field + 1);
    return flow ? flow->name : p->name;
}

/* ---- planes ---- */

/* The nodes of some planes of a zone, a chunk at a time. */
typedef struct chunk {
    uint64_t first, end, at;
    size_t count;
} chunk;

static chunk begin_chunks(const plot3d *p, uint32_t zone, uint32_t first, uint32_t count) {
    const uint32_t *n = p->grid.nodes[zone];
    const uint64_t plane = (uint64_t)n[0] * n[1];
    const uint64_t from = first * plane;
    return (chunk){.first = from, .end = from + count * plane, .at = from};
}

static bool next_chunk(chunk *c) {
    c->at += c->count;
    c->count = c->end - c->at < PLOT3D_CHUNK ? (size_t)(c->end - c->at) : (size_t)PLOT3D_CHUNK;
    return c->count > 0;
}

static status read_numbers(plot3d *p, plot3d_file *f, uint32_t zone, uint32_t number,
                           const chunk *c) {
    return plot3d_file_read(f, zone, number, c->at, c->count, p->numbers[number]);
}

static status refuse_place(const plot3d *p, uint32_t zone, uint64_t node, int axis, double x) {
    const uint32_t *n = p->grid.nodes[zone];
    const uint64_t row = node / n[0];
    return status_describe(ST_CORRUPT,
                           "%s: zone %u: node %llu %llu %llu: %c is %g, expected a finite number "
                           "that a float holds",
                           file_path(p->grid.f), zone + 1, (unsigned long long)(node % n[0]),
                           (unsigned long long)(row % n[1]), (unsigned long long)(row / n[1]),
                           "xyz"[axis], x);
}

static status read_places(void *state, uint32_t zone, uint32_t first, uint32_t count,
                          float (*out)[3]) {
    plot3d *p = state;
    chunk c = begin_chunks(p, zone, first, count);
    while (next_chunk(&c))
        for (int a = 0; a < 3; a++) {
            status st = read_numbers(p, &p->grid, zone, (uint32_t)a, &c);
            if (st != ST_OK)
                return st;
            for (size_t i = 0; i < c.count; i++) {
                const double x = p->numbers[a][i];
                out[c.at - c.first + i][a] = (float)x;
                if (!isfinite((float)x))
                    return refuse_place(p, zone, c.at + i, a, x);
            }
        }
    return ST_OK;
}

/* Compute a field of the solution at the nodes of a chunk. */
static void compute_flow(plot3d *p, const plot3d_flow *flow, uint32_t component, size_t count,
                         float *out) {
    const bool stored = flow < &plot3d_flows[3];
    for (size_t i = 0; i < count; i++) {
        double q[PLOT3D_FLOW_NUMBERS], v[3] = {0, 0, 0};
        for (int k = 0; k < PLOT3D_FLOW_NUMBERS; k++)
            q[k] = p->numbers[k][i];
        flow->of(q, v);
        const double value = flow->components == 1 ? v[0]
                             : component           ? v[component - 1]
                                                   : sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
        out[i] = stored || isfinite(value) ? (float)value : NAN;
    }
}

static status read_values(void *state, uint32_t zone, uint32_t field, uint32_t component,
                          uint32_t first, uint32_t count, float *out) {
    plot3d *p = state;
    const plot3d_flow *flow = find_flow(p, &field);
    chunk c = begin_chunks(p, zone, first, count);
    while (next_chunk(&c)) {
        status st = ST_OK;
        float *to = out + (c.at - c.first);
        for (uint32_t k = 0; st == ST_OK && flow && k < PLOT3D_FLOW_NUMBERS; k++)
            st = read_numbers(p, &p->solution, zone, k, &c);
        if (!flow)
            st = plot3d_file_read(&p->functions, zone, field, c.at, c.count, p->numbers[0]);
        if (st != ST_OK)
            return st;
        if (flow)
            compute_flow(p, flow, component, c.count, to);
        for (size_t i = 0; !flow && i < c.count; i++)
            to[i] = (float)p->numbers[0][i];
    }
    return ST_OK;
}

static status read_blanks(void *state, uint32_t zone, uint32_t first, uint32_t count,
                          uint8_t *out) {
    plot3d *p = state;
    chunk c = begin_chunks(p, zone, first, count);
    while (next_chunk(&c)) {
        status st = plot3d_file_blanks(&p->grid, zone, c.at, c.count, p->blanks);
        if (st != ST_OK)
            return st;
        for (size_t i = 0; i < c.count; i++)
            out[c.at - c.first + i] = p->blanks[i] != 0;
    }
    return ST_OK;
}

const curvilinear_reader plot3d_reader = {
    .format = "PLOT3D",
    .known = known,
    .open = open_files,
    .close = close_files,
    .field = name_field,
    .places = read_places,
    .values = read_values,
    .blanks = read_blanks,
    .steps = tell_steps,
    .seek = seek_step,
    .conditions = conditions,
};
