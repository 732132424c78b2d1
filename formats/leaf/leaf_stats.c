#include "formats/leaf/leaf_stats.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "formats/base/pool.h"
#include "formats/leaf/deviation.h"
#include "formats/leaf/leaf_geometry.h"
#include "formats/leaf/leaf_unpacker.h"
#include "formats/mesh/mesh_leaf_check.h"

/* On which sides of the isovalue the samples of an edge, a face or a cell lie. */
enum { SIDE_OUT = 1, SIDE_IN = 2, SIDE_NONE = 4, SIDE_BOTH = SIDE_OUT | SIDE_IN };

enum { ROW_MAX = (1 << LEAF_CELLS_LOG2_MAX) + 1 };

typedef struct activity {
    leaf_file *f;
    uint32_t set;
    double iso;
    value_limits at;
    const progress *p;
    uint64_t *cells; /* per treelet */
    char **payloads;
    leaf_unpacker **unpackers;
} activity;

static bool holds(const activity *a, uint32_t t) {
    const float *own = a->f->own[(size_t)a->set * a->f->layout.treelets + t];
    return value_limits_meet(&a->at, own[0], own[1]);
}

/* ---- active cells ---- */

/* Find the sides for each edge along x in the line of samples at (y, z). */
static void row_sides(const leaf_layout *l, const leaf_payload *p, const char *samples, double iso,
                      uint32_t y, uint32_t z, uint8_t sides[ROW_MAX]) {
    size_t first =
        l->halo + (size_t)p->samples[0] * (y + l->halo + (size_t)p->samples[1] * (z + l->halo));
    uint8_t before = 0;
    for (uint32_t x = 0; x <= p->cells[0]; x++) {
        float v = sample_get(l->type, samples, first + x);
        uint8_t side = !isfinite(v) ? SIDE_NONE : (double)v >= iso ? SIDE_IN : SIDE_OUT;
        if (x > 0)
            sides[x - 1] = before | side;
        before = side;
    }
}

uint64_t leaf_stats_cells(const leaf_layout *l, uint32_t t, const void *payload, double iso) {
    leaf_payload p = leaf_layout_payload(l, t);
    const char *samples = (const char *)payload + p.samples_at;
    uint64_t count = 0;
    for (uint32_t z = 0; z < p.cells[2]; z++) {
        uint8_t near[2][ROW_MAX],
            far[2][ROW_MAX]; /* rows y and y + 1 (in alternating places) of slices z and z + 1 */
        row_sides(l, &p, samples, iso, 0, z, near[0]);
        row_sides(l, &p, samples, iso, 0, z + 1, far[0]);
        for (uint32_t y = 0; y < p.cells[1]; y++) {
            const uint32_t now = y & 1, next = now ^ 1;
            row_sides(l, &p, samples, iso, y + 1, z, near[next]);
            row_sides(l, &p, samples, iso, y + 1, z + 1, far[next]);
            for (uint32_t x = 0; x < p.cells[0]; x++)
                count += (near[now][x] | near[next][x] | far[now][x] | far[next][x]) == SIDE_BOTH;
        }
    }
    return count;
}

uint64_t leaf_stats_tets(const leaf_file *f, uint32_t t, const void *topology, const void *values,
                         double iso) {
    const mesh_shape s = mesh_leaf_shape(f->mesh->counts[t]);
    const uint16_t(*tet)[4] = mesh_leaf_tets(&s, topology);
    const float *value = mesh_leaf_values(&s, values);
    uint64_t count = 0;
    for (uint32_t i = 0; i < s.tets; i++) {
        unsigned sides = 0;
        for (int c = 0; c < 4; c++) {
            const float v = value[tet[i][c]];
            sides |= !isfinite(v) ? SIDE_NONE : (double)v >= iso ? SIDE_IN : SIDE_OUT;
        }
        count += sides == SIDE_BOTH;
    }
    return count;
}

/* Count active tets. The thread's payload room holds the topology, then the values. */
static status count_tets(const activity *a, uint32_t t, int worker) {
    leaf_file *f = a->f;
    char *topology = a->payloads[worker];
    char *values = topology + leaf_layout_payload_max(&f->layout);
    status st = leaf_file_load(f, t, a->unpackers[worker], topology);
    if (st == ST_OK)
        st = mesh_leaf_check_loaded(f, t, topology);
    if (st == ST_OK)
        st = leaf_file_load(f, leaf_layout_values(&f->layout, a->set, t), a->unpackers[worker],
                            values);
    if (st == ST_OK)
        a->cells[t] = leaf_stats_tets(f, t, topology, values, a->iso);
    return st;
}

static status count_treelet(void *ctx, size_t index, int worker) {
    const activity *a = ctx;
    uint32_t t = (uint32_t)index;
    if (!holds(a, t))
        return ST_OK;
    status st = progress_step(a->p, "count", (double)t / a->f->layout.treelets);
    if (st == ST_OK && a->f->mesh)
        return count_tets(a, t, worker);
    if (st == ST_OK)
        st = leaf_file_load(a->f, leaf_layout_samples(&a->f->layout, a->set, t),
                            a->unpackers[worker], a->payloads[worker]);
    if (st == ST_OK)
        a->cells[t] = leaf_stats_cells(&a->f->layout, t, a->payloads[worker], a->iso);
    return st;
}

static status allocate(activity *a, mem *m, int threads) {
    const leaf_layout *l = &a->f->layout;
    const size_t room = leaf_layout_payload_max(l);
    a->cells = mem_array(m, l->treelets, sizeof *a->cells);
    a->payloads = mem_array(m, (size_t)threads, sizeof *a->payloads);
    if (!a->cells || !a->payloads)
        return ST_NOMEM;
    for (int i = 0; i < threads; i++) {
        a->payloads[i] = mem_alloc(m, a->f->mesh ? 2 * room : room);
        if (!a->payloads[i])
            return ST_NOMEM;
    }
    return leaf_unpackers_create(m, a->f, threads, &a->unpackers);
}

static void release(activity *a, mem *m, int threads) {
    for (int i = 0; a->payloads && i < threads; i++)
        mem_free(m, a->payloads[i]);
    mem_free(m, a->payloads);
    leaf_unpackers_destroy(m, a->unpackers, threads);
    mem_free(m, a->cells);
}

/* The bytes of a treelet in a set that were not counted before. counted: per payload. */
static uint64_t bytes_anew(const leaf_file *f, uint32_t set, uint32_t t, uint8_t *counted) {
    uint32_t parts[LEAF_PARTS_MAX], chain[LEAF_CHAIN_MAX];
    uint64_t bytes = 0;
    for (int i = f->geometry->parts(&f->layout, set, t, parts); i-- > 0;) {
        for (int k = leaf_file_chain(f, parts[i], chain); k-- > 0;) {
            bytes += counted[chain[k]] ? 0 : f->sizes[chain[k]];
            counted[chain[k]] = 1;
        }
        bytes += leaf_file_is_outside(f, parts[i]) ? leaf_file_bytes_outside(f, parts[i]) : 0;
    }
    return bytes;
}

static void add_up(const activity *a, uint8_t *counted, leaf_activity levels[LEAF_LEVELS_MAX]) {
    memset(levels, 0, LEAF_LEVELS_MAX * sizeof *levels);
    for (uint32_t t = 0; t < a->f->layout.treelets; t++) {
        leaf_activity *level = &levels[a->f->layout.level_of[t]];
        if (!holds(a, t))
            continue;
        level->treelets++;
        level->bytes += bytes_anew(a->f, a->set, t, counted);
        level->cells += a->cells[t];
    }
}

status leaf_stats_activity(mem *m, leaf_file *f, uint32_t set, double iso, int threads,
                           const progress *p, leaf_activity levels[LEAF_LEVELS_MAX]) {
    activity a = {.f = f, .set = set, .iso = iso, .at = value_limits_of_isovalue(iso), .p = p};
    uint8_t *counted = mem_array(m, f->layout.payloads, sizeof *counted);
    pool *workers = NULL;
    status st = counted ? pool_create(m, threads, &workers) : ST_NOMEM;
    if (st == ST_OK)
        st = allocate(&a, m, threads);
    if (st == ST_OK)
        st = pool_run(workers, f->layout.treelets, count_treelet, &a);
    if (st == ST_OK)
        add_up(&a, counted, levels);
    pool_destroy(workers);
    release(&a, m, threads);
    mem_free(m, counted);
    return st;
}

/* ---- where an isovalue is ---- */

typedef struct presence {
    const leaf_file *f;
    uint32_t field;
    uint8_t *has;     /* per step */
    uint64_t *active; /* per step: treelets */
    uint8_t *seen;    /* per treelet: at any step */
    uint8_t *counted; /* per payload */
    uint64_t bytes;
} presence;

static void take(time_query *q, uint32_t treelet, uint32_t step) {
    const presence *p = q->ctx;
    p->has[step] = 1;
    p->active[step]++;
    p->seen[treelet] = 1;
    ((presence *)q->ctx)->bytes +=
        bytes_anew(p->f, leaf_layout_set(&p->f->layout, p->field, step), treelet, p->counted);
}

static void ask(presence *p, const time_tree *tree, double iso, const uint8_t *asked,
                uint8_t *settled) {
    const uint32_t steps = p->f->layout.steps;
    const value_limits at = value_limits_of_isovalue(iso);
    time_query q = {.limits = &at, .count = 1, .end = steps, .met = take, .ctx = p};
    for (uint32_t step = 0; step < steps; step++)
        settled[step] = !asked[step];
    q.settled = settled;
    memset(p->has, 0, steps);
    time_tree_ask(tree, &q);
}

static leaf_presence sum_of(const presence *p) {
    leaf_presence sum = {.bytes = p->bytes};
    for (uint32_t step = 0; step < p->f->layout.steps; step++) {
        sum.steps += p->has[step];
        if (p->active[step] > sum.most) {
            sum.most = p->active[step];
            sum.step_of_most = step;
        }
    }
    for (uint32_t t = 0; t < p->f->layout.treelets; t++)
        sum.treelets += p->seen[t];
    return sum;
}

status leaf_stats_presence(mem *m, const leaf_file *f, const time_tree *tree, uint32_t field,
                           double iso, const uint8_t *asked, uint8_t *has, leaf_presence *out) {
    const leaf_layout *l = &f->layout;
    presence p = {.f = f, .field = field, .has = has};
    uint8_t *settled = mem_array(m, l->steps, sizeof *settled);
    p.active = mem_array(m, l->steps, sizeof *p.active);
    p.seen = mem_array(m, l->treelets, sizeof *p.seen);
    p.counted = mem_array(m, l->payloads, sizeof *p.counted);
    const bool room = settled && p.active && p.seen && p.counted;
    if (room) {
        ask(&p, tree, iso, asked, settled);
        *out = sum_of(&p);
    }
    mem_free(m, p.counted);
    mem_free(m, p.seen);
    mem_free(m, p.active);
    mem_free(m, settled);
    return room ? ST_OK : ST_NOMEM;
}

/* Whether a treelet, or one of level 0 below it, meets the interval. ranges, own: of the set. */
static bool is_met(const leaf_layout *l, const float (*ranges)[2], const float (*own)[2],
                   uint32_t t, value_limits at) {
    if (l->level_of[t] == 0)
        return value_limits_meet(&at, own[t][0], own[t][1]);
    if (!value_limits_meet(&at, ranges[t][0], ranges[t][1]))
        return false;
    const uint32_t first = l->first_child[t];
    const uint32_t end = first + (uint32_t)__builtin_popcount(leaf_layout_children(l, t));
    for (uint32_t child = first; child < end; child++)
        if (is_met(l, ranges, own, child, at))
            return true;
    return false;
}

bool leaf_stats_meets(const leaf_file *f, uint32_t set, value_limits at) {
    const leaf_layout *l = &f->layout;
    const leaf_level *top = &l->level[l->levels - 1];
    const size_t of_set = (size_t)set * l->treelets;
    for (uint32_t t = top->first; t < top->first + top->count; t++)
        if (is_met(l, (const float(*)[2])f->ranges + of_set, (const float(*)[2])f->own + of_set, t,
                   at))
            return true;
    return false;
}

/* ---- what a mesh's payloads are made of ---- */

leaf_mesh_parts leaf_stats_mesh(const leaf_file *f) {
    const uint64_t sets = f->layout.sets;
    leaf_mesh_parts parts = {0};
    uint64_t bytes = 0;
    for (uint32_t t = 0; t < f->layout.treelets; t++) {
        const mesh_shape s = mesh_leaf_shape(f->mesh->counts[t]);
        parts.vertices += s.vertices;
        parts.node_count += s.nodes;
        parts.leaves += s.leaves;
        parts.tets += s.tets * sizeof(uint16_t[4]);
        bytes += s.topology_bytes + sets * s.values_bytes +
                 f->layout.gradient_sets * (uint64_t)s.gradients_bytes +
                 (f->layout.places - 1) * (uint64_t)s.positions_bytes;
    }
    parts.nodes = parts.node_count * sizeof(mesh_node) +
                  (parts.leaves + f->layout.treelets) * sizeof(uint16_t);
    parts.positions = parts.vertices * sizeof(float[3]);
    parts.codes = sets * parts.node_count * sizeof(mesh_codes);
    parts.values = sets * parts.vertices * sizeof(float);
    parts.gradients = f->layout.gradient_sets * parts.vertices * sizeof(float[3]);
    parts.moved_boxes = (f->layout.places - 1) * parts.node_count * sizeof(mesh_boxes);
    parts.moved = (f->layout.places - 1) * parts.vertices * sizeof(float[3]);
    parts.padding = bytes - parts.nodes - parts.tets - parts.positions - parts.codes -
                    parts.values - parts.gradients - parts.moved_boxes - parts.moved;
    uint64_t *const stored[] = {[LEAF_BLOCK_TOPOLOGY] = &parts.stored_topology,
                                [LEAF_BLOCK_VALUES] = &parts.stored_values,
                                [LEAF_BLOCK_GRADIENTS] = &parts.stored_gradients,
                                [LEAF_BLOCK_POSITIONS] = &parts.stored_positions};
    uint32_t index;
    for (uint32_t p = 0; p < f->layout.payloads; p++)
        if (leaf_file_is_home(f, p))
            *stored[leaf_layout_block_of(&f->layout, p, &index)] += f->sizes[p];
    return parts;
}

leaf_deviation leaf_stats_deviation(const leaf_file *f, uint32_t level) {
    const leaf_layout *l = &f->layout;
    const leaf_level *v = &l->level[level];
    leaf_deviation d = {0};
    double sum = 0.0;
    for (uint32_t t = v->first; t < v->first + v->count; t++)
        for (uint32_t i = 0; i < deviation_bricks(l); i++)
            for (uint32_t set = 0; set < l->sets && deviation_has_cells(l, t, i); set++) {
                const uint16_t code = f->deviations[deviation_at(l, set, t) + i];
                if (code == DEVIATION_UNKNOWN) {
                    d.unknown++;
                    continue;
                }
                d.bricks++;
                sum += deviation_value(code);
                d.most = fmax(d.most, deviation_value(code));
            }
    d.mean = d.bricks ? sum / (double)d.bricks : 0.0;
    return d;
}
