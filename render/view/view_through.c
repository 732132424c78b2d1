#include "render/view/view_through.h"

#include <math.h>

enum { PIECES_MAX = 1 << 15, HALVINGS = 60 };

/* The value of a piece, a polynomial in Bernstein form, at a share of its length. */
static double value_at(const leafcast_segment *s, double share) {
    double b[4];
    for (int i = 0; i <= s->degree; i++)
        b[i] = s->control[i];
    for (int n = s->degree; n > 0; n--)
        for (int i = 0; i < n; i++)
            b[i] = (1.0 - share) * b[i] + share * b[i + 1];
    return b[0];
}

/* Its integral over its length is the mean of its control values times that. */
static double mean_of(const leafcast_segment *s) {
    double sum = 0.0;
    for (int i = 0; i <= s->degree; i++)
        sum += s->control[i];
    return sum / (s->degree + 1);
}

static void find_extreme(const leafcast_segment *s, int count, double sign, view_through *out) {
    for (int i = 0; i < count; i++) {
        const double value = sign > 0.0 ? s[i].most : s[i].least;
        if (!out->any || sign * value > sign * out->value)
            *out = (view_through){true, value, sign > 0.0 ? s[i].most_t : s[i].least_t};
    }
}

static void find_mean(const leafcast_segment *s, int count, view_through *out) {
    double sum = 0.0, length = 0.0;
    for (int i = 0; i < count; i++) {
        sum += mean_of(&s[i]) * (s[i].t1 - s[i].t0);
        length += s[i].t1 - s[i].t0;
    }
    if (length > 0.0)
        *out = (view_through){true, sum / length, 0.5 * s[0].t0 + 0.5 * s[count - 1].t1};
}

static void find_first(const leafcast_segment *s, int count, double value, view_through *out) {
    int k = 0;
    while (k < count && !(s[k].most >= value))
        k++;
    if (k == count)
        return;
    double below = 0.0, above = (s[k].most_t - s[k].t0) / (s[k].t1 - s[k].t0);
    *out = (view_through){true, s[k].control[0], s[k].t0};
    if (s[k].control[0] >= value)
        return;
    for (int i = 0; i < HALVINGS; i++) {
        const double half = 0.5 * (below + above);
        if (value_at(&s[k], half) >= value)
            above = half;
        else
            below = half;
    }
    *out = (view_through){true, value, s[k].t0 + above * (s[k].t1 - s[k].t0)};
}

/* The piece that adds most to the pixel: by its opacity, dimmed by what lies before it. unit: a
 * length of the direction, in world units. */
static void find_medium(const leafcast_segment *s, int count, const transfer_list *medium,
                        double unit, view_through *out) {
    double through = 1.0, most = 0.0;
    for (int i = 0; i < count; i++) {
        const double value = value_at(&s[i], 0.5);
        const double extinction = transfer_list_at(medium, value, false).extinction;
        const double left = exp(-extinction * unit * (s[i].t1 - s[i].t0));
        if (through * (1.0 - left) > most) {
            most = through * (1.0 - left);
            *out = (view_through){true, value, 0.5 * s[i].t0 + 0.5 * s[i].t1};
        }
        through *= left;
    }
}

status view_through_find(mem *m, leafcast *volume, const leafcast_scene *scene,
                         const transfer_list *medium, const double origin[3],
                         const double direction[3], view_through *out) {
    const double unit = sqrt(direction[0] * direction[0] + direction[1] * direction[1] +
                             direction[2] * direction[2]);
    int count = 0;
    *out = (view_through){false, (double)NAN, 0.0};
    leafcast_segment *s = mem_array(m, PIECES_MAX, sizeof *s);
    if (!s)
        return ST_NOMEM;
    leafcast_scene of = *scene;
    of.project = LEAFCAST_PROJECT_MAX; /* takes a scene without surfaces */
    const status st =
        (status)leafcast_probe_segments(volume, &of, origin, direction, s, PIECES_MAX, &count);
    if (st == ST_OK && count > 0)
        switch (scene->project) {
        case LEAFCAST_PROJECT_MAX: find_extreme(s, count, 1.0, out); break;
        case LEAFCAST_PROJECT_MIN: find_extreme(s, count, -1.0, out); break;
        case LEAFCAST_PROJECT_MEAN: find_mean(s, count, out); break;
        case LEAFCAST_PROJECT_FIRST: find_first(s, count, scene->project_value, out); break;
        case LEAFCAST_PROJECT_NONE:
            if (medium->count > 0)
                find_medium(s, count, medium, unit, out);
            break;
        }
    mem_free(m, s);
    return st;
}
