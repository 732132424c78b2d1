#include <limits.h>
#include <math.h>

#include "render/door/arguments.h"
#include "render/door/between_steps.h"
#include "render/door/leafcast_device.h"
#include "render/door/leafcast_scene.h"
#include "render/door/leafcast_volume.h"
#include "render/ray/kind.h"

/* Load the treelet that a probe needs, and wait for it. */
static status need(leafcast *v, uint32_t t) {
    loader_request request = {t, 0};
    return loader_admit(v->treelets, &request, 1);
}

status volume_treelet(leafcast *v, uint32_t t, const treelet **out) {
    status st = ST_OK;
    for (*out = loader_lookup(v->treelets, t); !*out && st == ST_OK;
         *out = loader_lookup(v->treelets, t))
        st = need(v, t);
    return st;
}

/* ---- Rays ---- */

static bool is_listed(const leafcast *v, const leafcast_scene *scene) {
    bool listed = false;
    for (int i = 0; i < scene->volume_count && !listed; i++)
        listed = scene->volumes[i].volume == v;
    return listed;
}

/* Select the surfaces of the scene's first object of the probed volume, of which *v shows the
 * moment then. *place: where it is. */
static status show(leafcast **v, const leafcast_scene *scene, placement *place) {
    const interest nothing = {.count = 0};
    status st = scene_check(*v, scene);
    if (st == ST_OK && scene->volume_count > 0 && !is_listed(*v, scene))
        return status_describe(ST_USAGE, "the scene does not show the volume that is probed");
    if (st != ST_OK)
        return st;
    leafcast_shown shown = scene_object(*v, scene, (*v)->listed);
    *place = placement_of(shown.place);
    st = between_steps_open(v, shown.between);
    if (st != ST_OK)
        return st;
    device_make_room(*v);
    loader_forget_failures((*v)->treelets);
    shown.volume = *v;
    shown.step = (*v)->live ? (*v)->step : shown.step;
    volume_show_beside(&shown, &nothing);
    return ST_OK;
}

static status describe_hit(leafcast *v, const tracer *tr, const ray *r, const double origin[3],
                           const double direction[3], const trace_state *state, leafcast_hit *out) {
    const hit *h = &state->best;
    double slope = 0.0;
    *out = (leafcast_hit){.t = h->t,
                          .surface = h->iso,
                          .entering = h->entering,
                          .level = tr->target_level,
                          .cell = h->cell};
    for (int a = 0; a < 3; a++) {
        out->point[a] = origin[a] + h->t * direction[a];
        out->gradient[a] = state->point.gradient[a];
        out->normal[a] = (double)state->point.normal[a];
        slope += state->point.gradient[a] * direction[a];
    }
    out->error_bound = slope != 0.0 ? state->point.error / fabs(slope) : INFINITY;
    return v->kind->cell_of_hit ? v->kind->cell_of_hit(v, tr, r, h, out) : ST_OK;
}

/* Check the arguments of a call. found: the caller's array of `max` answers. */
static status check_call(const char *call, const leafcast *v, const leafcast_scene *scene,
                         const double origin[3], const double direction[3], const void *found,
                         int max, int *count) {
    status st = arguments_check_volume(call, v);
    if (st == ST_OK)
        st = public_needs(call, "scene origin direction count",
                          (const void *[]){scene, origin, direction, count});
    if (st != ST_OK)
        return st;
    *count = 0;
    st = public_in_range(call, "max", max, 0, INT_MAX);
    if (st == ST_OK && max > 0)
        st = public_needs(call, "found", (const void *[]){found});
    if (st == ST_OK)
        st = arguments_check_ray(origin, direction);
    return st == ST_OK ? arguments_check_scene(scene) : st;
}

static status probe_ray(leafcast *v, const leafcast_scene *scene, const double origin[3],
                        const double direction[3], leafcast_hit *hits, int max, int *count) {
    tracer tr;
    ray r;
    ray_counters counters = {0};
    placement place;
    status st = show(&v, scene, &place);
    if (st == ST_OK)
        st = volume_tracer(v, scene, NULL, &tr);
    if (st != ST_OK)
        return st;
    tr.place = place;
    tr.preview = tr.lenient = false;
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
    status st = check_call(__func__, v, scene, origin, direction, hits, max, count);
    if (st != ST_OK)
        return public_status(st);
    live_hold h;
    volume_lock(v, &h);
    st = volume_check_file(v, probe_ray(v, scene, origin, direction, hits, max, count));
    volume_unlock(v, &h);
    return public_status(st);
}

/* ---- Segments ---- */

static leafcast_segment segment_told(const tracer *tr, const segment *s) {
    const segment_extent e = segment_range(s);
    leafcast_segment out = {.t0 = s->t0,
                            .t1 = s->t1,
                            .degree = (int)s->degree,
                            .least = e.least,
                            .most = e.most,
                            .least_t = e.least_t,
                            .most_t = e.most_t,
                            .level = tr->layout->level_of[s->treelet],
                            .cell = s->cell};
    for (uint32_t i = 0; i <= s->degree; i++)
        out.control[i] = s->b[i];
    return out;
}

enum { AHEAD = 256 };

static status follow(leafcast *v, const tracer *tr, const ray *r, leafcast_segment *segments,
                     int max, int *count) {
    segment ahead[AHEAD], found;
    ray_counters counters = {0};
    segments_state state = segments_begin(ahead, AHEAD);
    status st = ST_OK;
    while (*count < max && st == ST_OK) {
        const segments_result result = segments_next(tr, r, &state, &found, &counters);
        if (result == SEGMENTS_END)
            break;
        if (result == SEGMENTS_BLOCKED)
            st = need(v, state.blocked);
        else
            segments[(*count)++] = segment_told(tr, &found);
    }
    return st;
}

static status probe_segments(leafcast *v, const leafcast_scene *scene, const double origin[3],
                             const double direction[3], leafcast_segment *segments, int max,
                             int *count) {
    tracer tr;
    ray r;
    placement place;
    status st = show(&v, scene, &place);
    if (st == ST_OK)
        st = volume_tracer_of_all(v, scene, NULL, &tr);
    if (st != ST_OK)
        return st;
    tr.place = place;
    tr.preview = tr.lenient = false;
    /* Make the whole volume active while the ray is followed. Then select the isovalues again. */
    const interest all = interest_of_all();
    const interest shown = interest_of_isovalues(v->isovalues, v->isovalue_count);
    loader_select(v->treelets, &all);
    if (tracer_ray(&tr, origin, direction, 0.0, INFINITY, &r))
        st = follow(v, &tr, &r, segments, max, count);
    loader_select(v->treelets, &shown);
    return st;
}

leafcast_status leafcast_probe_segments(leafcast *v, const leafcast_scene *scene,
                                        const double origin[3], const double direction[3],
                                        leafcast_segment *segments, int max, int *count) {
    status st = check_call(__func__, v, scene, origin, direction, segments, max, count);
    if (st == ST_OK)
        st = arguments_check_values(__func__, v);
    if (st != ST_OK)
        return public_status(st);
    live_hold h;
    volume_lock(v, &h);
    st = volume_check_file(v, probe_segments(v, scene, origin, direction, segments, max, count));
    volume_unlock(v, &h);
    return public_status(st);
}

/* ---- Cells ---- */

/* Let treelets of the selected field and step be looked up, in what *v is then. */
static status show_set(leafcast **at) {
    const leafcast *of = *at;
    const status st = between_steps_open(at, of->share);
    leafcast *v = *at;
    if (st != ST_OK)
        return st;
    device_make_room(v);
    loader_forget_failures(v->treelets);
    v->set = between_steps_set(v, of->field, of->step, of->share);
    loader_select_set(v->treelets, v->set);
    return ST_OK;
}

static status describe_cell(leafcast *v, uint32_t level, uint64_t number, leafcast_cell *out) {
    const status st = show_set(&v);
    *out = (leafcast_cell){.size = sizeof *out, .cell = number, .level = level};
    if (st != ST_OK)
        return st;
    if (number >= leafcast_describe(v).cells && level == 0)
        return status_describe(ST_USAGE, "%s %llu: there are %llu", leafcast_describe(v).cell,
                               (unsigned long long)number,
                               (unsigned long long)leafcast_describe(v).cells);
    if (!v->kind->cell_corners)
        return ST_OK;
    out->indices = leafcast_cell_indices(v, level, number, out->index);
    return v->kind->cell_corners(v, level, number, out);
}

leafcast_status leafcast_get_cell(leafcast *v, uint32_t level, uint64_t number,
                                  leafcast_cell *cell) {
    status st = arguments_check_volume(__func__, v);
    if (st == ST_OK)
        st = public_needs(__func__, "cell", (const void *[]){cell});
    if (st == ST_OK)
        st = arguments_check_cell(cell);
    if (st == ST_OK)
        st = leaf_file_check_level(v->file, level);
    if (st != ST_OK)
        return public_status(st);
    live_hold h;
    volume_lock(v, &h);
    st = volume_check_file(v, describe_cell(v, level, number, cell));
    volume_unlock(v, &h);
    return public_status(st);
}

int leafcast_cell_indices(const leafcast *v, uint32_t level, uint64_t number, uint32_t index[3]) {
    if (!v || !index || !v->kind->cell_indices || level >= v->file->layout.sampled)
        return 0;
    return v->kind->cell_indices(v, level, number, index);
}

/* ---- Points ---- */

static status probe_point(leafcast *v, const double point[3], leafcast_sample *sample) {
    status st = show_set(&v);
    for (uint32_t t = LEAF_NO_TREELET; !sample->inside && st == ST_OK;) {
        const treelet *at;
        t = v->kind->walks->treelet_at(v, 0, point, t);
        if (t == LEAF_NO_TREELET)
            break;
        st = volume_treelet(v, t, &at);
        if (st == ST_OK)
            v->kind->cell_in(v, at, point, sample);
    }
    return st;
}

leafcast_status leafcast_probe_point(leafcast *v, const double point[3], leafcast_sample *sample) {
    status st = arguments_check_points(__func__, v);
    if (st == ST_OK)
        st = public_needs(__func__, "point sample", (const void *[]){point, sample});
    if (st != ST_OK)
        return public_status(st);
    *sample = (leafcast_sample){.value = NAN, .nearest = NAN};
    live_hold h;
    volume_lock(v, &h);
    st = volume_check_file(v, probe_point(v, point, sample));
    volume_unlock(v, &h);
    return public_status(st);
}
