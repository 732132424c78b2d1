#include "tests/support/hex_judge.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>

#include "tests/support/hex_truth.h"
#include "tests/support/quadratic_truth.h"

static double distance(const double p[3], const double q[3]) {
    return hypot(hypot(p[0] - q[0], p[1] - q[1]), p[2] - q[2]);
}

static double mean_edge(const curved_cell *c) {
    double sum = 0.0;
    for (int e = 0; e < QUADRATIC_EDGES && c->quadratic; e++) {
        const int *edge = quadratic_edge(e);
        sum += distance(c->tet.p[edge[0]], c->tet.p[edge[1]]) / QUADRATIC_EDGES;
    }
    for (int n = 0; n < HEX_CORNERS && !c->quadratic; n++)
        for (int a = 0; a < 3; a++)
            sum += distance(c->hexahedron.p[n], c->hexahedron.p[n ^ 1 << a]) / (3 * HEX_CORNERS);
    return sum;
}

static void take(hex_judged *x, const curved_cell *cell) {
    const int nodes = curved_cell_nodes(cell);
    *x = (hex_judged){.cell = *cell, .edge = mean_edge(cell)};
    for (int a = 0; a < 3; a++)
        for (int n = 0; n < nodes; n++)
            x->middle[a] += curved_cell_place(cell, n)[a] / nodes;
    for (int n = 0; n < nodes; n++) {
        const double away = distance(curved_cell_place(cell, n), x->middle);
        x->square = fmax(x->square, away * away);
    }
    /* Bent edges reach no further than thrice as far as the nodes. */
    x->square *= cell->quadratic ? 9.0 : 1.001;
}

static void allocate(hex_judge *j, size_t count) {
    *j = (hex_judge){malloc(count * sizeof *j->of), count};
    assert_non_null(j->of);
}

void hex_judge_mix(hex_judge *j, const cell_mix *m) {
    allocate(j, (size_t)m->count);
    for (int i = 0; i < m->count; i++) {
        const curved_cell c = {.hexahedron = cell_mix_hexahedron(&m->cell[i], 0)};
        take(&j->of[i], &c);
    }
}

void hex_judge_open(hex_judge *j, leafcast *v) {
    const uint64_t cells = leafcast_describe(v).cells;
    allocate(j, cells);
    j->count = 0;
    for (uint64_t i = 0; i < cells; i++) {
        leafcast_cell told = {.size = sizeof told};
        assert_int_equal(leafcast_get_cell(v, 0, i, &told), LEAFCAST_OK);
        if (!told.corners) /* hidden */
            continue;
        curved_cell c = {.quadratic = told.corners == QUADRATIC_NODES};
        assert_int_equal(told.corners, curved_cell_nodes(&c));
        bool finite = true;
        for (int n = 0; n < told.corners; n++) {
            curved_cell_put(&c, n, told.position[n], (double)told.value[n]);
            finite = finite && isfinite(told.value[n]);
        }
        if (!finite)
            continue;
        take(&j->of[j->count], &c);
        j->of[j->count++].folded = curved_cell_sense(&c) == 0;
    }
}

void hex_judge_release(hex_judge *j) {
    free(j->of);
    *j = (hex_judge){NULL, 0};
}

static bool is_near(const hex_judged *x, const double o[3], const double d[3]) {
    double along = 0.0, away = 0.0;
    for (int a = 0; a < 3; a++)
        along += (x->middle[a] - o[a]) * d[a];
    for (int a = 0; a < 3; a++) {
        const double w = o[a] + along * d[a] - x->middle[a];
        away += w * w;
    }
    return away <= x->square;
}

static int by_t(const void *a, const void *b) {
    const long double x = ((const hex_judge_root *)a)->t, y = ((const hex_judge_root *)b)->t;
    return (x > y) - (x < y);
}

/* The roots of a cell by brute force, put behind those that are there. Returns how many there are
 * then; -1: in doubt. */
static int add_roots(const hex_judged *x, double iso, const double o[3], const double d[3],
                     hex_judge_root *roots, int count) {
    const long double *t;
    hex_truth hex;
    quadratic_truth tet;
    int more;
    if (x->cell.quadratic) {
        quadratic_truth_of(&x->cell.tet, quadratic_straight_edges(&x->cell.tet), iso, o, d, &tet);
        more = tet.doubtful ? -1 : tet.count;
        t = tet.t;
    } else {
        hex_truth_of(x->cell.hexahedron.p, x->cell.hexahedron.value, iso, o, d, &hex);
        more = hex.doubtful ? -1 : hex.count;
        t = hex.t;
    }
    if (more < 0 || count + more > HEX_JUDGE_ROOTS)
        return -1;
    for (int n = 0; n < more; n++)
        if (t[n] > 0.0L)
            roots[count++] = (hex_judge_root){t[n], x->edge};
    return count;
}

int hex_judge_roots(const hex_judge *j, double iso, const double o[3], const double d[3],
                    hex_judge_root roots[HEX_JUDGE_ROOTS]) {
    int count = 0;
    for (size_t i = 0; i < j->count; i++) {
        const hex_judged *x = &j->of[i];
        if (!is_near(x, o, d))
            continue;
        if (x->folded)
            return -1;
        count = add_roots(x, iso, o, d, roots, count);
        if (count < 0)
            return -1;
    }
    qsort(roots, (size_t)count, sizeof *roots, by_t);
    return count;
}

static void compare(hex_tally *tally, const hex_judge_root *root, double t) {
    const double off = (double)fabsl((long double)t - root->t) / root->edge;
    if (off <= HEX_JUDGE_ERROR)
        tally->worst = fmax(tally->worst, off);
    else
        tally->wrong++;
}

bool hex_judge_ray(const hex_judge *j, leafcast *v, double iso, const double o[3],
                   const double d[3], hex_tally *tally) {
    static hex_judge_root roots[HEX_JUDGE_ROOTS];
    static leafcast_hit hits[HEX_JUDGE_ROOTS];
    const leafcast_scene scene = leafcast_scene_default();
    const uint64_t before = hex_tally_faults(tally);
    const int want = hex_judge_roots(j, iso, o, d, roots);
    int count = 0;
    tally->rays++;
    if (want < 0) {
        tally->doubtful++;
        return true;
    }
    assert_int_equal(leafcast_probe_ray(v, &scene, o, d, hits, HEX_JUDGE_ROOTS, &count),
                     LEAFCAST_OK);
    tally->surfaces += (uint64_t)want;
    tally->missed += (uint64_t)(count < want ? want - count : 0);
    tally->invented += (uint64_t)(count > want ? count - want : 0);
    for (int k = 0; k < want && count == want; k++)
        compare(tally, &roots[k], hits[k].t);
    return hex_tally_faults(tally) == before;
}

bool hex_judge_picture(const hex_judge *j, leafcast *v, double iso, const leafcast_camera *c,
                       hex_tally *tally) {
    static hex_judge_root roots[HEX_JUDGE_ROOTS];
    const size_t pixels = (size_t)c->width * c->height;
    double *z = malloc(pixels * sizeof *z);
    const leafcast_scene scene = leafcast_scene_default();
    const leafcast_image image = {.size = sizeof(leafcast_image), .z = z};
    const uint64_t before = hex_tally_faults(tally);
    assert_non_null(z);
    assert_int_equal(leafcast_trace(v, &scene, c, &image, NULL, NULL, NULL), LEAFCAST_OK);
    for (uint32_t i = 0; i < pixels; i++) {
        double o[3], d[3];
        leafcast_pixel_ray(c, i % c->width + 0.5, i / c->width + 0.5, o, d);
        const int want = hex_judge_roots(j, iso, o, d, roots);
        tally->rays++;
        tally->doubtful += want < 0;
        tally->surfaces += want > 0;
        tally->missed += want > 0 && isinf(z[i]);
        tally->invented += want == 0 && !isinf(z[i]);
        if (want > 0 && !isinf(z[i]))
            compare(tally, &roots[0], z[i]);
    }
    free(z);
    return hex_tally_faults(tally) == before;
}

uint64_t hex_tally_faults(const hex_tally *t) {
    return t->missed + t->invented + t->wrong;
}

void hex_tally_add(hex_tally *to, const hex_tally *t) {
    to->rays += t->rays;
    to->doubtful += t->doubtful;
    to->surfaces += t->surfaces;
    to->missed += t->missed;
    to->invented += t->invented;
    to->wrong += t->wrong;
    to->worst = fmax(to->worst, t->worst);
}

void hex_tally_heading(FILE *f) {
    fprintf(f, "%-12s %10s %9s %10s %7s %7s %7s %9s\n", "", "rays", "in doubt", "surfaces",
            "missed", "false", "wrong", "worst");
}

void hex_tally_row(FILE *f, const char *name, const hex_tally *t) {
    fprintf(f,
            "%-12s %10" PRIu64 " %9" PRIu64 " %10" PRIu64 " %7" PRIu64 " %7" PRIu64 " %7" PRIu64
            " %9.1e\n",
            name, t->rays, t->doubtful, t->surfaces, t->missed, t->invented, t->wrong, t->worst);
}
