#include "prep/curvilinear/curvilinear_convert.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/hash.h"
#include "formats/base/hexahedron.h"
#include "formats/base/pool.h"
#include "formats/leaf/curvilinear_coder.h"
#include "formats/leaf/curvilinear_draw.h"
#include "formats/leaf/curvilinear_geometry.h"
#include "formats/leaf/hex_treelet.h"
#include "prep/curvilinear/curvilinear_coarse.h"
#include "prep/curvilinear/curvilinear_slab.h"
#include "prep/further_step.h"

#ifndef LEAFCAST_VERSION
#define LEAFCAST_VERSION "0"
#endif

/* A treelet's cells in its zone, and the number of the first one of all. */
typedef struct place {
    uint32_t first[3], cells[3];
    uint64_t number;
} place;

/* The cells that histograms draw (curvilinear_draw.h). */
typedef struct drawing {
    histogram_run run;
    float (*corners)[HISTOGRAM_CORNERS][3]; /* per run, of this step; NULL: none are drawn */
    histogram_cell *cells;                  /* of each set, per run */
} drawing;

typedef struct conversion {
    mem *m;
    const curvilinear_series *series;
    const curvilinear_options *o;
    const progress *p;
    leaf_writer *writer;
    pool *workers;
    curvilinear_slab slab;
    drawing drawing;
    bool moving;
    uint32_t zones, (*nodes)[3]; /* of the first step */
    uint64_t passes, passed;     /* over all zones: to do, done */
    /* The zone that is gone through: */
    uint32_t before; /* treelets of the zones before it */
    uint32_t count;
    uint64_t cells;  /* of the zones up to it */
    place *places;   /* per treelet; room for any zone */
    uint32_t *layer; /* the treelets of the layer in memory */
    /* What the pass puts: */
    uint32_t step, set;
    /* Per thread: */
    char **rooms; /* for a payload, and the same compressed */
    leaf_packer **packers;
    leaf_unpacker **unpackers; /* of the file that is added to */
    uint64_t (*codes)[4];      /* cells of each code */
    bool *any;                 /* it has put a number */
} conversion;

/* ---- the plan ---- */

static leaf_curvilinear contents(const curvilinear_series *s, const curvilinear_source *first,
                                 const curvilinear_options *o) {
    return (leaf_curvilinear){
        .sets = s->sets, .zones = first->zones, .nodes = first->nodes, .coarse = o->coarse};
}

/* Counts of the largest treelet. */
static const uint32_t whole[4] = {CURVILINEAR_SIDE, CURVILINEAR_SIDE, CURVILINEAR_SIDE};

/* The most treelets of a zone. */
static uint64_t most_treelets(const curvilinear_source *source) {
    uint64_t most = 0;
    for (uint32_t z = 0; z < source->zones; z++) {
        const uint64_t count = curvilinear_zones_treelets(source->nodes[z], UINT32_MAX);
        most = count > most ? count : most;
    }
    return most;
}

static void sum_zone(void *ctx, const uint32_t first[3], const uint32_t cells[3]) {
    curvilinear_plan *plan = ctx;
    (void)first;
    plan->treelets++;
    plan->cells += curvilinear_cells(cells);
    /* Bytes of places and of values, apart for now. */
    plan->file_bytes += curvilinear_place_bytes(cells);
    plan->memory += curvilinear_value_bytes(cells);
}

static size_t room_bytes(const curvilinear_options *o) {
    return (o->file.codec == LEAF_CODEC_RAW && !o->grow ? 1 : 2) * curvilinear_place_bytes(whole);
}

static size_t unpacker_bytes(const curvilinear_options *o) {
    return o->grow ? leaf_unpacker_memory(leaf_grow_before(o->grow)) : 0;
}

/* At most. */
static uint64_t drawing_bytes(const leaf_sets *sets) {
    const uint64_t all = (uint64_t)sets->fields * sets->steps;
    const uint64_t runs = all < HISTOGRAM_TETS ? HISTOGRAM_TETS / all : 1;
    return runs * (sizeof(float[HISTOGRAM_CORNERS][3]) + all * sizeof(histogram_cell));
}

status curvilinear_plan_make(mem *m, const curvilinear_series *s, const curvilinear_source *first,
                             const curvilinear_options *o, curvilinear_plan *plan) {
    leaf_curvilinear g = contents(s, first, o);
    uint64_t writer = 0, packer = 0;
    g.moving = s->sets.steps > 1 && !s->still; /* at most */
    status st = leaf_writer_curvilinear_memory(&g, o->grow != NULL, &writer);
    if (st == ST_OK)
        st = leaf_packer_memory(m, NULL, &curvilinear_coder, whole, &o->file, &packer);
    if (st != ST_OK)
        return st;
    *plan = (curvilinear_plan){0};
    for (uint32_t z = 0; z < first->zones; z++) {
        const uint32_t *n = first->nodes[z];
        plan->nodes += (uint64_t)n[0] * n[1] * n[2];
        curvilinear_zones_walk(n, sum_zone, plan);
    }
    plan->file_bytes = plan->file_bytes * (g.moving ? s->sets.steps : 1) +
                       plan->memory * s->sets.fields * s->sets.steps;
    plan->memory =
        m->used + writer + curvilinear_slab_bytes(first) +
        (o->file.histograms ? drawing_bytes(&s->sets) : 0) +
        most_treelets(first) * (sizeof(place) + sizeof(uint32_t)) +
        (uint64_t)o->threads * (room_bytes(o) + packer + unpacker_bytes(o) + (64 << 10)) +
        (256 << 10);
    if (plan->memory <= o->memory)
        return ST_OK;
    return status_describe(ST_NOMEM, "a layer of treelets needs %.1f MiB of memory (--memory)",
                           (double)plan->memory / 0x1p20);
}

/* ---- treelets ---- */

static char *pack_of(const conversion *c, int worker) {
    return c->rooms[worker] + curvilinear_place_bytes(whole);
}

static uint32_t treelet_of(const conversion *c, size_t index, const place **at) {
    const uint32_t n = c->layer[index];
    *at = &c->places[n];
    return c->before + n;
}

static hex_code code_of(const curvilinear_slab *s, const place *at, uint32_t i, uint32_t j,
                        uint32_t k) {
    double p[HEX_CORNERS][3];
    for (uint32_t corner = 0; corner < HEX_CORNERS; corner++) {
        const size_t n = curvilinear_slab_node(s, at->first[0] + i + (corner & 1),
                                               at->first[1] + j + (corner >> 1 & 1),
                                               at->first[2] + k + (corner >> 2));
        if ((s->is_node && !s->is_node[n]) || (corner == 0 && curvilinear_slab_hides(s, n)))
            return HEX_NONE;
        for (int a = 0; a < 3; a++)
            p[corner][a] = (double)s->p[n][a];
    }
    return hex_code_of(hexahedron_sense((const double(*)[3])p));
}

static void put_codes(const curvilinear_slab *s, const place *at, uint8_t *to, uint64_t counts[4]) {
    uint32_t n = 0;
    for (uint32_t k = 0; k < at->cells[2]; k++)
        for (uint32_t j = 0; j < at->cells[1]; j++)
            for (uint32_t i = 0; i < at->cells[0]; i++, n++) {
                const hex_code code = code_of(s, at, i, j, k);
                to[n / 4] |= (uint8_t)(code << 2 * (n % 4));
                counts[code]++;
            }
}

static void put_row(const float (*from)[3], uint32_t count, float *to, uint32_t nodes,
                    float bounds[6]) {
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t a = 0; a < 3; a++) {
            const float x = from[i][a];
            to[a * nodes + i] = x;
            bounds[a] = x < bounds[a] ? x : bounds[a];
            bounds[a + 3] = x > bounds[a + 3] ? x : bounds[a + 3];
        }
}

/* Corner c of the cell of a treelet that is drawn. */
static size_t drawn_node(const curvilinear_slab *s, const place *at, const curvilinear_draw *d,
                         uint32_t c) {
    return curvilinear_slab_node(s, at->first[0] + d->place[0] + (c & 1),
                                 at->first[1] + d->place[1] + (c >> 1 & 1),
                                 at->first[2] + d->place[2] + (c >> 2));
}

static void draw_corners(const conversion *c, const place *at) {
    curvilinear_draw d;
    if (!c->drawing.corners)
        return;
    curvilinear_draw_begin(&d, &c->drawing.run, at->number, at->cells);
    while (curvilinear_draw_next(&d))
        for (uint32_t n = 0; n < HISTOGRAM_CORNERS; n++)
            memcpy(c->drawing.corners[d.run][n], c->slab.p[drawn_node(&c->slab, at, &d, n)],
                   sizeof(float[3]));
}

static void draw_values(const conversion *c, const place *at) {
    curvilinear_draw d;
    if (!c->drawing.corners)
        return;
    curvilinear_draw_begin(&d, &c->drawing.run, at->number, at->cells);
    while (curvilinear_draw_next(&d)) {
        const float *corners[HISTOGRAM_CORNERS];
        float values[HISTOGRAM_CORNERS];
        const bool hidden = curvilinear_slab_hides(&c->slab, drawn_node(&c->slab, at, &d, 0));
        for (uint32_t n = 0; n < HISTOGRAM_CORNERS; n++) {
            corners[n] = c->drawing.corners[d.run][n];
            values[n] = hidden ? NAN : c->slab.values[drawn_node(&c->slab, at, &d, n)];
        }
        c->drawing.cells[(size_t)c->set * c->drawing.run.count + d.run] =
            histogram_hex(corners, values);
    }
}

/* See that places are those that the file has which is added to. */
static status keep_places(const conversion *c, uint32_t t, const place *at, int worker) {
    leaf_file *before = leaf_grow_before(c->o->grow);
    char *its = pack_of(c, worker);
    const status st = leaf_file_load(before, t, c->unpackers[worker], its);
    if (st != ST_OK)
        return st;
    if (memcmp(c->rooms[worker], its, curvilinear_place_bytes(at->cells)) != 0)
        return further_step_refuse(before, c->series->path(c->series->ctx, c->step),
                                   "nodes of treelet %u lie elsewhere, or are blanked otherwise",
                                   t);
    leaf_writer_keep_topology(c->writer, t);
    return ST_OK;
}

static status put_places(void *ctx, size_t index, int worker) {
    const conversion *c = ctx;
    const curvilinear_slab *s = &c->slab;
    const place *at;
    const uint32_t t = treelet_of(c, index, &at), row = at->cells[0] + 1,
                   nodes = curvilinear_nodes(at->cells);
    float *to = (float *)(void *)c->rooms[worker];
    float bounds[6] = {INFINITY, INFINITY, INFINITY, -INFINITY, -INFINITY, -INFINITY};
    uint64_t later[4] = {0};
    memset(to, 0, curvilinear_place_bytes(at->cells));
    for (uint32_t k = 0, n = 0; k <= at->cells[2]; k++)
        for (uint32_t j = 0; j <= at->cells[1]; j++, n += row) {
            const size_t from =
                curvilinear_slab_node(s, at->first[0], at->first[1] + j, at->first[2] + k);
            put_row((const float(*)[3])s->p + from, row, to + n, nodes, bounds);
        }
    put_codes(s, at, (uint8_t *)(to + 3 * (size_t)nodes), c->step ? later : c->codes[worker]);
    draw_corners(c, at);
    if (c->o->grow)
        return keep_places(c, t, at, worker);
    return leaf_writer_put_positions(c->writer, c->packers[worker], c->step, t, bounds, to,
                                     pack_of(c, worker));
}

static status put_values(void *ctx, size_t index, int worker) {
    const conversion *c = ctx;
    const curvilinear_slab *s = &c->slab;
    const place *at;
    const uint32_t t = treelet_of(c, index, &at), row = at->cells[0] + 1;
    float *to = (float *)(void *)c->rooms[worker];
    leaf_entry entry = {.own = {INFINITY, -INFINITY}};
    memset(to, 0, curvilinear_value_bytes(at->cells));
    for (uint32_t k = 0; k <= at->cells[2]; k++)
        for (uint32_t j = 0; j <= at->cells[1]; j++) {
            const size_t from =
                curvilinear_slab_node(s, at->first[0], at->first[1] + j, at->first[2] + k);
            for (uint32_t i = 0; i < row; i++) {
                const float v = s->values[from + i];
                *to++ = v;
                if (!isfinite(v)) {
                    entry.flags = LEAF_FLAG_NON_FINITE;
                    continue;
                }
                entry.own[0] = v < entry.own[0] ? v : entry.own[0];
                entry.own[1] = v > entry.own[1] ? v : entry.own[1];
            }
        }
    c->any[worker] |= entry.own[0] <= entry.own[1];
    draw_values(c, at);
    return leaf_writer_put_values(c->writer, c->packers[worker], c->set, t, &entry,
                                  c->rooms[worker], pack_of(c, worker));
}

/* ---- passes ---- */

static void list_place(void *ctx, const uint32_t first[3], const uint32_t cells[3]) {
    conversion *c = ctx;
    place *to = &c->places[c->count++];
    memcpy(to->first, first, sizeof to->first);
    memcpy(to->cells, cells, sizeof to->cells);
    to->number = c->cells;
    c->cells += curvilinear_cells(cells);
}

/* List the treelets of the layer in memory. Returns how many there are. */
static uint32_t list_layer(conversion *c) {
    uint32_t count = 0;
    for (uint32_t t = 0; t < c->count; t++)
        if (c->places[t].first[2] == c->slab.first)
            c->layer[count++] = t;
    return count;
}

static status pass_zone(conversion *c, const curvilinear_source *source, curvilinear_slab_of of,
                        uint32_t zone, uint32_t field) {
    status st = curvilinear_slab_begin(&c->slab, source, of, zone, field);
    c->count = 0;
    curvilinear_zones_walk(source->nodes[zone], list_place, c);
    while (st == ST_OK && curvilinear_slab_more(&c->slab)) {
        st = curvilinear_slab_next(&c->slab);
        if (st == ST_OK)
            st = pool_run(c->workers, list_layer(c),
                          of == CURVILINEAR_SLAB_PLACES ? put_places : put_values, c);
        const double share = (double)(c->slab.first + c->slab.count) / source->nodes[zone][2];
        if (st == ST_OK)
            st = progress_step(c->p, "convert",
                               ((double)c->passed + (zone + share) / source->zones) /
                                   (double)c->passes);
    }
    c->before += c->count;
    return st;
}

static status pass(conversion *c, const curvilinear_source *source, curvilinear_slab_of of,
                   uint32_t field) {
    status st = ST_OK;
    c->before = 0;
    c->cells = 0;
    c->set = field * c->series->sets.steps + c->step;
    for (uint32_t z = 0; z < source->zones && st == ST_OK; z++)
        st = pass_zone(c, source, of, z, field);
    c->passed++;
    return st;
}

/* ---- steps ---- */

static status check_alike(const conversion *c, uint32_t step, const curvilinear_source *s) {
    const char *path = c->series->path(c->series->ctx, step);
    if (s->zones != c->zones)
        return status_describe(ST_CORRUPT, "%s: it has %u zones, but the first step %u", path,
                               s->zones, c->zones);
    if (s->blanked && !c->slab.is_node)
        return status_describe(ST_CORRUPT, "%s: it has blanked nodes, but the first step none",
                               path);
    for (uint32_t z = 0; z < s->zones; z++) {
        const uint32_t *n = s->nodes[z], *of = c->nodes[z];
        if (memcmp(n, of, sizeof *c->nodes) != 0)
            return status_describe(ST_CORRUPT,
                                   "%s: zone %u has %u x %u x %u nodes, but %u x %u x %u in the "
                                   "first step",
                                   path, z, n[0], n[1], n[2], of[0], of[1], of[2]);
    }
    return ST_OK;
}

static status open_step(conversion *c, uint32_t step, const curvilinear_source **out) {
    c->step = step;
    const status st = c->series->open(c->series->ctx, step, out);
    return st == ST_OK ? check_alike(c, step, *out) : st;
}

/* A checksum of where all nodes of a step are. */
static status sum_places(conversion *c, const curvilinear_source *source, uint64_t *sum) {
    curvilinear_slab *s = &c->slab;
    hash_stream *h = hash_stream_begin();
    status st = h ? ST_OK : ST_NOMEM;
    for (uint32_t z = 0; z < source->zones && st == ST_OK; z++) {
        st = curvilinear_slab_begin(s, source, CURVILINEAR_SLAB_PLACES, z, 0);
        while (st == ST_OK && curvilinear_slab_more(s)) {
            st = curvilinear_slab_next(s);
            if (st == ST_OK)
                st = progress_step(c->p, "compare", (double)c->passed / (double)c->passes);
            hash_stream_add(h, s->p, s->plane * s->count * sizeof *s->p);
            if (s->is_node)
                hash_stream_add(h, s->is_node, s->plane * s->count);
        }
    }
    if (h)
        *sum = hash_stream_end(h);
    c->passed++;
    return st;
}

/* Set c->moving: whether nodes are elsewhere at some step. */
static status find_moving(conversion *c) {
    uint64_t first = 0, sum = 0;
    status st = ST_OK;
    for (uint32_t step = 0; step < c->series->sets.steps && st == ST_OK && !c->moving; step++) {
        const curvilinear_source *source;
        st = open_step(c, step, &source);
        if (st == ST_OK)
            st = sum_places(c, source, step ? &sum : &first);
        c->moving = step > 0 && sum != first;
    }
    return st;
}

/* What is known of the steps before they are converted goes with a file that grows. */
static status check_growth(const conversion *c) {
    const char *path = c->series->path(c->series->ctx, 0);
    const leaf_file *before = c->o->grow ? leaf_grow_before(c->o->grow) : NULL;
    if ((c->o->grows || before) && c->moving)
        return status_describe(ST_USAGE,
                               "%s: --append: nodes that move from step to step: all steps of such "
                               "a grid are converted at once",
                               path);
    if (before && before->header.zones != c->zones)
        return further_step_refuse(before, path, "it has %u zones, expected %u", c->zones,
                                   before->header.zones);
    for (uint32_t z = 0; before && z < c->zones; z++) {
        const uint32_t *n = c->nodes[z], *of = curvilinear_directory_of(before)->zones[z];
        if (memcmp(n, of, sizeof *c->nodes) != 0)
            return further_step_refuse(before, path,
                                       "zone %u has %u x %u x %u nodes, expected %u x %u x %u", z,
                                       n[0], n[1], n[2], of[0], of[1], of[2]);
    }
    return ST_OK;
}

static status convert_step(conversion *c, uint32_t step) {
    const curvilinear_source *source;
    status st = open_step(c, step, &source);
    if (st == ST_OK && (step == 0 || c->moving))
        st = pass(c, source, CURVILINEAR_SLAB_PLACES, 0);
    for (uint32_t field = 0; field < c->series->sets.fields && st == ST_OK; field++)
        st = pass(c, source, CURVILINEAR_SLAB_VALUES, field);
    return st;
}

/* ---- all of it ---- */

static status allocate(conversion *c, const curvilinear_source *first) {
    const size_t threads = (size_t)c->o->threads, most = (size_t)most_treelets(first);
    c->zones = first->zones;
    c->nodes = mem_array(c->m, c->zones, sizeof *c->nodes);
    c->places = mem_array(c->m, most, sizeof *c->places);
    c->layer = mem_array(c->m, most, sizeof *c->layer);
    c->rooms = mem_array(c->m, threads, sizeof *c->rooms);
    c->codes = mem_array(c->m, threads, sizeof *c->codes);
    c->any = mem_array(c->m, threads, sizeof *c->any);
    c->packers = mem_array(c->m, threads, sizeof(leaf_packer *));
    if (!c->nodes || !c->places || !c->layer || !c->rooms || !c->codes || !c->any || !c->packers)
        return ST_NOMEM;
    memcpy(c->nodes, first->nodes, c->zones * sizeof *c->nodes);
    for (size_t i = 0; i < threads; i++) {
        c->rooms[i] = mem_alloc(c->m, room_bytes(c->o));
        if (!c->rooms[i])
            return ST_NOMEM;
        const status made =
            leaf_packer_create(c->m, NULL, &curvilinear_coder, whole, &c->o->file, &c->packers[i]);
        if (made != ST_OK)
            return made;
    }
    status st = curvilinear_slab_init(&c->slab, c->m, first);
    if (st == ST_OK && c->o->grow)
        st =
            leaf_unpackers_create(c->m, leaf_grow_before(c->o->grow), c->o->threads, &c->unpackers);
    return st == ST_OK ? pool_create(c->m, c->o->threads, &c->workers) : st;
}

/* The histograms that the writer is to have. */
static status begin_drawing(conversion *c, uint64_t cells) {
    drawing *d = &c->drawing;
    const uint32_t sets = c->series->sets.fields * c->series->sets.steps;
    if (!leaf_writer_histograms(c->writer))
        return ST_OK;
    d->run = histogram_draw_tets(cells, sets);
    d->corners = mem_array(c->m, d->run.count, sizeof *d->corners);
    d->cells = mem_array(c->m, (size_t)d->run.count * sets, sizeof *d->cells);
    return d->corners && d->cells ? ST_OK : ST_NOMEM;
}

static void end_drawing(const conversion *c, uint64_t cells) {
    const drawing *d = &c->drawing;
    const uint32_t sets = c->series->sets.fields * c->series->sets.steps;
    histogram *out = leaf_writer_histograms(c->writer);
    for (uint32_t set = 0; out && set < sets; set++) {
        double range[2];
        leaf_writer_range(c->writer, set, range);
        histogram_build(&out[set], d->cells + (size_t)set * d->run.count, d->run.count, SAMPLE_F32,
                        range, cells);
    }
}

static void release(conversion *c) {
    pool_destroy(c->workers);
    mem_free(c->m, c->drawing.corners);
    mem_free(c->m, c->drawing.cells);
    curvilinear_slab_release(&c->slab);
    for (int i = 0; c->rooms && i < c->o->threads; i++)
        mem_free(c->m, c->rooms[i]);
    for (int i = 0; c->packers && i < c->o->threads; i++)
        leaf_packer_destroy(c->m, c->packers[i]);
    mem_free(c->m, c->packers);
    leaf_unpackers_destroy(c->m, c->unpackers, c->o->threads);
    mem_free(c->m, c->nodes);
    mem_free(c->m, c->places);
    mem_free(c->m, c->layer);
    mem_free(c->m, c->rooms);
    mem_free(c->m, c->codes);
    mem_free(c->m, c->any);
}

static status begin_writer(conversion *c, const char *name, const char *output) {
    const curvilinear_options *o = c->o;
    const leaf_target to = {.path = output,
                            .force = o->force || o->grow,
                            .grows = o->grows && !o->grow,
                            .grow = o->grow};
    const leaf_curvilinear g = {.name = name,
                                .sets = c->series->sets,
                                .zones = c->zones,
                                .nodes = (const uint32_t(*)[3])c->nodes,
                                .moving = c->moving,
                                .coarse = o->coarse};
    const status st = leaf_writer_create_curvilinear(c->m, &to, &g, &o->file, &c->writer);
    if (st == ST_OK)
        leaf_writer_stop_by(c->writer, c->p);
    return st;
}

static status check_empty(const conversion *c) {
    bool any = !c->o->refuse_empty;
    for (int i = 0; i < c->o->threads; i++)
        any = any || c->any[i];
    return any ? ST_OK
               : status_describe(ST_UNSUPPORTED,
                                 "there is nothing to draw (--allow-empty converts it all the "
                                 "same): none of the grid's values is a finite number");
}

static status convert_all(conversion *c, const curvilinear_source *first, uint64_t cells,
                          const char *name, const char *output) {
    const uint32_t steps = c->series->sets.steps;
    status st = allocate(c, first);
    const bool look = steps > 1 && !c->series->still;
    c->passes = (look ? 2 : 1) * (uint64_t)steps + (uint64_t)steps * c->series->sets.fields;
    if (st == ST_OK && look)
        st = find_moving(c);
    if (st == ST_OK)
        st = check_growth(c);
    if (st == ST_OK)
        st = begin_writer(c, name, output);
    if (st == ST_OK)
        st = begin_drawing(c, cells);
    for (uint32_t step = 0; step < steps && st == ST_OK; step++)
        st = convert_step(c, step);
    if (st == ST_OK)
        end_drawing(c, cells);
    return st == ST_OK ? check_empty(c) : st;
}

static void note_result(const conversion *c, curvilinear_result *result) {
    memset(result->cells, 0, sizeof result->cells);
    for (int i = 0; c->codes && i < c->o->threads; i++)
        for (int code = 0; code < 4; code++)
            result->cells[code] += c->codes[i][code];
}

static status embed_coarse(conversion *c, const char *output, const leaf_facts *facts,
                           const progress *p) {
    if (!c->o->coarse)
        return ST_OK;
    const status st = leaf_writer_settle(c->writer, facts);
    return st == ST_OK ? curvilinear_coarse_embed(c->m, c->writer, output, c->o, p) : st;
}

status curvilinear_convert(mem *m, const curvilinear_series *s, const char *name,
                           const char *output, const curvilinear_options *o, const progress *p,
                           curvilinear_result *result) {
    const double share = curvilinear_coarse_share(o);
    progress_part parts[2] = {{p, 0.0, 1.0 - share}, {p, 1.0 - share, 1.0}};
    const progress of_part[2] = {progress_of_part(&parts[0]), progress_of_part(&parts[1])};
    conversion c = {.m = m, .series = s, .o = o, .p = &of_part[0]};
    curvilinear_plan plan;
    const curvilinear_source *first;
    status st = s->open(s->ctx, 0, &first);
    if (st == ST_OK)
        st = curvilinear_plan_make(m, s, first, o, &plan);
    if (st == ST_OK)
        st = convert_all(&c, first, plan.cells, name, output);
    note_result(&c, result);
    char origin[128], codec[32] = "raw";
    if (o->file.codec == LEAF_CODEC_ZSTD)
        snprintf(codec, sizeof codec, "zstd:%d", o->file.zstd_level);
    snprintf(origin, sizeof origin,
             "leafcast " LEAFCAST_VERSION
             " convert, from a curvilinear grid: treelets of 32^3 cells, %s",
             codec);
    const leaf_facts facts = {.non_finite = c.slab.odd, .provenance = origin};
    release(&c);
    if (st == ST_OK)
        st = embed_coarse(&c, output, &facts, &of_part[1]);
    if (st != ST_OK) {
        leaf_writer_discard(c.writer);
        return st;
    }
    return leaf_writer_finish(c.writer, &facts, &result->header);
}
