/* leafcast_fit.c - suggestions: histograms, data ranges, isovalues, the view that fits. */
#include <float.h>
#include <limits.h>
#include <math.h>
#include <string.h>

#include "formats/leaf/leaf_histogram.h"
#include "render/door/arguments.h"
#include "render/door/leafcast_volume.h"
#include "render/ray/kind.h"

_Static_assert((int)LEAFCAST_BINS_MAX == (int)HISTOGRAM_BINS &&
                   (int)LEAFCAST_SUGGESTIONS_MAX == (int)HISTOGRAM_ISOVALUES,
               "public and internal sizes agree");

static status find_histogram(const leafcast *v, uint32_t field, uint32_t step, histogram *out) {
    mem outside;
    live_hold h;
    status st = volume_check_set(v, field, step);
    if (st != ST_OK)
        return st;
    mem_init(&outside, 0);
    step = volume_hold(v, step, &h);
    st = leaf_histogram_get(&outside, v->file, leaf_layout_set(&v->file->layout, field, step), out);
    volume_let_go(v, &h);
    return st;
}

leafcast_status leafcast_get_histogram(const leafcast *v, uint32_t field, uint32_t step,
                                       leafcast_histogram *to) {
    histogram h;
    status st = public_needs(__func__, "volume histogram", (const void *[]){v, to});
    if (st == ST_OK)
        st = find_histogram(v, field, step, &h);
    if (st != ST_OK)
        return public_status(st);
    *to =
        (leafcast_histogram){.bins = h.bins, .drawn = h.drawn, .cells = h.cells, .total = h.total};
    memcpy(to->edges, h.edges, sizeof to->edges);
    memcpy(to->samples, h.samples, sizeof to->samples);
    memcpy(to->active, h.active, sizeof to->active);
    memcpy(to->gradient, h.gradient, sizeof to->gradient);
    memcpy(to->area, h.area, sizeof to->area);
    uint32_t data[2];
    histogram_marker marker;
    to->aside = histogram_data(&h, data, &marker) ? marker.value : (double)NAN;
    to->first = data[0];
    to->end = data[1];
    return LEAFCAST_OK;
}

leafcast_status leafcast_data_range(const leafcast *v, uint32_t field, uint32_t step,
                                    double range[2]) {
    histogram h;
    uint32_t data[2];
    histogram_marker marker;
    const leafcast_status told = leafcast_range(v, field, step, range);
    if (told != LEAFCAST_OK)
        return told;
    const status st = find_histogram(v, field, step, &h);
    if (st == ST_OK && histogram_data(&h, data, &marker)) {
        /* Bin edges of integer data lie half way between two integers. */
        const double half = v->file->layout.type == SAMPLE_F32 ? 0.0 : 0.5;
        range[0] = fmax(range[0], h.edges[data[0]] + half);
        range[1] = fmin(range[1], h.edges[data[1]] - half);
    }
    return public_status(st);
}

leafcast_status leafcast_suggested_isovalues(const leafcast *v, uint32_t field, uint32_t step,
                                             double *isovalues, int max, int *count) {
    histogram h;
    status st = public_needs(__func__, "volume count isovalues",
                             (const void *[]){v, count, max == 0 ? (void *)count : isovalues});
    if (st != ST_OK)
        return public_status(st);
    *count = 0;
    st = public_in_range(__func__, "max", max, 0, INT_MAX);
    if (st == ST_OK)
        st = find_histogram(v, field, step, &h);
    if (st == ST_OK && max > 0 && v->kind->given) {
        isovalues[0] = 0.0;
        *count = 1;
    } else if (st == ST_OK && max > 0)
        *count = histogram_suggest(&h, isovalues,
                                   max < LEAFCAST_SUGGESTIONS_MAX ? max : LEAFCAST_SUGGESTIONS_MAX);
    return public_status(st);
}

static status check_isovalues(const char *call, const double *isovalues, int count) {
    status st = public_in_range(call, "count", count, 0, LEAFCAST_SURFACES_MAX);
    if (st == ST_OK && count > 0)
        st = public_needs(call, "isovalues", (const void *[]){isovalues});
    for (int i = 0; i < count && st == ST_OK; i++)
        st = public_in_range(call, "an isovalue", isovalues[i], -DBL_MAX, DBL_MAX);
    return st;
}

leafcast_status leafcast_fit_view(const leafcast *v, uint32_t field, uint32_t step,
                                  const double *isovalues, int count, double fov, uint32_t width,
                                  uint32_t height, leafcast_camera *view) {
    double corners[8][3];
    status st = arguments_begin_view(__func__, view, width, height);
    if (st == ST_OK)
        st = public_needs(__func__, "volume", (const void *[]){v});
    if (st == ST_OK)
        st = volume_check_set(v, field, step);
    if (st == ST_OK)
        st = check_isovalues(__func__, isovalues, count);
    if (st == ST_OK)
        st = public_below(__func__, "fov", fov, 0.0, 180.0);
    if (st != ST_OK)
        return public_status(st);
    live_hold h;
    step = volume_hold(v, step, &h);
    v->kind->walks->active_box(v, leaf_layout_set(&v->file->layout, field, step), isovalues,
                               v->kind->given ? 0 : count, corners);
    volume_let_go(v, &h);
    *view =
        camera_fit((const double(*)[3])corners, fov > 0.0 ? fov : LEAFCAST_FIT_FOV, width, height);
    return LEAFCAST_OK;
}
