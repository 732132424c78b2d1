/* test_trace.c - rays through whole volumes against the reference: every surface along the ray, in
 * order, in its cell, on its side; from outside, from inside, through vertices, edges and planes.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "tests/support/fixture.h"
#include "tests/support/ref_judge.h"

enum { HITS_MAX = 256, RAYS = 300 };

typedef struct tally {
    int rays, hits, grazing, faults;
    double worst;
} tally;

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

/* One ray: the whole list of surfaces must agree, outside the grazing band. */
static void judge(leafcast *volume, const field *f, const ref_volume *v, ref_ray ray,
                  const double *isos, int iso_count, tally *sum) {
    static ref_hit want[HITS_MAX];
    static leafcast_hit got[HITS_MAX];
    const leafcast_scene scene = leafcast_scene_default();
    int count = 0;
    unit(ray.d);
    const size_t hits = ref_trace(v, &ray, isos, iso_count, NULL, want, HITS_MAX);
    assert_true(hits <= HITS_MAX);
    assert_int_equal(leafcast_probe_ray(volume, &scene, ray.o, ray.d, got, HITS_MAX, &count),
                     LEAFCAST_OK);
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
                f->name, ray.o[0], ray.o[1], ray.o[2], ray.d[0], ray.d[1], ray.d[2], count, hits,
                count ? got[0].t : INFINITY, hits ? want[0].t : INFINITY);
}

static void check_field(const char *name, long n, uint32_t cells_log2, int iso_count) {
    field f;
    field_random random = {FIELD_SEED};
    tally sum = {0};
    assert_true(field_make(&f, name, n, FIELD_SEED));
    const ref_volume v = field_volume(&f);
    leafcast *volume = fixture_open(fixture_leaf(&f, cells_log2, 1, false), NULL);
    const double isos[3] = {f.iso, f.iso * 1.1, f.iso * 0.9};
    leafcast_surface surfaces[3];
    for (int i = 0; i < iso_count; i++)
        surfaces[i] = leafcast_surface_default(isos[i]);
    assert_int_equal(leafcast_select(volume, surfaces, iso_count), LEAFCAST_OK);
    for (int i = 0; i < RAYS; i++) {
        judge(volume, &f, &v, field_random_ray(&v, &random, 20), isos, iso_count, &sum);
        judge(volume, &f, &v, field_random_ray(&v, &random, -1), isos, iso_count, &sum);
        judge(volume, &f, &v, field_exact_ray(&v, &random), isos, iso_count, &sum);
    }
    print_message("# %s: %d rays, %d surfaces, worst %.2g cells, %d grazing, %d faults\n", name,
                  sum.rays, sum.hits, sum.worst, sum.grazing, sum.faults);
    assert_int_equal(sum.faults, 0);
    leafcast_close(volume);
    field_release(&f);
}

static void test_every_field(void **state) {
    (void)state;
    for (int i = 0; i < field_count(); i++)
        check_field(field_name(i), 23, 4, 1);
}

static void test_several_isovalues(void **state) {
    (void)state;
    for (int i = 0; i < field_count(); i++)
        check_field(field_name(i), 19, 4, 3);
}

static void test_treelet_sizes(void **state) {
    (void)state;
    const long sizes[] = {2, 16, 17, 33, 34};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
        for (uint32_t cells_log2 = 4; cells_log2 <= 6; cells_log2++)
            check_field("noise-u8", sizes[i], cells_log2, 1);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_field),
        cmocka_unit_test(test_several_isovalues),
        cmocka_unit_test(test_treelet_sizes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
