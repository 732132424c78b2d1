#include "render/curved/hex_roots.h"

#include <stddef.h>

#include "render/curved/hex_stretch.h"

enum { DEPTH = 52, STRETCHES = 512 };

typedef struct side_end {
    double t, at[3], value;
    bool inside;
} side_end;

typedef struct search {
    hex_map q;
    const double *value; /* less the isovalue */
    hex_root *out;
    int count;
    hex_counts counts;
} search;

static void take(search *s, double t, const double at[3], bool entering) {
    if (s->count < HEX_ROOTS)
        s->out[s->count++] = (hex_root){t, {at[0], at[1], at[2]}, entering};
}

static void take_linear(search *s, const side_end *from, const side_end *to) {
    const double rise = to->value - from->value;
    const double share = rise != 0.0 ? fmin(fmax(-from->value / rise, 0.0), 1.0) : 0.5;
    double at[3];
    for (int i = 0; i < 3; i++)
        at[i] = from->at[i] + share * (to->at[i] - from->at[i]);
    take(s, from->t + share * (to->t - from->t), at, to->inside);
}

/* The one change of side between two ends. Newton's method finds it at once; bisection always. */
static void take_between(search *s, const side_end *from, const side_end *to,
                         const hex_stretch *proven) {
    side_end end[2] = {*from, *to};
    if (proven) {
        const double share = -from->value / (to->value - from->value);
        double at[3];
        for (int i = 0; i < 3; i++)
            at[i] = from->at[i] + share * (to->at[i] - from->at[i]);
        if (hex_stretch_solve(s->q, s->value, proven, at)) {
            const double t = hexahedron_at(s->q[2], at);
            take(s, fmin(fmax(t, from->t), to->t), at, to->inside);
            return;
        }
    }
    for (int n = 0; n < DEPTH; n++) {
        side_end middle = {.t = 0.5 * (end[0].t + end[1].t)};
        if (!(middle.t > end[0].t && middle.t < end[1].t))
            break;
        for (int i = 0; i < 3; i++)
            middle.at[i] = 0.5 * (end[0].at[i] + end[1].at[i]);
        if (!hex_stretch_locate(s->q, middle.t, middle.at))
            break;
        middle.value = hexahedron_at(s->value, middle.at);
        middle.inside = middle.value >= 0.0;
        end[middle.inside == end[1].inside] = middle;
    }
    take_linear(s, &end[0], &end[1]);
}

/* Looks at one stretch. Returns true, and its middle, if it must be cut in two. */
static bool look(search *s, const side_end *from, const side_end *to, int depth, side_end *middle) {
    hex_stretch stretch;
    bool located = false, whole = false, even = false;
    s->counts.stretches++;
    if (hex_stretch_of(s->q, (double[2]){from->t, to->t}, (const double *[2]){from->at, to->at},
                       &stretch, &located)) {
        double error;
        const double slope = hex_stretch_slope(&stretch, s->value, &error);
        const double value = hexahedron_at(s->value, stretch.at);
        whole = fabs(slope) > error;
        even = fabs(value) > (fabs(slope) + error) * stretch.half;
    }
    if (!whole && !even && located && depth < DEPTH && s->counts.stretches < STRETCHES) {
        *middle = (side_end){.t = 0.5 * (from->t + to->t)};
        if (middle->t > from->t && middle->t < to->t) {
            for (int i = 0; i < 3; i++)
                middle->at[i] = stretch.at[i];
            middle->value = hexahedron_at(s->value, middle->at);
            middle->inside = middle->value >= 0.0;
            return true;
        }
    }
    s->counts.doubtful += !whole && !even;
    if (from->inside != to->inside)
        take_between(s, from, to, whole ? &stretch : NULL);
    return false;
}

/* From the first end to the last: the stretches still to be looked at, the next one on top. */
static void search_part(search *s, const side_end *from, const side_end *to) {
    struct {
        side_end end;
        int depth;
    } ahead[DEPTH + 2];
    side_end here = *from;
    int count = 1;
    ahead[0].end = *to;
    ahead[0].depth = 0;
    while (count > 0) {
        side_end middle;
        const int depth = ahead[count - 1].depth;
        if (look(s, &here, &ahead[count - 1].end, depth, &middle)) {
            ahead[count - 1].depth = depth + 1;
            ahead[count].end = middle;
            ahead[count++].depth = depth + 1;
        } else {
            here = ahead[--count].end;
        }
    }
}

int hex_roots(const hexahedron *h, int sense, const hex_path *path, double isovalue,
              hex_root out[HEX_ROOTS], hex_counts *counts) {
    double value[HEX_CORNERS];
    for (int c = 0; c < HEX_CORNERS; c++)
        value[c] = h->value[c] - isovalue;
    search s = {.q = path->q, .value = value, .out = out};
    for (int i = 0; i < path->count; i++) {
        side_end end[2];
        for (int k = 0; k < 2; k++) {
            const hex_end *e = &path->part[i].end[k];
            end[k] = (side_end){
                e->t, {e->at[0], e->at[1], e->at[2]}, e->value - isovalue, e->value >= isovalue};
        }
        if (sense == 0) {
            if (end[0].inside != end[1].inside)
                take_linear(&s, &end[0], &end[1]);
        } else {
            search_part(&s, &end[0], &end[1]);
        }
    }
    if (counts) {
        counts->paths += (uint64_t)path->count;
        counts->stretches += s.counts.stretches;
        counts->doubtful += s.counts.doubtful;
    }
    return s.count;
}
