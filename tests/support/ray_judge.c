#include "tests/support/ray_judge.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <float.h>
#include <math.h>
#include <stdio.h>

enum { HITS_MAX = 256 };

static void unit(double v[3]) {
    const double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int a = 0; a < 3; a++)
        v[a] /= length;
}

/* How many of the surfaces from i on lie together, nearer than the band's width. Their order and
 * their number are not compared: at equal t surfaces come by cell index, not by the way of the ray,
 * and a pair at one t in one cell is one (t, cell, isovalue). */
static size_t together(const ref_hit *hits, size_t count, size_t i) {
    size_t n = 1;
    while (i + n < count &&
           (hits[i + n].t - hits[i + n - 1].t) * hits[i].cells_per_t <= REF_GRAZING_CHANGE)
        n++;
    return n;
}

static bool agrees(const ref_hit *want, size_t want_count, const leafcast_hit *got,
                   size_t got_count, double *worst) {
    size_t i = 0, k = 0;
    while (i < want_count && k < got_count) {
        const double scale = want[i].cells_per_t;
        const double off = fabs((double)(got[k].t - want[i].t_exact)) * scale;
        const double near = REF_GRAZING_CHANGE + 4 * fabs(want[i].t) * DBL_EPSILON * scale;
        const size_t n = together(want, want_count, i);
        if (!(off <= near) ||
            (n == 1 && (got[k].surface != want[i].iso || got[k].entering == want[i].from_inside)))
            return false;
        *worst = fmax(*worst, off);
        i += n;
        for (k++; n > 1 && k < got_count && (got[k].t - want[i - 1].t) * scale <= near;)
            k++;
    }
    return i == want_count && k == got_count;
}

void ray_judge(ray_tally *sum, leafcast *volume, const char *name, const ref_volume *v, ref_ray ray,
               const double *isos, int iso_count) {
    static ref_hit want[HITS_MAX];
    static leafcast_hit got[HITS_MAX];
    const leafcast_scene scene = leafcast_scene_default();
    int count = 0;
    unit(ray.d);
    const size_t hits = ref_trace(v, &ray, isos, iso_count, NULL, want, HITS_MAX);
    assert_true(hits <= HITS_MAX);
    if (leafcast_probe_ray(volume, &scene, ray.o, ray.d, got, HITS_MAX, &count) != LEAFCAST_OK)
        fail_msg("%s: %s", name, leafcast_error_text());
    sum->rays++;
    sum->hits += (int)hits;
    if (agrees(want, hits, got, (size_t)count, &sum->worst))
        return;
    if (ref_grazing(v, &ray, isos, iso_count, NULL, 64)) {
        sum->grazing++;
        return;
    }
    sum->faults++;
    if (sum->faults < 4)
        fprintf(stderr,
                "# %s: o = %.17g,%.17g,%.17g d = %.17g,%.17g,%.17g: %d surfaces, the reference "
                "sees %zu (first t %.17g, %.17g)\n",
                name, ray.o[0], ray.o[1], ray.o[2], ray.d[0], ray.d[1], ray.d[2], count, hits,
                count ? got[0].t : INFINITY, hits ? want[0].t : INFINITY);
}
