#include <math.h>
#include <string.h>

#include "formats/base/exact.h"
#include "render/leafcast_volume.h"
#include "render/mesh/mesh_walk.h"

/* Bring in the one treelet that a probe needs. */
static status need(leafcast *v, uint32_t t) {
    loader_request request = {t, 0};
    return loader_admit(v->treelets, &request, 1);
}

/* Treelet t, brought in if need be: what rays have seen may have given way to others since. */
static status resident(leafcast *v, uint32_t t, const treelet **out) {
    status st = ST_OK;
    for (*out = loader_lookup(v->treelets, t); !*out && st == ST_OK;
         *out = loader_lookup(v->treelets, t))
        st = need(v, t);
    return st;
}

/* ---- Rays ---- */

static status cell_of_hit(leafcast *v, const tracer *tr, const ray *r, const hit *h,
                          leafcast_hit *out) {
    const level_planes *planes = &v->planes.levels[tr->target_level];
    uint32_t place[3];
    const treelet *at;
    surface_cell_of(planes, h->cell, out->cell);
    for (int a = 0; a < 3; a++) {
        const uint32_t c = out->cell[a];
        const double x = r->o[a] + h->t * r->d[a];
        out->at[a] = fmin(fmax((x - planes->at[a][c]) * planes->inverse[a][c], 0.0), 1.0);
        place[a] = c >> v->file->layout.cells_log2;
    }
    status st = resident(v, leaf_layout_find(&v->file->layout, tr->target_level, place), &at);
    if (st == ST_OK)
        walk_cell_samples(&tr->scene, at, out->cell, out->samples);
    return st;
}

static uint32_t treelet_of_tet(const leaf_file *f, uint64_t number) {
    uint32_t lo = 0, hi = f->layout.treelets;
    while (hi - lo > 1) {
        const uint32_t middle = lo + (hi - lo) / 2;
        if (f->mesh->first_tet[middle] <= number)
            lo = middle;
        else
            hi = middle;
    }
    return lo;
}

static void copy_tet(const treelet *at, uint32_t place, float vertices[4][3], float values[4]) {
    const tet x = mesh_walk_tet(at, place);
    memcpy(vertices, x.p, sizeof x.p);
    memcpy(values, x.f, sizeof x.f);
}

static status tet_of_hit(leafcast *v, const hit *h, leafcast_hit *out) {
    const treelet *at;
    out->tet = h->cell;
    status st = resident(v, treelet_of_tet(v->file, h->cell), &at);
    if (st != ST_OK)
        return st;
    copy_tet(at, (uint32_t)(h->cell - at->first_tet), out->vertices, out->values);
    double p[4][3];
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 3; k++)
            p[i][k] = (double)out->vertices[i][k];
    out->flat = exact_orientation((const double(*)[3])p) == 0;
    return ST_OK;
}

static status describe_hit(leafcast *v, const tracer *tr, const ray *r, const double origin[3],
                           const double direction[3], const trace_state *state, leafcast_hit *out) {
    const hit *h = &state->best;
    double slope = 0.0;
    *out = (leafcast_hit){.t = h->t, .surface = h->iso, .entering = h->entering};
    for (int a = 0; a < 3; a++) {
        out->point[a] = origin[a] + h->t * direction[a];
        out->gradient[a] = state->point.gradient[a];
        out->normal[a] = (double)state->point.normal[a];
        slope += state->point.gradient[a] * direction[a];
    }
    out->error_bound = slope != 0.0 ? state->point.error / fabs(slope) : INFINITY;
    return tr->tree ? tet_of_hit(v, h, out) : cell_of_hit(v, tr, r, h, out);
}

static status probe_ray(leafcast *v, const leafcast_scene *scene, const double origin[3],
                        const double direction[3], leafcast_hit *hits, int max, int *count) {
    tracer tr;
    ray r;
    ray_counters counters = {0};
    *count = 0;
    double length = 0.0, place = 0.0;
    for (int a = 0; a < 3; a++) {
        length += fabs(direction[a]);
        place += fabs(origin[a]);
    }
    if (!(length > 0.0 && length < INFINITY && place < INFINITY))
        return status_describe(ST_USAGE, "a ray needs a finite origin and a finite direction that "
                                         "is not 0,0,0");
    status st = volume_tracer(v, scene, NULL, &tr);
    if (st != ST_OK)
        return st;
    tr.preview = false;
    loader_forget_failures(v->treelets);
    if (!tracer_ray(&tr, origin, direction, 0.0, INFINITY, &r))
        return ST_OK;
    const hit before = hit_before_all();
    trace_state state = trace_begin(&before);
    while (*count < max) {
        const trace_result result = tracer_next(&tr, &r, &state, &counters);
        if (result == TRACE_MISS)
            break;
        if (result == TRACE_BLOCKED) {
            st = need(v, state.blocked);
            if (st != ST_OK)
                return st;
            continue;
        }
        st = describe_hit(v, &tr, &r, origin, direction, &state, &hits[*count]);
        if (st != ST_OK)
            return st;
        ++*count;
        const hit behind = state.best;
        state = trace_begin(&behind);
    }
    return ST_OK;
}

leafcast_status leafcast_probe_ray(leafcast *v, const leafcast_scene *scene, const double origin[3],
                                   const double direction[3], leafcast_hit *hits, int max,
                                   int *count) {
    const status st = probe_ray(v, scene, origin, direction, hits, max, count);
    return volume_public_status(volume_check_file(v, st));
}

/* ---- Points ---- */

/* The cell that owns a coordinate: [i, i + 1), the last one its end too. */
static uint32_t cell_owning(const double *axis, uint32_t nodes, double x) {
    uint32_t lo = 0, hi = nodes - 1;
    while (hi - lo > 1) {
        const uint32_t middle = lo + (hi - lo) / 2;
        if (axis[middle] <= x)
            lo = middle;
        else
            hi = middle;
    }
    return lo;
}

static status point_in_grid(leafcast *v, const double point[3], leafcast_sample *sample) {
    const level_planes *planes = &v->planes.levels[0];
    const leaf_layout *layout = &v->file->layout;
    double grid[3];
    uint32_t place[3];
    affine_point_to_grid(&v->space, point, grid);
    for (int a = 0; a < 3; a++) {
        const double *axis = v->file->axis[a];
        if (!(grid[a] >= axis[0] && grid[a] <= axis[planes->cells[a]]))
            return ST_OK;
        sample->cell[a] = cell_owning(axis, planes->cells[a] + 1, grid[a]);
        sample->at[a] =
            (grid[a] - planes->at[a][sample->cell[a]]) * planes->inverse[a][sample->cell[a]];
        place[a] = sample->cell[a] >> layout->cells_log2;
    }
    sample->inside = true;
    sample->treelet = leaf_layout_find(layout, 0, place);
    const treelet *at;
    status st = resident(v, sample->treelet, &at);
    if (st != ST_OK)
        return st;
    const walk_scene scene = {
        .levels = v->planes.levels, .type = layout->type, .halo = layout->halo};
    double gradient[3], inverse[3];
    for (int a = 0; a < 3; a++)
        inverse[a] = planes->inverse[a][sample->cell[a]];
    walk_cell_samples(&scene, at, sample->cell, sample->samples);
    sample->value = surface_trilinear(sample->samples, sample->at, inverse, gradient);
    affine_gradient_to_world(&v->space, gradient, sample->gradient);
    return ST_OK;
}

/* Treelets are looked at in order, so that of the tets that share a point it is the first. */
static status point_in_mesh(leafcast *v, const double point[3], leafcast_sample *sample) {
    const leaf_layout *layout = &v->file->layout;
    for (uint32_t t = 0; t < layout->treelets; t++) {
        const float *bounds = v->file->mesh->bounds[leaf_layout_bounds(layout, v->step, t)];
        bool within = true;
        for (int a = 0; a < 3; a++)
            within &= (double)bounds[a] <= point[a] && point[a] <= (double)bounds[a + 3];
        if (!within)
            continue;
        const treelet *at;
        uint32_t place;
        double weights[4];
        status st = resident(v, t, &at);
        if (st != ST_OK)
            return st;
        if (!mesh_walk_find(at, point, &place, weights))
            continue;
        const tet x = mesh_walk_tet(at, place);
        *sample = (leafcast_sample){.inside = true, .treelet = t, .tet = at->first_tet + place};
        copy_tet(at, place, sample->vertices, sample->values);
        for (int k = 0; k < 4; k++)
            if (weights[k] > 0.0)
                sample->value += weights[k] * (isfinite(x.f[k]) ? (double)x.f[k] : (double)NAN);
        (void)tet_gradient(&x, sample->gradient);
        return ST_OK;
    }
    return ST_OK;
}

leafcast_status leafcast_probe_point(leafcast *v, const double point[3], leafcast_sample *sample) {
    *sample = (leafcast_sample){.value = NAN};
    loader_forget_failures(v->treelets);
    const status st = (v->file->mesh ? point_in_mesh : point_in_grid)(v, point, sample);
    return volume_public_status(volume_check_file(v, st));
}
