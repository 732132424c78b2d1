#include "prep/import/dicom/dicom_order.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/text.h"

static const double loose = 0.01; /* tolerance, as a part of a distance */

typedef struct order {
    const dicom_study *study;
    dicom_slice *slices;
    size_t count;
} order;

static const char *path_of(const order *o, size_t i) {
    return o->study->files.path[o->slices[i].file];
}

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double distance(const double a[3], const double b[3]) {
    const double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    return sqrt(dot(d, d));
}

/* ---- sorting ---- */

static int by_number(const void *a, const void *b) {
    const dicom_slice *s = a, *t = b;
    if (s->place.number != t->place.number)
        return s->place.number < t->place.number ? -1 : 1;
    if (s->file != t->file)
        return s->file < t->file ? -1 : 1;
    return s->frame < t->frame ? -1 : s->frame > t->frame;
}

static int by_place(const void *a, const void *b) {
    const dicom_slice *s = a, *t = b;
    if (s->along != t->along)
        return s->along < t->along ? -1 : 1;
    return by_number(a, b);
}

static void normal_of(const dicom_place *p, double n[3]) {
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        n[i] = p->across[j] * p->down[k] - p->across[k] * p->down[j];
    }
}

static bool same_plane(const dicom_place *a, const dicom_place *b) {
    return distance(a->across, b->across) <= 1e-3 && distance(a->down, b->down) <= 1e-3 &&
           fabs(a->between[0] - b->between[0]) <= 1e-3 * a->between[0] &&
           fabs(a->between[1] - b->between[1]) <= 1e-3 * a->between[1];
}

static status check_planes(const order *o) {
    for (size_t i = 1; i < o->count; i++) {
        const dicom_place *first = &o->slices[0].place, *p = &o->slices[i].place;
        if (p->known == first->known && (!p->known || same_plane(first, p)))
            continue;
        return status_describe(ST_UNSUPPORTED,
                               "%s: its plane or spacing is another than that of %s in the same "
                               "series",
                               path_of(o, i), path_of(o, 0));
    }
    return ST_OK;
}

static void sort_along(order *o) {
    double n[3];
    normal_of(&o->slices[0].place, n);
    for (size_t i = 0; i < o->count; i++)
        o->slices[i].along = dot(o->slices[i].place.position, n);
    qsort(o->slices, o->count, sizeof *o->slices, by_place);
}

/* ---- several slices at a position ---- */

/* Number of slices from i on that lie where i does. Different positions are at least a hundredth of
 * the mean distance apart. */
static size_t here(const order *o, size_t i) {
    const double range = o->slices[o->count - 1].along - o->slices[0].along;
    const double same = range / (double)o->count * loose;
    size_t n = 1;
    while (i + n < o->count && o->slices[i + n].along - o->slices[i].along <= same)
        n++;
    return n;
}

static status doubled(const order *o, size_t i) {
    const double *p = o->slices[i].place.position;
    return status_describe(ST_UNSUPPORTED,
                           "%s and %s lie at the same position, %.10g, %.10g, %.10g, and other "
                           "positions have another number of slices",
                           path_of(o, i), path_of(o, i + 1), p[0], p[1], p[2]);
}

static bool same_instance(const order *o, size_t i, size_t j) {
    return o->slices[i].frame == o->slices[j].frame &&
           strcmp(o->study->instances[o->slices[i].file], o->study->instances[o->slices[j].file]) ==
               0;
}

static status check_instances(const order *o, size_t i, size_t n) {
    for (size_t a = i; a < i + n; a++)
        for (size_t b = a + 1; b < i + n; b++)
            if (same_instance(o, a, b))
                return status_describe(ST_UNSUPPORTED, "%s and %s are the same instance",
                                       path_of(o, a), path_of(o, b));
    return ST_OK;
}

/* Of the slices at each position, keep only the slice of this step. */
static status keep_step(order *o, uint32_t step) {
    const size_t steps = here(o, 0);
    for (size_t i = 0; i < o->count; i += steps) {
        const size_t n = here(o, i);
        status st = n <= 64 ? check_instances(o, i, n) : ST_OK;
        if (st != ST_OK)
            return st;
        if (n != steps || i + n > o->count)
            return doubled(o, n > 1 ? i : 0);
    }
    if (step >= steps)
        return status_describe(ST_USAGE, "%s: --step %u: its series has %zu, counted from 0",
                               path_of(o, 0), step, steps);
    for (size_t i = 0; i * steps < o->count; i++)
        o->slices[i] = o->slices[i * steps + step];
    o->count /= steps;
    return ST_OK;
}

/* ---- distances ---- */

static double gap(const order *o, size_t i) {
    return distance(o->slices[i + 1].place.position, o->slices[i].place.position);
}

/* Returns the smallest distance of neighbouring slices: the distance where no slice is missing. */
static double least_gap(const order *o) {
    double least = gap(o, 0);
    for (size_t i = 1; i + 1 < o->count; i++)
        least = fmin(least, gap(o, i));
    return least;
}

/* The point at share `at` of the line from the first slice's position to the last one's. */
static void on_line(const order *o, double at, double out[3]) {
    const double *a = o->slices[0].place.position, *b = o->slices[o->count - 1].place.position;
    for (int i = 0; i < 3; i++)
        out[i] = a[i] + at * (b[i] - a[i]);
}

static bool is_even(const order *o) {
    const double all =
        distance(o->slices[0].place.position, o->slices[o->count - 1].place.position);
    const double mean = all / (double)(o->count - 1);
    for (size_t i = 0; i < o->count; i++) {
        double expected[3];
        on_line(o, (double)i / (double)(o->count - 1), expected);
        if (!(distance(o->slices[i].place.position, expected) <= loose * mean))
            return false;
    }
    return true;
}

/* Number of slices missing between i and the next, by the usual distance. 0: none, or the gap is no
 * multiple of that distance. */
static long missing_behind(const order *o, size_t i, double usual) {
    const double times = gap(o, i) / usual, whole = rint(times);
    return whole > 1 && whole < 1e6 && fabs(times - whole) <= 0.05 ? (long)whole - 1 : 0;
}

static status missing(const order *o, double usual) {
    char where[400] = "";
    long count = 0;
    for (size_t i = 0; i + 1 < o->count; i++) {
        const long n = missing_behind(o, i, usual);
        const double *a = o->slices[i].place.position, *b = o->slices[i + 1].place.position;
        for (long k = 1; k <= n; k++, count++) {
            const double t = (double)k / (double)(n + 1);
            if (count < 4)
                text_add(where, sizeof where, "%s%.6g, %.6g, %.6g", count ? "; " : "",
                         a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]),
                         a[2] + t * (b[2] - a[2]));
        }
    }
    return status_describe(ST_UNSUPPORTED,
                           "%s and %zu others: %ld slice%s missing, at %s%s (--allow-gaps goes on "
                           "without)",
                           path_of(o, 0), o->count - 1, count, count == 1 ? " is" : "s are", where,
                           count > 4 ? "; .." : "");
}

/* Returns whether all gaps are multiples of the usual distance, and some are larger than it. */
static bool has_gaps(const order *o, double usual) {
    bool any = false;
    for (size_t i = 0; i + 1 < o->count; i++) {
        const bool here_missing = missing_behind(o, i, usual) > 0;
        any = any || here_missing;
        if (!here_missing && fabs(gap(o, i) - usual) > 0.05 * usual)
            return false;
    }
    return any;
}

/* ---- placing ---- */

static void place_plane(const dicom_place *p, grid *g) {
    for (int row = 0; row < 3; row++) {
        g->to_world[row][0] = p->across[row] * p->between[0];
        g->to_world[row][1] = p->down[row] * p->between[1];
        g->to_world[row][3] = p->position[row];
    }
}

/* Set a z axis of distances along the line of the positions. Each position must lie on that
 * line. */
static status place_uneven(mem *m, const order *o, double usual, grid *g) {
    double *z = mem_array(m, o->count, sizeof *z), u[3];
    if (!z)
        return ST_NOMEM;
    status st = ST_OK;
    on_line(o, 1, u);
    const double *first = o->slices[0].place.position, all = distance(u, first);
    for (int i = 0; i < 3; i++)
        g->to_world[i][2] = u[i] = (u[i] - first[i]) / all;
    for (size_t i = 0; st == ST_OK && i < o->count; i++) {
        double expected[3];
        z[i] = dot(o->slices[i].place.position, u) - dot(first, u);
        on_line(o, z[i] / all, expected);
        if (!(distance(o->slices[i].place.position, expected) <= loose * usual))
            st = status_describe(ST_UNSUPPORTED, "%s: it is shifted sideways against its series",
                                 path_of(o, i));
    }
    if (st == ST_OK)
        st = grid_set_axis(g, m, path_of(o, 0), 2, z);
    mem_free(m, z);
    return st;
}

static status place_known(mem *m, const order *o, bool gaps, grid *g) {
    double next[3];
    place_plane(&o->slices[0].place, g);
    world_frame_set(&g->frame, WORLD_LPS, "mm");
    on_line(o, 1.0 / (double)(o->count - 1), next);
    for (int row = 0; row < 3; row++)
        g->to_world[row][2] = next[row] - o->slices[0].place.position[row];
    if (is_even(o))
        return ST_OK;
    const double usual = least_gap(o);
    return !gaps && has_gaps(o, usual) ? missing(o, usual) : place_uneven(m, o, usual, g);
}

/* Place slices of unknown positions, ordered by their numbers. */
static status place_unknown(const order *o, uint32_t step, grid *g) {
    if (step > 0)
        return status_describe(ST_USAGE, "%s: --step %u: its slices have no positions, so no steps",
                               path_of(o, 0), step);
    const dicom_place *p = &o->slices[0].place;
    for (size_t i = 0; i + 1 < o->count; i++)
        if (o->slices[i].place.number == o->slices[i + 1].place.number)
            return status_describe(ST_UNSUPPORTED,
                                   "%s and %s have neither positions nor different numbers",
                                   path_of(o, i), path_of(o, i + 1));
    world_frame_set(&g->frame, WORLD_UNTOLD, "mm");
    g->to_world[0][0] = p->between[0];
    g->to_world[1][1] = p->between[1];
    g->to_world[2][2] = p->apart > 0 ? p->apart : 1;
    return ST_OK;
}

status dicom_order(const dicom_study *s, dicom_slice *slices, size_t count, uint32_t step,
                   bool gaps, grid *g, size_t *kept) {
    order o = {s, slices, count};
    const bool known = slices[0].place.known;
    status st = check_planes(&o);
    if (st != ST_OK)
        return st;
    if (known) {
        sort_along(&o);
        st = keep_step(&o, step);
    } else {
        qsort(slices, count, sizeof *slices, by_number);
    }
    *kept = o.count;
    g->dims[2] = o.count < UINT32_MAX ? (uint32_t)o.count : UINT32_MAX;
    if (st != ST_OK || o.count < 2 || o.count > GRID_DIM_MAX)
        return st;
    return known ? place_known(s->m, &o, gaps, g) : place_unknown(&o, step, g);
}
