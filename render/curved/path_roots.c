#include "render/curved/path_roots.h"

#include <stddef.h>

#include "formats/base/vec3.h"
#include "formats/curved/path_stretch.h"

enum { STRETCHES = 512 };

typedef struct search {
    const curved_map *map;
    double value[FORM_MOST]; /* less the isovalue */
    path_root *out;
    int count;
    path_counts counts;
} search;

/* The ends' values are less the isovalue, too. */
static bool is_inside(const path_end *e) {
    return e->value >= 0.0;
}

static void take(search *s, double t, const double at[3], bool entering) {
    if (s->count < PATH_ROOTS)
        s->out[s->count++] = (path_root){t, {at[0], at[1], at[2]}, entering};
}

static void take_linear(search *s, const path_end *from, const path_end *to) {
    const double rise = to->value - from->value;
    const double share = rise != 0.0 ? real_min(real_max(0.0, -from->value / rise), 1.0) : 0.5;
    double at[3];
    for (int i = 0; i < 3; i++)
        at[i] = from->at[i] + share * (to->at[i] - from->at[i]);
    take(s, from->t + share * (to->t - from->t), at, is_inside(to));
}

/* The one change of side between two ends. Newton's method finds it at once; bisection always. */
static void take_between(search *s, const path_end *from, const path_end *to,
                         const path_stretch *proven) {
    path_end end[2] = {*from, *to};
    if (proven) {
        const double share = -from->value / (to->value - from->value);
        double at[3];
        for (int i = 0; i < 3; i++)
            at[i] = from->at[i] + share * (to->at[i] - from->at[i]);
        if (path_stretch_solve(s->map, s->value, proven, at)) {
            const double t = s->map->form->at(s->map->q[2], at);
            take(s, real_min(real_max(from->t, t), to->t), at, is_inside(to));
            return;
        }
    }
    for (int n = 0; n < PATH_DEPTH; n++) {
        path_end middle = {.t = 0.5 * (end[0].t + end[1].t)};
        if (!(middle.t > end[0].t && middle.t < end[1].t))
            break;
        for (int i = 0; i < 3; i++)
            middle.at[i] = 0.5 * (end[0].at[i] + end[1].at[i]);
        if (!path_stretch_locate(s->map, middle.t, middle.at))
            break;
        middle.value = s->map->form->at(s->value, middle.at);
        end[is_inside(&middle) == is_inside(&end[1])] = middle;
    }
    take_linear(s, &end[0], &end[1]);
}

static bool look(void *ctx, const path_end *from, const path_end *to, int depth, path_end *middle) {
    search *s = ctx;
    path_stretch stretch;
    bool located = false, whole = false, even = false;
    s->counts.stretches++;
    if (path_stretch_of(s->map, from, to, &stretch, &located)) {
        double error;
        const double slope = path_stretch_slope(&stretch, s->value, &error);
        const double value = s->map->form->at(s->value, stretch.at);
        whole = fabs(slope) > error;
        even = fabs(value) > (fabs(slope) + error) * stretch.half;
    }
    if (!whole && !even && located && depth < PATH_DEPTH && s->counts.stretches < STRETCHES &&
        path_stretch_middle(&stretch, s->value, from, to, middle))
        return true;
    s->counts.doubtful += !whole && !even;
    if (is_inside(from) != is_inside(to))
        take_between(s, from, to, whole ? &stretch : NULL);
    return false;
}

int path_roots(const curved_map *m, const path_part *parts, int part_count, bool folded,
               double isovalue, path_root out[PATH_ROOTS], path_counts *counts) {
    search s = {.map = m, .out = out};
    for (int c = 0; c < m->form->count; c++)
        s.value[c] = m->value[c] - isovalue;
    for (int i = 0; i < part_count; i++) {
        path_part part = parts[i];
        for (int k = 0; k < 2; k++)
            part.end[k].value -= isovalue; /* its sign is exact */
        if (!folded)
            path_part_walk(&part, look, &s);
        else if (is_inside(&part.end[0]) != is_inside(&part.end[1]))
            take_linear(&s, &part.end[0], &part.end[1]);
    }
    if (counts) {
        counts->paths += (uint64_t)part_count;
        counts->stretches += s.counts.stretches;
        counts->doubtful += s.counts.doubtful;
    }
    return s.count;
}
