#include "formats/leaf/leaf_stats.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "formats/base/pool.h"
#include "formats/leaf/deviation.h"
#include "formats/leaf/leaf_active.h"
#include "formats/leaf/leaf_geometry.h"
#include "formats/leaf/leaf_unpacker.h"
#include "formats/mesh/mesh_leaf.h"

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

static status count_treelet(void *ctx, size_t index, int worker) {
    const activity *a = ctx;
    uint32_t t = (uint32_t)index;
    if (!holds(a, t))
        return ST_OK;
    const leaf_active query = {.f = a->f,
                               .set = a->set,
                               .treelet = t,
                               .iso = a->iso,
                               .unpacker = a->unpackers[worker],
                               .room = a->payloads[worker]};
    const status st = progress_step(a->p, "count", (double)t / a->f->layout.treelets);
    return st == ST_OK ? leaf_active_count(&query, &a->cells[t]) : st;
}

static status allocate(activity *a, mem *m, int threads) {
    const leaf_layout *l = &a->f->layout;
    const size_t room = leaf_layout_aligned(leaf_layout_payload_max(l), LEAF_ALIGN_LOG2);
    a->cells = mem_array(m, l->treelets, sizeof *a->cells);
    a->payloads = mem_array(m, (size_t)threads, sizeof *a->payloads);
    if (!a->cells || !a->payloads)
        return ST_NOMEM;
    for (int i = 0; i < threads; i++) {
        a->payloads[i] = mem_alloc(m, LEAF_ACTIVE_PAYLOADS * room);
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
