#include "tests/spheres/spheres_kind.h"

#include <float.h>
#include <string.h>

#include "formats/base/box3.h"
#include "formats/base/vec3.h"
#include "render/door/leafcast_scene.h"
#include "render/frame/tile.h"
#include "render/ray/open_volume.h"
#include "tests/spheres/spheres_resident.h"

/* ---- An open volume ---- */

/* What rays need beside treelets: the tree over them, tracer.own. */
static status spheres_open(leafcast *v) {
    if (v->experiments.packets != 0)
        return status_describe(ST_USAGE, "packets are for meshes");
    return ST_OK;
}

static void spheres_close(leafcast *v) {
    (void)v;
}

static void spheres_describe(const leafcast *v, leafcast_info *info) {
    const spheres_directory *d = spheres_directory_of(v->file);
    info->cell = "sphere";
    info->cells = d->first[v->file->layout.treelets];
    for (int a = 0; a < 3; a++) {
        info->bounds[0][a] = (double)v->file->header.bounds[a];
        info->bounds[1][a] = (double)v->file->header.bounds[a + 3];
        info->cell_size *= cbrt(info->bounds[1][a] - info->bounds[0][a]);
    }
    info->cell_size /= cbrt((double)d->first[v->file->layout.treelets]);
}

static void spheres_active_box(const leafcast *v, uint32_t set, const double *isovalues, int count,
                               double corners[8][3]) {
    const float *bounds = v->file->header.bounds;
    (void)set, (void)isovalues, (void)count;
    for (int i = 0; i < 8; i++)
        for (int a = 0; a < 3; a++)
            corners[i][a] = (double)bounds[(i >> a & 1) * 3 + a];
}

static void spheres_span(const leafcast *v, uint32_t t, double span[2][3]) {
    box3_share_of(spheres_directory_of(v->file)->bounds[t], v->file->header.bounds, span);
}

/* ---- A frame ---- */

static status spheres_check(const leafcast *v, const leafcast_scene *scene) {
    (void)v;
    if (scene_intersector(scene) != LEAFCAST_MARMITT || scene->smooth_normals ||
        (scene->lod == LEAFCAST_LOD_LEVEL && scene->lod_level > 0))
        return status_describe(ST_USAGE, "spheres have no intersectors, normals or levels");
    return ST_OK;
}

static void spheres_aim(leafcast *v, const leafcast_scene *scene, const camera *c, tracer *tr) {
    (void)scene, (void)c;
    tr->own = v->treelets->tree;
    for (int a = 0; a < 3; a++) {
        tr->box[0][a] = (double)v->file->header.bounds[a];
        tr->box[1][a] = (double)v->file->header.bounds[a + 3];
    }
}

/* The square of the distance from a point to a box. */
static double distance_to(const float bounds[6], const double from[3]) {
    double sum = 0.0;
    for (int a = 0; a < 3; a++) {
        const double below = (double)bounds[a] - from[a], above = from[a] - (double)bounds[a + 3];
        const double outside = below > 0.0 ? below : above > 0.0 ? above : 0.0;
        sum += outside * outside;
    }
    return sum;
}

/* How far along a direction a box begins behind the place where the whole volume does. */
static double along(const tracer *tr, const float bounds[6], const double direction[3]) {
    double sum = 0.0;
    for (int a = 0; a < 3; a++) {
        const bool up = direction[a] > 0.0;
        sum += direction[a] * ((double)bounds[up ? a : a + 3] - tr->box[!up][a]);
    }
    return sum;
}

/* Numbers in the order of distances. */
static uint32_t ordered(double distance) {
    const float f = (float)distance;
    uint32_t bits;
    memcpy(&bits, &f, sizeof bits);
    return bits;
}

static uint32_t spheres_rank(const tracer *tr, uint32_t t, const ray_bundle *rays) {
    const treelet_tree *tree = tr->own;
    const float *bounds = tree->bounds[0][t];
    switch (rays->way) {
    case RAYS_FROM: return ordered(distance_to(bounds, rays->vector));
    case RAYS_TOWARDS: return ~ordered(distance_to(bounds, rays->vector));
    default: return ordered(fmax(along(tr, bounds, rays->vector), 0.0));
    }
}

/* ---- A ray ---- */

/* A treelet on a ray's way. */
typedef struct passage {
    double t_in;
    uint32_t t; /* LEAF_NO_TREELET: none */
} passage;

static bool passage_less(passage a, passage b) {
    return a.t_in != b.t_in ? a.t_in < b.t_in : a.t < b.t;
}

/* Whether the line passes a box, and from where on: a bit too early rather than too late, as the
 * roots err, too. */
static bool meets(const float bounds[6], const ray *r, double *t_in) {
    double in = -INFINITY, out = INFINITY, size = 0.0;
    for (int a = 0; a < 3; a++) {
        const double lo = (double)bounds[a] - r->o[a], hi = (double)bounds[a + 3] - r->o[a];
        if (r->d[a] == 0.0) {
            if (lo > 0.0 || hi < 0.0)
                return false;
            continue;
        }
        in = fmax(in, (r->d[a] > 0.0 ? lo : hi) / r->d[a]);
        out = fmin(out, (r->d[a] > 0.0 ? hi : lo) / r->d[a]);
        size = fmax(size, fmax(fabs(lo), fabs(hi)));
    }
    const double slack = 0x1p-40 * size / vec3_length(r->d);
    *t_in = in - slack;
    return in - slack <= out + slack;
}

enum { STACK_MAX = TREELET_TREE_LEVELS_MAX * TREELET_TREE_ARITY };

/* The first active treelet behind `last` that the ray enters at `limit` or before. */
static passage next_passage(const treelet_tree *tree, const ray *r, passage last, double limit,
                            ray_counters *counters) {
    passage best = {limit, LEAF_NO_TREELET};
    struct {
        uint32_t level, i;
    } stack[STACK_MAX], node;
    int top = 0;
    stack[top].level = tree->levels - 1;
    stack[top++].i = 0;
    while (top > 0) {
        node = stack[--top];
        passage p = {0.0, node.i};
        counters->nodes++;
        if (!tree->active[node.level][node.i] ||
            !meets(tree->bounds[node.level][node.i], r, &p.t_in) || p.t_in > best.t_in)
            continue;
        if (node.level == 0) {
            if (passage_less(last, p) && passage_less(p, best))
                best = p;
            continue;
        }
        uint32_t count, first = treelet_tree_children(tree, node.level, node.i, &count);
        for (uint32_t c = 0; c < count; c++) {
            stack[top].level = node.level - 1;
            stack[top++].i = first + c;
        }
    }
    return best;
}

/* Where the line is at distance^2 = square from a centre: in and out; false: nowhere. About the
 * point of the line that is nearest to the centre, so that nothing cancels but in the tangent. */
static bool roots(const double centre[3], double square, const ray *r, double t[2]) {
    double to[3], beside[3];
    vec3_sub(centre, r->o, to);
    const double length2 = vec3_dot(r->d, r->d), nearest = vec3_dot(to, r->d) / length2;
    for (int a = 0; a < 3; a++)
        beside[a] = to[a] - nearest * r->d[a];
    const double left = square - vec3_dot(beside, beside);
    if (!(left > 0.0))
        return false;
    const double half = sqrt(left / length2);
    t[0] = nearest - half;
    t[1] = nearest + half;
    return true;
}

/* Lower *best to the first hit of a ball behind `after`. */
static bool test_sphere(const tracer *tr, const sphere *x, uint64_t number, const ray *r,
                        const hit *after, hit *best, ray_counters *counters) {
    bool better = false;
    for (int i = 0; i < tr->isos.count; i++) {
        const double iso = tr->isos.isovalues[i];
        double t[2];
        counters->cells++;
        if (!(iso > 0.0 && iso <= x->peak) ||
            !roots(x->centre, x->radius * x->radius * (1.0 - iso / x->peak), r, t))
            continue;
        for (int k = 0; k < 2; k++) {
            const hit h = {t[k], number, i, k == 0};
            if (h.t < r->t0 || h.t > r->t1 || !hit_less(after, &h) || !hit_less(&h, best))
                continue;
            *best = h;
            counters->roots++;
            better = true;
        }
    }
    return better;
}

static surface_point spheres_surface(const tracer *tr, const treelet *at, const ray *r,
                                     const hit *h) {
    const spheres_treelet *own = spheres_treelet_of(at);
    const sphere *x = &own->spheres[h->cell - own->first];
    const double slope = 2.0 * x->peak / (x->radius * x->radius);
    surface_point p = {.span = x->radius};
    double away[3], size = 0.0;
    (void)tr;
    for (int a = 0; a < 3; a++) {
        away[a] = r->o[a] + h->t * r->d[a] - x->centre[a];
        size += fabs(r->o[a]) + fabs(h->t * r->d[a]) + fabs(x->centre[a]);
        p.gradient[a] = -slope * away[a];
    }
    p.error = 16.0 * DBL_EPSILON * (slope * size * x->radius + x->peak);
    double unit[3] = {0.0, 0.0, 0.0};
    (void)vec3_unit(away, unit);
    for (int a = 0; a < 3; a++)
        p.normal[a] = (float)unit[a];
    return p;
}

static void walk(const tracer *tr, const treelet *here, const ray *r, trace_state *state,
                 ray_counters *counters) {
    const spheres_treelet *own = spheres_treelet_of(here);
    bool better = false;
    for (uint32_t i = 0; i < own->count; i++)
        if (own->active[i])
            better |= test_sphere(tr, &own->spheres[i], own->first + i, r, &state->after,
                                  &state->best, counters);
    if (better)
        state->point = spheres_surface(tr, here, r, &state->best);
}

/* A hit is final when the next treelet begins behind it; the ray resumes at the pair (where it
 * enters, treelet). */
static trace_result spheres_next(const tracer *tr, const ray *r, trace_state *state,
                                 ray_counters *counters) {
    const treelet_tree *tree = tr->own;
    bool resuming = state->blocked != LEAF_NO_TREELET;
    passage at = {resuming ? state->t_from : -INFINITY, resuming ? state->blocked : 0};
    for (;; resuming = false) {
        if (!resuming) {
            at = next_passage(tree, r, at, fmin(state->best.t, r->t1), counters);
            if (at.t == LEAF_NO_TREELET)
                return hit_exists(&state->best) ? TRACE_HIT : TRACE_MISS;
        }
        const treelet *here =
            tracer_enter(tr, at.t, at.t_in, &state->t_from, &state->blocked, &state->provisional);
        if (!here && !tr->preview)
            return TRACE_BLOCKED;
        if (here)
            walk(tr, here, r, state, counters);
    }
}

/* ---- Cells ---- */

static bool holds(const sphere *x, const double point[3], leafcast_sample *sample) {
    double away[3];
    vec3_sub(point, x->centre, away);
    const double share = vec3_dot(away, away) / (x->radius * x->radius);
    if (share > 1.0)
        return false;
    sample->inside = true;
    sample->value = sample->nearest = x->peak * (1.0 - share); /* there are no nodes */
    for (int a = 0; a < 3; a++)
        sample->gradient[a] = -2.0 * x->peak / (x->radius * x->radius) * away[a];
    return true;
}

static uint32_t spheres_treelet_at(const leafcast *v, uint32_t level, const double point[3],
                                   uint32_t after) {
    const treelet_tree *tree = v->treelets->tree;
    (void)level;
    for (uint32_t t = after + 1; t < v->file->layout.treelets; t++) /* LEAF_NO_TREELET + 1: 0 */
        if (!(distance_to(tree->bounds[0][t], point) > 0.0))
            return t;
    return LEAF_NO_TREELET;
}

static void spheres_cell_in(const leafcast *v, const treelet *at, const double point[3],
                            leafcast_sample *sample) {
    const spheres_treelet *own = spheres_treelet_of(at);
    (void)v;
    for (uint32_t i = 0; i < own->count && !sample->inside; i++)
        if (holds(&own->spheres[i], point, sample)) {
            sample->treelet = at->id;
            sample->cell = own->first + i;
        }
}

static double spheres_cells_along(const leafcast *v, const double vector[3]) {
    leafcast_info info = {.cell_size = 1.0};
    spheres_describe(v, &info);
    return sqrt(vec3_dot(vector, vector)) / info.cell_size;
}

static status spheres_layer(const leafcast *v, int axis, uint32_t node, double origin[3],
                            double edges[2][3]) {
    (void)v, (void)axis, (void)node, (void)origin, (void)edges;
    return status_describe(ST_USAGE, "spheres have no planes of nodes");
}

const kind spheres_kind = {.name = "spheres",
                           .open = spheres_open,
                           .close = spheres_close,
                           .describe = spheres_describe,
                           .active_box = spheres_active_box,
                           .span = spheres_span,
                           .check = spheres_check,
                           .aim = spheres_aim,
                           .tile_side = TILE_MAX,
                           .rank = spheres_rank,
                           .next = spheres_next,
                           .treelet_at = spheres_treelet_at,
                           .cell_in = spheres_cell_in,
                           .cells_along = spheres_cells_along,
                           .layer = spheres_layer};
