/* leafcast_fit.c - what is worth a look, and from where: histograms, isovalues, the view that fits.
 */
#include <math.h>
#include <string.h>

#include "formats/leaf/leaf_histogram.h"
#include "render/leafcast_volume.h"

_Static_assert((int)LEAFCAST_BINS_MAX == (int)HISTOGRAM_BINS &&
                   (int)LEAFCAST_SUGGESTIONS_MAX == (int)HISTOGRAM_ISOVALUES,
               "public and internal sizes agree");

static status find_histogram(const leafcast *v, uint32_t field, uint32_t step, histogram *out) {
    mem outside;
    const status st = volume_check_set(v, field, step);
    if (st != ST_OK)
        return st;
    mem_init(&outside, 0);
    const uint32_t set = v->file->mesh ? leaf_layout_set(&v->file->layout, field, step) : 0;
    return leaf_histogram_get(&outside, v->file, set, out);
}

leafcast_status leafcast_get_histogram(const leafcast *v, uint32_t field, uint32_t step,
                                       leafcast_histogram *to) {
    histogram h;
    const status st = find_histogram(v, field, step, &h);
    if (st != ST_OK)
        return volume_public_status(st);
    *to =
        (leafcast_histogram){.bins = h.bins, .drawn = h.drawn, .cells = h.cells, .total = h.total};
    memcpy(to->edges, h.edges, sizeof to->edges);
    memcpy(to->samples, h.samples, sizeof to->samples);
    memcpy(to->active, h.active, sizeof to->active);
    memcpy(to->gradient, h.gradient, sizeof to->gradient);
    memcpy(to->area, h.area, sizeof to->area);
    return LEAFCAST_OK;
}

leafcast_status leafcast_suggested_isovalues(const leafcast *v, uint32_t field, uint32_t step,
                                             double *isovalues, int max, int *count) {
    histogram h;
    const status st = find_histogram(v, field, step, &h);
    *count = st == ST_OK ? histogram_suggest(&h, isovalues, max) : 0;
    return volume_public_status(st);
}

/* ---- the box of what is active ---- */

static void widen(double box[2][3], const double lo[3], const double hi[3]) {
    for (int a = 0; a < 3; a++) {
        box[0][a] = fmin(box[0][a], lo[a]);
        box[1][a] = fmax(box[1][a], hi[a]);
    }
}

static bool is_active(const float range[2], const double *isovalues, int count) {
    for (int i = 0; i < count; i++)
        if ((double)range[0] < isovalues[i] && isovalues[i] <= (double)range[1])
            return true;
    return false;
}

/* Of the cells that the histogram has seen in the isovalue's bin and the next one: nodes. */
static void widen_by_histogram(const leafcast *v, double isovalue, double box[2][3]) {
    const histogram *h = v->file->histograms;
    const uint32_t *dims = v->file->header.dims;
    for (uint32_t k = 0; k < h->bins; k++) {
        const bool near = h->edges[k + 1] > isovalue && (k == 0 || h->edges[k - 1] <= isovalue);
        double lo[3], hi[3];
        if (!near || !h->active[k])
            continue;
        for (int a = 0; a < 3; a++) {
            const double last = dims[a] - 1.0;
            lo[a] = h->box[k][a] * last / 255.0;
            hi[a] = fmin(last, (h->box[k][3 + a] + 1) * last / 255.0 + 1.0);
        }
        widen(box, lo, hi);
    }
}

/* Of the treelets of level 0: nodes. */
static void widen_by_treelets(const leafcast *v, const double *isovalues, int count,
                              double box[2][3]) {
    const leaf_layout *l = &v->file->layout;
    for (uint32_t t = l->level[0].first; t < l->treelets; t++) {
        double lo[3], hi[3];
        if (!is_active(v->file->own[t], isovalues, count))
            continue;
        for (int a = 0; a < 3; a++) {
            lo[a] = (double)l->place[t][a] * (1u << l->cells_log2);
            hi[a] = fmin(lo[a] + (1u << l->cells_log2), v->file->header.dims[a] - 1.0);
        }
        widen(box, lo, hi);
    }
}

static double axis_at(const leafcast *v, int a, double node) {
    const double *axis = v->file->axis[a], before = floor(node);
    const uint32_t i = (uint32_t)before, last = v->file->header.dims[a] - 1;
    return i >= last ? axis[last] : axis[i] + (node - before) * (axis[i + 1] - axis[i]);
}

static void grid_box(const leafcast *v, const double *isovalues, int count, double box[2][3]) {
    if (v->file->histograms)
        for (int i = 0; i < count; i++)
            widen_by_histogram(v, isovalues[i], box);
    else
        widen_by_treelets(v, isovalues, count, box);
    for (int a = 0; a < 3; a++) {
        const bool any = box[0][a] <= box[1][a];
        box[0][a] = axis_at(v, a, any ? box[0][a] : 0.0);
        box[1][a] = axis_at(v, a, any ? box[1][a] : v->file->header.dims[a] - 1.0);
    }
}

static void mesh_box(const leafcast *v, uint32_t field, uint32_t step, const double *isovalues,
                     int count, double box[2][3]) {
    const leaf_layout *l = &v->file->layout;
    const float(*own)[2] =
        (const float(*)[2])v->file->own + (size_t)leaf_layout_set(l, field, step) * l->treelets;
    for (uint32_t t = 0; t < l->treelets; t++) {
        const float *bounds = v->file->mesh->bounds[leaf_layout_bounds(l, step, t)];
        double lo[3], hi[3];
        for (int a = 0; a < 3; a++) {
            lo[a] = (double)bounds[a];
            hi[a] = (double)bounds[3 + a];
        }
        if (is_active(own[t], isovalues, count))
            widen(box, lo, hi);
    }
    const bool none = box[0][0] > box[1][0];
    for (int a = 0; a < 3 && none; a++) {
        box[0][a] = (double)v->file->header.bounds[a];
        box[1][a] = (double)v->file->header.bounds[3 + a];
    }
}

leafcast_status leafcast_fit_view(const leafcast *v, uint32_t field, uint32_t step,
                                  const double *isovalues, int count, double fov, uint32_t width,
                                  uint32_t height, leafcast_camera *view) {
    double box[2][3] = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    double corners[8][3];
    const status st = volume_check_set(v, field, step);
    if (st != ST_OK)
        return volume_public_status(st);
    if (v->file->mesh)
        mesh_box(v, field, step, isovalues, count, box);
    else
        grid_box(v, isovalues, count, box);
    for (int i = 0; i < 8; i++) {
        const double corner[3] = {box[i & 1][0], box[i >> 1 & 1][1], box[i >> 2][2]};
        memcpy(corners[i], corner, sizeof corner);
        if (!v->file->mesh)
            affine_point_to_world(&v->space, corner, corners[i]);
    }
    *view =
        camera_fit((const double(*)[3])corners, fov > 0.0 ? fov : LEAFCAST_FIT_FOV, width, height);
    return LEAFCAST_OK;
}
