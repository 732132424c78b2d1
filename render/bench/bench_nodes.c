#include "render/bench/bench_nodes.h"

#include <math.h>
#include <string.h>

#include "formats/base/clock.h"
#include "render/bench/bench_tree.h"
#include "render/grid/cell_kernel.h"
#include "render/grid/octree_step.h"
#include "render/look/camera.h"

enum { ENDS = 2, CONTESTANTS = KEEPINGS * ENDS };

typedef struct contestant {
    bench_keeping keeping;
    uint32_t finest; /* the level of the smallest nodes */
    double *seconds; /* of every run */
    double median, spread;
    uint64_t nodes, corners, cells, hits;
    uint64_t picture; /* the bits of all distances, mixed */
} contestant;

/* What does not change from ray to ray. */
typedef struct scene {
    const bench_tree *tree;
    double iso;
    quantized_limits own, of_volume, *of_treelet;
    camera camera;
    uint32_t size;
} scene;

/* ---- one ray ---- */

typedef struct walker {
    const scene *s;
    contestant *c;
    ray r;
    hit best;
} walker;

static bool between(float lo, float hi, double iso) {
    return (double)lo < iso && iso <= (double)hi;
}

/* Returns whether the range of node at[] of level k holds the isovalue. slot: its index among the
 * large nodes, for KEEP_LARGE alone. */
static bool holds(const walker *w, uint32_t k, const uint32_t at[3], uint32_t slot) {
    const bench_tree *t = w->s->tree;
    const size_t i = bench_tree_index(t, k, at);
    const float *range;
    w->c->nodes++;
    switch (w->c->keeping) {
    case KEEP_LARGE: return between(t->large[k][slot].lo, t->large[k][slot].hi, w->s->iso);
    case KEEP_OWN:
        if (sample_size(t->type) == 1)
            return quantize_holds(w->s->own, t->own8[k][i].lo, t->own8[k][i].hi);
        return t->own16[k][i].lo <= w->s->own.below && t->own16[k][i].hi >= w->s->own.above;
    case KEEP_VOLUME:
        return quantize_holds(w->s->of_volume, t->of_volume[k][i].lo, t->of_volume[k][i].hi);
    case KEEP_TREELET:
        if (k < BENCH_TREE_TREELET) {
            const uint32_t up = BENCH_TREE_TREELET - k;
            const uint32_t root[3] = {at[0] >> up, at[1] >> up, at[2] >> up};
            return quantize_holds(w->s->of_treelet[bench_tree_index(t, BENCH_TREE_TREELET, root)],
                                  t->of_treelet[k][i].lo, t->of_treelet[k][i].hi);
        }
        break;
    default: break;
    }
    range = t->range[k][i];
    return between(range[0], range[1], w->s->iso);
}

static void visit_cell(walker *w, const uint32_t at[3]) {
    const bench_tree *t = w->s->tree;
    float samples[8];
    int inside = 0;
    cell_box box;
    cell_visit visit;
    hit found;
    w->c->corners++;
    for (unsigned i = 0; i < 8; i++) {
        const size_t x = at[0] + (i & 1u), y = at[1] + (i >> 1 & 1u), z = at[2] + (i >> 2);
        samples[i] = t->samples[x + t->nodes[0] * (y + t->nodes[1] * z)];
        inside += (double)samples[i] >= w->s->iso;
    }
    if (inside == 0 || inside == 8)
        return;
    w->c->cells++;
    for (int a = 0; a < 3; a++) {
        box.lo[a] = at[a];
        box.hi[a] = at[a] + 1.0;
        box.inv[a] = 1.0;
        box.last[a] = at[a] + 1 == t->n[0][a];
    }
    const hit start = hit_before_all();
    if (cell_visit_of(&w->r, &box, &visit) &&
        cell_next_hit(&w->r, &visit, samples, w->s->iso, 0, bench_tree_index(t, 0, at), &start,
                      &found) &&
        hit_less(&found, &w->best))
        w->best = found;
}

static void visit(walker *w, uint32_t k, const uint32_t at[3], uint32_t slot, double t_in,
                  double t_out) {
    const bench_tree *t = w->s->tree;
    if (t_in > w->best.t)
        return;
    if (k == 0) {
        visit_cell(w, at);
        return;
    }
    double middle[3];
    octree_child children[4];
    for (int a = 0; a < 3; a++)
        middle[a] = (double)((2 * (uint64_t)at[a] + 1) << (k - 1));
    const int count = octree_step(&w->r, middle, t_in, t_out, children);
    for (int i = 0; i < count; i++) {
        uint32_t child[3], below = 0;
        if (!bench_tree_child(t, k, at, children[i].octant, child))
            continue;
        if (k > w->c->finest && w->c->keeping == KEEP_LARGE) {
            const bench_large_node *n = &t->large[k][slot];
            below = n->child +
                    (uint32_t)__builtin_popcount(n->exists & ((1u << children[i].octant) - 1u));
        }
        if (k > w->c->finest && !holds(w, k - 1, child, below))
            continue;
        visit(w, k - 1, child, below, children[i].t_in, children[i].t_out);
    }
}

/* The part of a ray in the volume; false where there is none. The ray itself is not cut: the cell
 * kernel judges. */
static bool interval(const bench_tree *t, ray *r, double *t_in, double *t_out) {
    r->t0 = *t_in = 0.0;
    r->t1 = *t_out = INFINITY;
    for (int a = 0; a < 3; a++) {
        const double end = t->n[0][a];
        r->d[a] += 0.0; /* -0 becomes +0 */
        r->held[a] = r->o[a] < end ? r->o[a] : nextafter(end, 0.0);
        if (r->d[a] == 0.0 && (r->o[a] < 0.0 || r->o[a] > end))
            return false;
        if (r->d[a] == 0.0)
            continue;
        const double low = (0.0 - r->o[a]) / r->d[a], high = (end - r->o[a]) / r->d[a];
        *t_in = fmax(*t_in, fmin(low, high));
        *t_out = fmin(*t_out, fmax(low, high));
    }
    return *t_in <= *t_out;
}

/* ---- pictures ---- */

static void draw(const scene *s, contestant *c) {
    static const uint32_t root[3] = {0, 0, 0};
    const uint32_t top = s->tree->levels - 1;
    walker w = {.s = s, .c = c};
    c->nodes = c->corners = c->cells = c->hits = c->picture = 0;
    for (uint32_t y = 0; y < s->size; y++)
        for (uint32_t x = 0; x < s->size; x++) {
            uint64_t bits;
            double t_in, t_out;
            w.best = hit_none();
            camera_ray(&s->camera, x + 0.5, y + 0.5, w.r.o, w.r.d);
            if (interval(s->tree, &w.r, &t_in, &t_out) && holds(&w, top, root, 0))
                visit(&w, top, root, 0, t_in, t_out);
            c->hits += hit_exists(&w.best);
            memcpy(&bits, &w.best.t, sizeof bits);
            c->picture = (c->picture ^ bits) * 0x9e3779b97f4a7c15u;
        }
}

static status race(bench_job *job, const scene *s, contestant *c, int count) {
    status st = ST_OK;
    for (int run = -1; run < job->runs && st == ST_OK; run++) {
        st = progress_step(job->progress, "drawing", fmax(run, 0) / job->runs);
        for (int i = 0; i < count && st == ST_OK; i++) {
            const double start = clock_cpu_seconds();
            draw(s, &c[i]);
            if (run >= 0)
                c[i].seconds[run] = clock_cpu_seconds() - start;
            if (c[i].picture != c[0].picture)
                st = status_describe(ST_FAILED, "two ways to keep ranges draw another picture");
        }
    }
    for (int i = 0; i < count && st == ST_OK; i++)
        c[i].median = bench_median(c[i].seconds, job->runs, &c[i].spread);
    return st;
}

static status set_scene(bench_job *job, const bench_tree *t, double iso, scene *s) {
    const quantizer volume = quantizer_of((float)t->lo, (float)t->hi, t->type);
    const double least = t->type == SAMPLE_I8 ? -128.0 : t->type == SAMPLE_I16 ? -32768.0 : 0.0;
    double bounds[2][3] = {{0.0, 0.0, 0.0}};
    *s = (scene){.tree = t, .iso = iso, .size = job->view.camera.width / 2};
    for (int a = 0; a < 3; a++)
        bounds[1][a] = t->n[0][a];
    const leafcast_camera view = camera_standard((const double(*)[3])bounds, 2.2, s->size, s->size);
    s->own.above = (int)(ceil(iso) - least);
    s->own.below = s->own.above - 1;
    s->of_volume = quantizer_iso(&volume, iso);
    const size_t treelets = t->count[BENCH_TREE_TREELET];
    s->of_treelet = mem_array(&job->m, treelets, sizeof *s->of_treelet);
    if (!s->of_treelet)
        return ST_NOMEM;
    for (size_t i = 0; i < treelets; i++)
        s->of_treelet[i] = quantizer_iso(&t->treelet[i], iso);
    return camera_init(&s->camera, &view);
}

/* ---- the table ---- */

static const char *const NAMES[] = {"large (M08)",       "float",
                                    "sample type",       "8 bits of volume",
                                    "8 bits of treelet", "... less parent's"};

static void add_row(bench_table *t, const bench_subject *subject, const scene *s,
                    const contestant *c, const contestant *yardstick) {
    const bench_tree *tree = s->tree;
    const double rays = (double)s->size * s->size;
    const double samples = (double)tree->nodes[0] * tree->nodes[1] * tree->nodes[2];
    const double raw = samples * (double)sample_size(tree->type);
    double node;
    const double bytes = bench_tree_bytes(tree, c->keeping, c->finest, &node);
    bench_table_add(t, "%s", subject->label);
    bench_table_add(t, "%s", sample_name(tree->type));
    bench_table_add(t, "%s", NAMES[c->keeping]);
    bench_table_add(t, "%u^3", 1u << c->finest);
    bench_table_add(t, "%g", node);
    bench_table_add(t, "%.3f", bytes * 1e-6);
    bench_table_add(t, "%.3f", bytes / raw);
    if (c->keeping == KEEP_REUSE) {
        for (int i = 0; i < 3; i++)
            bench_table_add(t, "-");
    } else {
        bench_table_add(t, "%.1f", c->median / rays * 1e9);
        bench_table_add(t, "%.1f", c->spread / rays * 1e9);
        bench_table_add(t, "%.3f", c->median / yardstick->median);
    }
    bench_table_add(t, "%.3f", (double)c->nodes / rays);
    bench_table_add(t, "%.4f", (double)c->nodes / (double)yardstick->nodes);
    bench_table_add(t, "%.3f", (double)c->corners / rays);
    bench_table_add(t, "%.3f", (double)c->cells / rays);
    bench_table_add(t, "%llu", (unsigned long long)c->hits);
    bench_table_add(t, "%.3f", (bytes + raw) * 1e-6);
}

static status compare(bench_job *job, const bench_subject *subject, const bench_tree *tree) {
    contestant c[CONTESTANTS] = {{0}};
    scene s = {0};
    int count = 0;
    status st = set_scene(job, tree, subject->view.surfaces[0].isovalue, &s);
    double *seconds = mem_array(&job->m, (size_t)job->runs * CONTESTANTS, sizeof *seconds);
    if (!seconds)
        st = ST_NOMEM;
    for (uint32_t finest = BENCH_TREE_FINEST; finest < BENCH_TREE_FINEST + ENDS; finest++)
        for (int keeping = 0; keeping < KEEPINGS && st == ST_OK; keeping++) {
            if (keeping == KEEP_OWN && tree->type == SAMPLE_F32)
                continue;
            c[count].keeping = (bench_keeping)keeping;
            c[count].finest = finest;
            c[count].seconds = seconds + count * job->runs;
            count++;
        }
    if (st == ST_OK)
        st = race(job, &s, c, count);
    for (int i = 0; i < count && st == ST_OK; i++) {
        const contestant *yardstick = &c[i < count / 2 ? KEEP_FLOAT : count / 2 + KEEP_FLOAT];
        add_row(&job->table, subject, &s, &c[i], yardstick);
        if (c[i].keeping == KEEP_TREELET) {
            contestant reuse = c[i];
            reuse.keeping = KEEP_REUSE;
            add_row(&job->table, subject, &s, &reuse, yardstick);
        }
    }
    mem_free(&job->m, seconds);
    mem_free(&job->m, s.of_treelet);
    return st;
}

status bench_nodes(bench_job *job) {
    static const char *const names[] = {"bonsai",    "angiogram",   "ml-32",
                                        "ml-128",    "ct-head-u16", "cranium-i16",
                                        "stent-f32", "fingers-f32", NULL};
    static const char *const brief[] = {"ml-32", "noise-48", "orbital-64", NULL};
    bench_table_init(&job->table,
                     "M08 tables 4.2 to 4.4: how nodes keep their ranges; single rays, medians of "
                     "CPU time, runs interleaved",
                     "volume|type|ranges|ends at|bytes/node|tree MB|tree/raw|ns/ray|+-|x float|"
                     "nodes/ray|nodes x float|corners/ray|cells/ray|hits|memory MB");
    status st = ST_OK;
    for (int i = 0; st == ST_OK; i++) {
        bench_subject subject;
        bench_tree tree = {0};
        st = bench_suite_subject(job, names, brief, i, &subject);
        if (st == ST_OK) {
            st = bench_tree_load(&tree, &job->m, subject.path);
            if (st == ST_OK)
                st = compare(job, &subject, &tree);
            bench_tree_release(&tree);
        }
    }
    return st == ST_AGAIN ? ST_OK : st;
}
