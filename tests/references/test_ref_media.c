/* test_ref_media.c - the reference of media and projections against what can be written down:
 * constant media, ramps, exponentials, steps, needles, two volumes at one place; against a second
 * rule, and against small steps that know of no cuts. */
/* marks: long */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/hostile_transfer.h"
#include "tests/support/ref_media.h"
#include "tests/support/tet_meshes.h"

typedef long double real;
typedef leafcast_transfer_point point;

enum { PIECES_MAX = 4096 };

static ref_piece line(real t0, real t1, real f0, real f1) {
    return (ref_piece){t0, t1, {f0, (f1 - f0) / (t1 - t0)}, 0};
}

static ref_colour colour_of(const ref_medium *of, int count) {
    const ref_media m = {.of = of, .count = count};
    return ref_media_colour(&m);
}

static ref_colour one_piece(ref_piece p, const point *points, int count) {
    const ref_medium of = {&p, 1, points, count};
    return colour_of(&of, 1);
}

static void assert_near(real is, real want, real off) {
    if (!(fabsl(is - want) <= off))
        fail_msg("%.21Lg, not %.21Lg: off by %.3Lg", is, want, is - want);
}

static void assert_alike(const ref_colour *a, const ref_colour *b, real off) {
    for (int c = 0; c < 3; c++)
        assert_near(a->rgb[c], b->rgb[c], off);
    assert_near(a->alpha, b->alpha, off);
    assert_near(a->transmittance, b->transmittance, off);
}

/* ---- What can be written down ---- */

/* One piece or many, with gaps between them or none; every extinction there is. */
static void test_constant(void **state) {
    (void)state;
    static const double extinctions[] = {0.0, DBL_TRUE_MIN, 1e-9, 0.7, 40.0, 1e30, DBL_MAX};
    for (size_t i = 0; i < sizeof extinctions / sizeof *extinctions; i++) {
        const point p = {3.0, {0.25F, 1.0F, 8.0F}, extinctions[i]};
        ref_piece pieces[16];
        for (int k = 0; k < 16; k++)
            pieces[k] = line(100 + k / 8.0L, 100 + (k + (k % 2 ? 1 : 0.5L)) / 8.0L, k - 5, 7 - k);
        const ref_medium of = {pieces, 16, &p, 1};
        ref_media m = {.of = &of, .count = 1, .background = {1.0F, 0.5F, 0.0F, 0.75F}};
        const real depth = 1.5L * extinctions[i], left = expl(-depth), gone = -expm1l(-depth);
        const ref_colour c = ref_media_colour(&m);
        assert_near(c.transmittance, left, 1e-17L);
        assert_near(c.alpha, gone + 0.75L * left, 1e-17L);
        for (int a = 0; a < 3; a++)
            assert_near(c.rgb[a], p.rgb[a] * gone + 0.75L * m.background[a] * left, 1e-16L);
        m.rule = REF_TANH_SINH;
        const ref_colour other = ref_media_colour(&m);
        assert_alike(&c, &other, 1e-15L);
    }
}

/* Extinction E t and colour t over t in [0, 1]. */
static void test_ramp(void **state) {
    (void)state;
    const real pi = acosl(-1);
    for (double e = 1e-6; e < 1e20; e *= 10) {
        const point points[] = {{0.0, {0.0F, 1.0F, 0.5F}, 0.0}, {1.0, {1.0F, 0.0F, 0.5F}, e}};
        const real left = expl(-e / 2.0L);
        const real red = sqrtl(pi / (2 * e)) * erfl(sqrtl(e / 2.0L)) - left,
                   gone = -expm1l(-e / 2.0L);
        const ref_colour c = one_piece(line(5, 6, 0, 1), points, 2);
        assert_near(c.rgb[0], red, 2e-17L);
        assert_near(c.rgb[1], gone - red, 2e-17L);
        assert_near(c.rgb[2], gone / 2, 2e-17L);
        assert_near(c.transmittance, left, 1e-17L);
        /* The other way round: extinction E (1 - t). */
        const ref_colour back = one_piece(line(5, 6, 1, 0), points, 2);
        assert_near(back.rgb[2], gone / 2, 2e-17L);
        assert_near(back.transmittance, left, 1e-17L);
    }
}

/* Extinction E, colour t over t in [0, 1]. */
static void test_exponential(void **state) {
    (void)state;
    for (double e = 0.01; e < 1e6; e *= 3) {
        const point points[] = {{-1.0, {0.0F, 1.0F, 0.0F}, e}, {1.0, {2.0F, 1.0F, 0.0F}, e}};
        const ref_colour c = one_piece(line(0, 1, -1, 1), points, 2);
        const real left = expl(-(real)e);
        assert_near(c.rgb[0], 2 * ((1 - left) / e - left), 1e-16L);
        assert_near(c.rgb[1], 1 - left, 1e-17L);
        assert_near(c.error, 0, 1e-12L);
    }
}

/* As narrow as numbers can be, as high as they can be: half of width times height over the slope.
 */
static void test_needles(void **state) {
    (void)state;
    static const double widths[] = {0.5, 1e-9, 1e-20, 1e-150, 1e-300};
    for (size_t i = 0; i < sizeof widths / sizeof *widths; i++) {
        const double w = widths[i];
        const point points[] = {{-w, {1.0F, 0.5F, 0.0F}, 0.0},
                                {0.0, {1.0F, 0.5F, 0.0F}, 3.0 / w},
                                {w, {1.0F, 0.5F, 0.0F}, 0.0}};
        const real gone = -expm1l(-1.5L);
        const ref_colour c = one_piece(line(8, 9, -1, 1), points, 3);
        const ref_colour back = one_piece(line(8, 9, 1, -1), points, 3);
        assert_near(c.rgb[0], gone, 1e-16L);
        assert_near(c.rgb[1], gone / 2, 1e-16L);
        assert_alike(&c, &back, 1e-16L);
    }
}

/* Of two points at one value the second holds at it, on a plateau too. */
static void test_steps(void **state) {
    (void)state;
    const point points[] = {{1.0, {1.0F, 0.0F, 0.0F}, 1.0},
                            {2.0, {1.0F, 0.0F, 0.0F}, 1.0},
                            {2.0, {0.0F, 1.0F, 0.0F}, 3.0},
                            {4.0, {0.0F, 1.0F, 0.0F}, 3.0}};
    const ref_colour rises = one_piece(line(0, 1, 1.5L, 2.5L), points, 4);
    assert_near(rises.rgb[0], -expm1l(-0.5L), 1e-17L);
    assert_near(rises.rgb[1], expl(-0.5L) * -expm1l(-1.5L), 1e-17L);
    const ref_colour falls = one_piece(line(0, 1, 2.5L, 1.5L), points, 4);
    assert_near(falls.rgb[1], -expm1l(-1.5L), 1e-17L);
    assert_near(falls.rgb[0], expl(-1.5L) * -expm1l(-0.5L), 1e-17L);
    assert_near(one_piece(line(0, 1, 2, 2), points, 4).rgb[1], -expm1l(-3), 1e-17L);
    assert_near(one_piece(line(0, 1, 2, 2), points, 4).rgb[0], 0, 0);
    /* Touched from below it is passed, from above it is not. */
    const ref_piece below = {0, 2, {1, 2, -1, 0}, 0}, above = {0, 2, {3, -2, 1, 0}, 0};
    assert_near(one_piece(below, points, 4).transmittance, expl(-2), 1e-17L);
    assert_near(one_piece(above, points, 4).transmittance, expl(-6), 1e-17L);
    /* Beyond the ends. */
    assert_near(one_piece(line(0, 1, -9, -5), points, 4).rgb[0], -expm1l(-1), 1e-17L);
    assert_near(one_piece(line(0, 1, 9, 5), points, 4).rgb[1], -expm1l(-3), 1e-17L);
}

/* One from 0 to 2, one from 1 to 3: where both are, extinctions add. */
static void test_overlap(void **state) {
    (void)state;
    const point red = {0.0, {1.0F, 0.0F, 0.0F}, 0.5}, green = {0.0, {0.0F, 2.0F, 0.0F}, 1.5};
    const ref_piece first = line(0, 2, 0, 1), second = line(1, 3, 1, 0);
    const ref_medium of[] = {{&first, 1, &red, 1}, {&second, 1, &green, 1}};
    const ref_colour c = colour_of(of, 2);
    const real both = expl(-0.5L) * -expm1l(-2);
    assert_near(c.rgb[0], -expm1l(-0.5L) + both * 0.25L, 1e-17L);
    assert_near(c.rgb[1], 2 * (both * 0.75L + expl(-2.5L) * -expm1l(-1.5L)), 1e-17L);
    assert_near(c.transmittance, expl(-4), 1e-17L);
    /* Surfaces in it and behind it; the order in which media are listed is no matter. */
    const ref_surface at[] = {{1.5L, {0.0F, 0.0F, 1.0F}, 0.25F}, {4, {0.0F, 0.0F, 3.0F}, 1.0F}};
    const ref_medium turned[] = {of[1], of[0]};
    const ref_media m = {turned, 2, at, 2, {1, 1, 1, 1}, REF_GAUSS_KRONROD};
    const ref_colour cut = ref_media_colour(&m);
    const real red_part =
        -expm1l(-0.5L) + expl(-0.5L) * 0.25L * (-expm1l(-1) + 0.75L * expl(-1) * -expm1l(-1));
    assert_near(cut.rgb[0], red_part, 1e-17L);
    assert_near(cut.rgb[2], 0.25L * expl(-1.5L) + 0.75L * expl(-4) * 3, 1e-17L);
    assert_near(cut.transmittance, 0, 0);
    assert_near(cut.alpha, 1, 0);
}

/* ---- Fields ---- */

static double diagonal(const ref_volume *v) {
    double sum = 0.0;
    for (int a = 0; a < 3; a++) {
        const double *x = v->axis[a];
        const double nodes = x ? x[v->dims[a] - 1] - x[0] : (double)(v->dims[a] - 1);
        sum += nodes * nodes * v->to_world[a][a] * v->to_world[a][a];
    }
    return sqrt(sum);
}

/* Rays of world length. */
static ref_ray unit_ray(ref_ray r) {
    const double length = sqrt(r.d[0] * r.d[0] + r.d[1] * r.d[1] + r.d[2] * r.d[2]);
    for (int a = 0; a < 3; a++)
        r.d[a] /= length;
    return r;
}

/* One density above an isovalue, none below: all that lies between the surfaces of the other
 * reference. */
static void test_solid(void **state) {
    (void)state;
    static const char *const names[] = {"sphere", "sphere-u8", "waves", "noise-f32", "rectilinear"};
    static ref_piece pieces[PIECES_MAX];
    field_random r = {FIELD_SEED};
    int solid = 0;
    for (int n = 0; n < 5; n++) {
        field f;
        assert_true(field_make(&f, names[n], 17, FIELD_SEED));
        const ref_volume v = field_volume(&f);
        const point points[] = {{f.iso, {0.0F, 0.0F, 0.0F}, 0.0}, {f.iso, {1.0F, 1.0F, 1.0F}, 0.2}};
        for (int i = 0; i < 100; i++) {
            const ref_ray ray = unit_ray(field_random_ray(&v, &r, 20));
            ref_hit hits[512];
            real length = 0;
            const size_t count = ref_trace(&v, &ray, &f.iso, 1, NULL, hits, 512);
            const ref_medium of = {pieces, ref_grid_pieces(&v, &ray, NULL, pieces, PIECES_MAX),
                                   points, 2};
            /* Where the ray begins or leaves inside there is no hit. */
            if (of.count > 0 && ref_piece_at(pieces[0].k, 0) >= f.iso)
                length -= pieces[0].t0;
            for (size_t h = 0; h < count; h++)
                length += (hits[h].from_inside ? 1 : -1) * hits[h].t_exact;
            const ref_piece *last = &pieces[of.count - 1];
            if (of.count > 0 && ref_piece_at(last->k, last->t1 - last->t0) >= f.iso)
                length += last->t1;
            const ref_colour c = colour_of(&of, 1);
            assert_near(c.transmittance, expl(-0.2L * length), 1e-15L);
            assert_near(c.rgb[1], -expm1l(-0.2L * length), 1e-15L);
            solid += length > 0;
        }
        field_release(&f);
    }
    assert_true(solid > 250);
}

/* Small steps that know of no cuts: the middle of each. */
static ref_colour by_steps(const ref_medium *of, int count, real t0, real t1, int steps) {
    const real h = (t1 - t0) / steps;
    size_t at[REF_MEDIA_MAX] = {0};
    ref_colour sum = {.transmittance = 1};
    for (int n = 0; n < steps; n++) {
        const real t = t0 + (n + 0.5L) * h;
        real emitted[3] = {0}, e = 0;
        for (int i = 0; i < count; i++) {
            real rgb[3], own;
            while (at[i] < of[i].count && of[i].pieces[at[i]].t1 <= t)
                at[i]++;
            const ref_piece *p = &of[i].pieces[at[i]];
            if (at[i] == of[i].count || p->t0 > t)
                continue;
            ref_transfer(of[i].points, of[i].point_count, ref_piece_at(p->k, t - p->t0), rgb, &own);
            e += own;
            for (int c = 0; c < 3; c++)
                emitted[c] += own * rgb[c];
        }
        const real gone = e > 0 ? -expm1l(-e * h) / e : 0;
        for (int c = 0; c < 3; c++)
            sum.rgb[c] += sum.transmittance * gone * emitted[c];
        sum.transmittance *= expl(-e * h);
    }
    sum.alpha = 1 - sum.transmittance;
    return sum;
}

static bool is_tame(const char *kind) {
    return strcmp(kind, "smooth") == 0 || strcmp(kind, "thin") == 0 || strcmp(kind, "steps") == 0 ||
           strcmp(kind, "positive") == 0 || strcmp(kind, "constant") == 0;
}

/* Two media on a ray: the field, and itself the other way round, a little away. */
static void check_ray(const field *f, const ref_volume *v, int kind, field_random *r) {
    static ref_piece pieces[2][PIECES_MAX];
    static point points[2][HOSTILE_POINTS_MAX];
    ref_medium of[2];
    ref_volume moved = *v;
    const ref_ray ray = unit_ray(field_random_ray(v, r, 5));
    const size_t samples = (size_t)(v->dims[0] * v->dims[1] * v->dims[2]);
    const transfer_range range = transfer_range_of(f->samples, samples, diagonal(v), r);
    for (int a = 0; a < 3; a++) {
        moved.to_world[a][a] = -0.9 * v->to_world[a][a];
        moved.to_world[a][3] += v->to_world[a][a] * (double)v->dims[a];
    }
    for (int i = 0; i < 2; i++) {
        const size_t n = ref_grid_pieces(i ? &moved : v, &ray, NULL, pieces[i], PIECES_MAX);
        of[i] = (ref_medium){pieces[i], n, points[i], hostile_transfer(kind, &range, r, points[i])};
    }
    ref_media m = {.of = of, .count = 2};
    const ref_colour c = ref_media_colour(&m);
    m.rule = REF_TANH_SINH;
    const ref_colour other = ref_media_colour(&m);
    assert_near(c.error, 0, 1e-12L);
    assert_alike(&c, &other, 2e-14L);
    for (int a = 0; a < 3; a++)
        assert_true(c.rgb[a] >= 0 && c.rgb[a] <= 1 - c.transmittance + 1e-15L);
    if (is_tame(hostile_transfer_name(kind)) && field_random_below(r, 30) == 0) {
        const ref_colour plain = by_steps(of, 2, 0, 3 * (real)diagonal(v), 100000);
        assert_alike(&c, &plain, 2e-3L);
    }
}

static void test_two_rules(void **state) {
    (void)state;
    for (int i = 0; i < field_count(); i++) {
        field f;
        field_random r = {(uint64_t)i};
        assert_true(field_make(&f, field_name(i), 9, FIELD_SEED));
        const ref_volume v = field_volume(&f);
        for (int kind = 0; kind < hostile_transfer_kinds(); kind++)
            for (int n = 0; n < 3; n++)
                check_ray(&f, &v, kind, &r);
        field_release(&f);
    }
}

static double tilted(const double p[3]) {
    return 0.5 * p[0] - 0.25 * p[1] + 2.0 * p[2] + 1.0;
}

/* A linear field is the same in cells and in tets. */
static void test_tets_and_cells(void **state) {
    (void)state;
    static ref_piece cells[PIECES_MAX], tets[PIECES_MAX];
    static point points[HOSTILE_POINTS_MAX];
    const int n[3] = {5, 4, 6};
    const long dims[3] = {6, 5, 7};
    const double origin[3] = {-1.0, 2.0, 0.5}, spacing[3] = {0.5, 0.5, 0.5};
    lab_mesh lab;
    float samples[6 * 5 * 7];
    field_random r = {FIELD_SEED};
    int met = 0;
    lab_mesh_kuhn(&lab, n, origin, 0.5, tilted);
    const tet_ref_mesh mesh = lab_mesh_reference(&lab);
    const ref_volume v = ref_volume_regular(dims, samples, spacing, origin);
    for (int i = 0; i < 6 * 5 * 7; i++)
        samples[i] = (float)tilted((double[3]){
            origin[0] + 0.5 * (i % 6), origin[1] + 0.5 * (i / 6 % 5), origin[2] + 0.5 * (i / 30)});
    for (int i = 0; i < 300; i++) {
        const ref_ray ray = unit_ray(field_random_ray(&v, &r, 4));
        const double box[2][3] = {{-0.7, 2.1, 0.6}, {1.1, 3.3, 3.2}};
        const ref_clip clip = {0.3, 9.0, NULL, 0, box}, *kept = i % 2 ? &clip : NULL;
        const transfer_range range = {-1.0, 8.0, 4.0, {0.0, 1.0, 2.0, 3.0}};
        const int count = hostile_transfer(i % hostile_transfer_kinds(), &range, &r, points);
        const ref_medium in_cells = {cells, ref_grid_pieces(&v, &ray, kept, cells, PIECES_MAX),
                                     points, count};
        const ref_medium in_tets = {tets, ref_mesh_pieces(&mesh, &ray, kept, tets, PIECES_MAX),
                                    points, count};
        const ref_colour a = colour_of(&in_cells, 1), b = colour_of(&in_tets, 1);
        if (strcmp(hostile_transfer_name(i % hostile_transfer_kinds()), "splinters") != 0)
            assert_alike(&a, &b, 1e-9L);
        const ref_extent e = ref_project(cells, in_cells.count),
                         g = ref_project(tets, in_tets.count);
        if (in_cells.count == 0)
            continue;
        real f;
        met++;
        assert_near(e.most, g.most, 1e-17L);
        assert_near(e.least, g.least, 1e-17L);
        assert_near(e.mean, g.mean, 1e-17L);
        assert_near(e.length, g.length, 1e-17L);
        assert_near(ref_first_at_least(cells, in_cells.count, e.mean, &f),
                    ref_first_at_least(tets, in_tets.count, e.mean, &f), 1e-16L);
    }
    assert_true(met > 150);
    lab_mesh_release(&lab);
}

/* Beside a sample that is none there is nothing. */
static void test_missing(void **state) {
    (void)state;
    const long dims[3] = {6, 2, 2};
    float samples[24];
    ref_piece pieces[8];
    const point p = {0.0, {1.0F, 1.0F, 1.0F}, 1.0};
    const ref_ray ray = {{-1.0, 0.25, 0.5}, {1.0, 0.0, 0.0}};
    for (int i = 0; i < 24; i++)
        samples[i] = i == 2 ? NAN : i == 23 ? INFINITY : 1.0F;
    const ref_volume v = ref_volume_regular(dims, samples, NULL, NULL);
    const ref_medium of = {pieces, ref_grid_pieces(&v, &ray, NULL, pieces, 8), &p, 1};
    assert_int_equal(of.count, 2);
    assert_true(pieces[0].t0 == 1 && pieces[0].t1 == 2 && pieces[1].t0 == 4 && pieces[1].t1 == 5);
    assert_near(colour_of(&of, 1).transmittance, expl(-2), 1e-17L);
    assert_near(ref_project(pieces, 2).length, 2, 0);
    assert_true(isnan(ref_project(pieces, 0).most) && isnan(ref_project(pieces, 0).mean));
}

/* Against many points on the way. */
static void test_projections(void **state) {
    (void)state;
    static ref_piece pieces[PIECES_MAX];
    field_random r = {FIELD_SEED};
    field f;
    assert_true(field_make(&f, "noise-f32", 9, FIELD_SEED));
    const ref_volume v = field_volume(&f);
    for (int i = 0; i < 200; i++) {
        const ref_ray ray = unit_ray(field_random_ray(&v, &r, 5));
        const size_t count = ref_grid_pieces(&v, &ray, NULL, pieces, PIECES_MAX);
        const ref_extent e = ref_project(pieces, count);
        const real wanted = e.least + (e.most - e.least) * field_random_unit(&r);
        real sum = 0, least = INFINITY, most = -INFINITY, first = NAN, value;
        for (size_t n = 0; n < count; n++)
            for (int k = 0; k < 1000; k++) {
                const real h = (pieces[n].t1 - pieces[n].t0) / 1000, x = (k + 0.5L) * h;
                const real g = ref_piece_at(pieces[n].k, x);
                sum += g * h;
                least = fminl(least, g);
                most = fmaxl(most, g);
                first = isnan(first) && g >= wanted ? pieces[n].t0 + x : first;
            }
        const real found = ref_first_at_least(pieces, count, wanted, &value);
        assert_near(e.mean, sum / e.length, 1e-5L);
        assert_true(e.least <= least && e.most >= most);
        assert_near(e.least, least, 3e-3L);
        assert_near(e.most, most, 3e-3L);
        assert_true(isnan(first) || found <= first);
        assert_near(value, fmaxl(wanted, ref_piece_at(pieces[0].k, 0)), 1e-16L);
        assert_true(isnan(ref_first_at_least(pieces, count, e.most + 1e-9L, &value)));
        if (found > pieces[0].t0) {
            const real before = ref_first_at_least(pieces, count, wanted - 1e-6L, &value);
            assert_true(before < found);
        }
    }
    field_release(&f);
}

/* Where the numbers are known: 1 - (x - 1)^2 over [0, 3]. */
static void test_parabola(void **state) {
    (void)state;
    const ref_piece p = {10, 13, {0, 2, -1, 0}, 0};
    const ref_extent e = ref_project(&p, 1);
    real f;
    assert_true(e.most == 1 && e.most_t == 11 && e.least == -3 && e.least_t == 13);
    assert_near(e.mean, 0, 1e-18L);
    assert_near(ref_first_at_least(&p, 1, 0.75L, &f), 10.5L, 1e-18L);
    assert_near(f, 0.75L, 1e-18L);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_constant),       cmocka_unit_test(test_ramp),
        cmocka_unit_test(test_exponential),    cmocka_unit_test(test_needles),
        cmocka_unit_test(test_steps),          cmocka_unit_test(test_overlap),
        cmocka_unit_test(test_solid),          cmocka_unit_test(test_two_rules),
        cmocka_unit_test(test_tets_and_cells), cmocka_unit_test(test_missing),
        cmocka_unit_test(test_projections),    cmocka_unit_test(test_parabola),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
