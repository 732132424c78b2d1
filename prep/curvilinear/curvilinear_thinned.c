#include "prep/curvilinear/curvilinear_thinned.h"

#include <string.h>

#include "formats/leaf/curvilinear_geometry.h"
#include "formats/leaf/hex_treelet.h"

/* Coarse nodes along an axis of so many nodes. */
static uint32_t thin(uint32_t nodes, uint32_t log2) {
    return ((nodes - 2) >> log2) + 2;
}

/* The node that coarse node i of an axis is. */
static uint32_t node_of(const curvilinear_thinned *t, uint32_t i, uint32_t nodes) {
    const uint64_t n = (uint64_t)i << t->log2;
    return n < nodes ? (uint32_t)n : nodes - 1;
}

/* A treelet of a zone, and coarse planes that are asked for. */
typedef struct visit {
    const curvilinear_thinned *t;
    const uint32_t *nodes, *coarse; /* of the zone; thinned */
    uint32_t first, count;          /* planes */
    uint32_t at[3];                 /* the treelet's first node */
    const uint32_t *cells;          /* the treelet's */
    const hex_treelet *h;
    const float *values;
} visit;

/* The coarse nodes [*from, *end) of an axis that the treelet has; along k, of the planes. */
static void coarse_range(const visit *v, int axis, uint32_t *from, uint32_t *end) {
    const uint32_t step = UINT32_C(1) << v->t->log2, last = v->at[axis] + v->cells[axis];
    *from = (v->at[axis] + step - 1) / step;
    *end = last / step + 1;
    if (last + 1 == v->nodes[axis])
        *end = v->coarse[axis];
    if (axis < 2)
        return;
    *from = *from > v->first ? *from : v->first;
    *end = *end < v->first + v->count ? *end : v->first + v->count;
}

/* The number here of a coarse node of the planes. */
static size_t coarse_node(const visit *v, uint32_t i, uint32_t j, uint32_t k) {
    return i + v->coarse[0] * ((size_t)j + v->coarse[1] * (size_t)(k - v->first));
}

/* The number in the treelet of the node that a coarse one is. */
static uint32_t own_node(const visit *v, uint32_t i, uint32_t j, uint32_t k) {
    const uint32_t at[3] = {i, j, k};
    uint32_t own[3];
    for (int a = 0; a < 3; a++)
        own[a] = node_of(v->t, at[a], v->nodes[a]) - v->at[a];
    return own[0] + (v->cells[0] + 1) * (own[1] + (v->cells[1] + 1) * own[2]);
}

/* ---- what is copied ---- */

static void copy_place(const visit *v, size_t to, uint32_t from, void *out) {
    float(*p)[3] = out;
    for (int a = 0; a < 3; a++)
        p[to][a] = hex_treelet_coordinates(v->h, a)[from];
}

static void copy_value(const visit *v, size_t to, uint32_t from, void *out) {
    ((float *)out)[to] = v->values[from];
}

typedef void copy_node(const visit *v, size_t to, uint32_t from, void *out);

static void copy_nodes(const visit *v, copy_node *copy, void *out) {
    uint32_t from[3], end[3];
    for (int a = 0; a < 3; a++)
        coarse_range(v, a, &from[a], &end[a]);
    for (uint32_t k = from[2]; k < end[2]; k++)
        for (uint32_t j = from[1]; j < end[1]; j++)
            for (uint32_t i = from[0]; i < end[0]; i++)
                copy(v, coarse_node(v, i, j, k), own_node(v, i, j, k), out);
}

/* ---- what is there ---- */

enum { SHOWN = 4 }; /* beside CURVILINEAR_NODE: a cell from the node on is there */

/* Whether node n of an axis is a coarse one, *i. */
static bool is_coarse(const visit *v, int axis, uint32_t n, uint32_t *i) {
    const uint32_t last = v->nodes[axis] - 1, log2 = v->t->log2;
    *i = n == last ? v->coarse[axis] - 1 : n >> log2;
    return n == last || *i << log2 == n;
}

/* Note the coarse nodes that are corners of a cell. at: its first node. */
static void note_corners(const visit *v, const uint32_t at[3], uint8_t *out) {
    for (uint32_t corner = 0; corner < 8; corner++) {
        uint32_t i[3];
        bool coarse = true;
        for (int a = 0; a < 3; a++)
            coarse = coarse && is_coarse(v, a, at[a] + (corner >> a & 1), &i[a]);
        if (coarse && i[2] >= v->first && i[2] < v->first + v->count)
            out[coarse_node(v, i[0], i[1], i[2])] |= CURVILINEAR_NODE;
    }
}

/* Note the coarse nodes that cells of the treelet have, and the coarse cells that they are in. */
static void note_cells(const visit *v, uint8_t *out) {
    const uint32_t *n = v->cells, log2 = v->t->log2;
    for (uint32_t c = 0; c < n[0] * n[1] * n[2]; c++) {
        if (hex_treelet_code(v->h, c) == HEX_NONE)
            continue;
        const uint32_t at[3] = {v->at[0] + c % n[0], v->at[1] + c / n[0] % n[1],
                                v->at[2] + c / (n[0] * n[1])};
        const uint32_t k = at[2] >> log2;
        note_corners(v, at, out);
        if (k >= v->first && k < v->first + v->count)
            out[coarse_node(v, at[0] >> log2, at[1] >> log2, k)] |= SHOWN;
    }
}

/* ---- treelets ---- */

/* Whether a treelet has nodes of the coarse planes, or cells behind them. */
static bool reaches(const visit *v) {
    const uint32_t lowest = node_of(v->t, v->first, v->nodes[2]),
                   highest = node_of(v->t, v->first + v->count, v->nodes[2]);
    return v->at[2] <= highest && v->at[2] + v->cells[2] >= lowest;
}

/* copy NULL: cells. */
static status go_through(curvilinear_thinned *t, uint32_t zone, uint32_t first, uint32_t count,
                         copy_node *copy, void *out) {
    const curvilinear_directory *d = curvilinear_directory_of(t->f);
    status st = ST_OK;
    for (uint32_t i = 0; i < t->f->layout.treelets && st == ST_OK; i++) {
        hex_treelet h;
        visit v = {.t = t,
                   .nodes = d->zones[zone],
                   .coarse = t->nodes[zone],
                   .first = first,
                   .count = count,
                   .cells = d->counts[i],
                   .h = &h};
        memcpy(v.at, d->where[i].first, sizeof v.at);
        if (d->where[i].zone != zone || !reaches(&v))
            continue;
        st = hex_treelet_load(t->f, i, t->set, t->unpacker, t->room, &h, &v.values);
        if (st == ST_OK && copy)
            copy_nodes(&v, copy, out);
        else if (st == ST_OK)
            note_cells(&v, out);
    }
    return st;
}

/* ---- the source ---- */

static status places(void *own, uint32_t zone, uint32_t first, uint32_t count, float (*p)[3]) {
    return go_through(own, zone, first, count, copy_place, p);
}

static status values(void *own, uint32_t zone, uint32_t field, uint32_t first, uint32_t count,
                     float *to) {
    (void)field;
    return go_through(own, zone, first, count, copy_value, to);
}

static status blanks(void *own, uint32_t zone, uint32_t first, uint32_t count, uint8_t *is_node) {
    curvilinear_thinned *t = own;
    const size_t nodes = (size_t)count * t->nodes[zone][0] * t->nodes[zone][1];
    memset(is_node, 0, nodes);
    const status st = go_through(t, zone, first, count, NULL, is_node);
    for (size_t i = 0; i < nodes; i++)
        if (is_node[i] & CURVILINEAR_NODE)
            is_node[i] =
                is_node[i] & SHOWN ? CURVILINEAR_NODE : CURVILINEAR_NODE | CURVILINEAR_HIDDEN;
        else
            is_node[i] = 0;
    return st;
}

/* Whether a cell of the file is none. */
static status find_blanked(curvilinear_thinned *t, bool *any) {
    status st = ST_OK;
    *any = false;
    for (uint32_t i = 0; i < t->f->layout.treelets && st == ST_OK && !*any; i++) {
        hex_treelet h;
        const float *unused;
        st = hex_treelet_load(t->f, i, t->set, t->unpacker, t->room, &h, &unused);
        for (uint32_t c = 0; st == ST_OK && c < h.cells && !*any; c++)
            *any = hex_treelet_code(&h, c) == HEX_NONE;
    }
    return st;
}

status curvilinear_thinned_init(curvilinear_thinned *t, mem *m, leaf_file *f, uint32_t set,
                                uint32_t log2) {
    const curvilinear_directory *d = curvilinear_directory_of(f);
    const uint32_t zones = f->header.zones;
    *t = (curvilinear_thinned){.m = m, .f = f, .set = set, .log2 = log2};
    t->nodes = mem_array(m, zones, sizeof *t->nodes);
    t->room = mem_alloc(m, HEX_TREELET_PAYLOADS * leaf_layout_payload_max(&f->layout));
    status st = t->nodes && t->room ? leaf_unpacker_create(m, f, &t->unpacker) : ST_NOMEM;
    for (uint32_t z = 0; z < zones && st == ST_OK; z++)
        for (int a = 0; a < 3; a++)
            t->nodes[z][a] = thin(d->zones[z][a], log2);
    t->source = (curvilinear_source){.own = t,
                                     .zones = zones,
                                     .nodes = (const uint32_t(*)[3])t->nodes,
                                     .fields = 1,
                                     .places = places,
                                     .values = values,
                                     .blanks = blanks};
    return st == ST_OK ? find_blanked(t, &t->source.blanked) : st;
}

void curvilinear_thinned_release(curvilinear_thinned *t) {
    leaf_unpacker_destroy(t->unpacker);
    mem_free(t->m, t->room);
    mem_free(t->m, t->nodes);
}

uint32_t curvilinear_thinned_log2(const leaf_file *f, uint64_t cells) {
    const curvilinear_directory *d = curvilinear_directory_of(f);
    for (uint32_t log2 = 1;; log2++) {
        uint64_t all = 0;
        bool more = false;
        for (uint32_t z = 0; z < f->header.zones; z++) {
            uint64_t of = 1;
            for (int a = 0; a < 3; a++) {
                const uint32_t along = thin(d->zones[z][a], log2) - 1;
                of *= along;
                more = more || along > 1;
            }
            all += of;
        }
        if (all <= cells || !more)
            return log2;
    }
}
