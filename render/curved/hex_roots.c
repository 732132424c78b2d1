#include "render/curved/hex_roots.h"

#include <stddef.h>

#include "formats/base/vec3.h"
#include "formats/curved/hex_open.h"
#include "formats/curved/hex_stretch.h"

enum { STRETCHES = 512 };

typedef struct search {
    hex_map q;
    const double *value; /* less the isovalue */
    hex_root *out;
    int count;
    hex_counts counts;
} search;

/* The ends' values are less the isovalue, too. */
static bool is_inside(const hex_end *e) {
    return e->value >= 0.0;
}

static void take(search *s, double t, const double at[3], bool entering) {
    if (s->count < HEX_ROOTS)
        s->out[s->count++] = (hex_root){t, {at[0], at[1], at[2]}, entering};
}

static void take_linear(search *s, const hex_end *from, const hex_end *to) {
    const double rise = to->value - from->value;
    const double share = rise != 0.0 ? real_min(real_max(0.0, -from->value / rise), 1.0) : 0.5;
    double at[3];
    for (int i = 0; i < 3; i++)
        at[i] = from->at[i] + share * (to->at[i] - from->at[i]);
    take(s, from->t + share * (to->t - from->t), at, is_inside(to));
}

/* The one change of side between two ends. Newton's method finds it at once; bisection always. */
static void take_between(search *s, const hex_end *from, const hex_end *to,
                         const hex_stretch *proven) {
    hex_end end[2] = {*from, *to};
    if (proven) {
        const double share = -from->value / (to->value - from->value);
        double at[3];
        for (int i = 0; i < 3; i++)
            at[i] = from->at[i] + share * (to->at[i] - from->at[i]);
        if (hex_stretch_solve(s->q, s->value, proven, at)) {
            const double t = hexahedron_at(s->q[2], at);
            take(s, real_min(real_max(from->t, t), to->t), at, is_inside(to));
            return;
        }
    }
    for (int n = 0; n < HEX_DEPTH; n++) {
        hex_end middle = {.t = 0.5 * (end[0].t + end[1].t)};
        if (!(middle.t > end[0].t && middle.t < end[1].t))
            break;
        for (int i = 0; i < 3; i++)
            middle.at[i] = 0.5 * (end[0].at[i] + end[1].at[i]);
        if (!hex_stretch_locate(s->q, middle.t, middle.at))
            break;
        middle.value = hexahedron_at(s->value, middle.at);
        end[is_inside(&middle) == is_inside(&end[1])] = middle;
    }
    take_linear(s, &end[0], &end[1]);
}

static bool look(void *ctx, const hex_end *from, const hex_end *to, int depth, hex_end *middle) {
    search *s = ctx;
    hex_stretch stretch;
    bool located = false, whole = false, even = false;
    s->counts.stretches++;
    if (hex_stretch_of(s->q, from, to, &stretch, &located)) {
        double error;
        const double slope = hex_stretch_slope(&stretch, s->value, &error);
        const double value = hexahedron_at(s->value, stretch.at);
        whole = fabs(slope) > error;
        even = fabs(value) > (fabs(slope) + error) * stretch.half;
    }
    if (!whole && !even && located && depth < HEX_DEPTH && s->counts.stretches < STRETCHES &&
        hex_stretch_middle(&stretch, s->value, from, to, middle))
        return true;
    s->counts.doubtful += !whole && !even;
    if (is_inside(from) != is_inside(to))
        take_between(s, from, to, whole ? &stretch : NULL);
    return false;
}

int hex_roots(const hexahedron *h, int sense, const hex_path *path, double isovalue,
              hex_root out[HEX_ROOTS], hex_counts *counts) {
    hex_opened opened;
    hex_open(h, path, &opened);
    for (int c = 0; c < HEX_CORNERS; c++)
        opened.value[c] -= isovalue;
    search s = {.q = opened.q, .value = opened.value, .out = out};
    for (int i = 0; i < path->count; i++) {
        hex_part part = path->part[i];
        for (int k = 0; k < 2; k++) {
            part.end[k].value -= isovalue; /* its sign is exact */
            hex_open_into(&opened, part.end[k].at);
        }
        if (sense != 0)
            hex_part_walk(&part, look, &s);
        else if (is_inside(&part.end[0]) != is_inside(&part.end[1]))
            take_linear(&s, &part.end[0], &part.end[1]);
    }
    for (int i = 0; i < s.count; i++)
        hex_open_out(&opened, out[i].at);
    if (counts) {
        counts->paths += (uint64_t)path->count;
        counts->stretches += s.counts.stretches;
        counts->doubtful += s.counts.doubtful;
    }
    return s.count;
}
