/* test_export_surface.c - exported isosurfaces, read back by a naive reader: every crossing of a
 * grid's edges is a vertex, once; each side belongs to two triangles; all vertices are
 * on the interpolant's surface; the same bytes whatever the threads, the memory and the treelets.
 */
/* marks: threads, long */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/fault.h"
#include "prep/export/marching_table.h"
#include "tests/support/export_lab.h"
#include "tests/support/fields.h"
#include "tests/support/leaf_files.h"
#include "tests/support/scratch.h"
#include "tests/support/watched.h"

/* ---- a grid, naively ---- */

typedef struct lab_grid {
    field f;
    uint32_t lo[3], end[3]; /* the part */
} lab_grid;

static double sample(const field *f, long i, long j, long k) {
    return (double)f->samples[(k * f->dims[1] + j) * f->dims[0] + i];
}

static double plane(const field *f, int a, long i) {
    return f->axis[a] ? f->axis[a][i] : (double)i;
}

static bool is_sound(const lab_grid *g, const long cell[3]) {
    for (int a = 0; a < 3; a++)
        if (cell[a] < (long)g->lo[a] || cell[a] + 1 >= (long)g->end[a])
            return false;
    for (int c = 0; c < 8; c++)
        if (!isfinite(sample(&g->f, cell[0] + (c & 1), cell[1] + (c >> 1 & 1), cell[2] + (c >> 2))))
            return false;
    return true;
}

static void find_crossing(const field *f, const long node[3], int axis, double iso, double at[3]) {
    long next[3] = {node[0], node[1], node[2]};
    next[axis]++;
    const double from = sample(f, node[0], node[1], node[2]),
                 to = sample(f, next[0], next[1], next[2]), t = (iso - from) / (to - from);
    const double start = plane(f, axis, node[axis]), end = plane(f, axis, next[axis]);
    for (int a = 0; a < 3; a++)
        at[a] = plane(f, a, node[a]);
    at[axis] = t == 1 ? end : start + t * (end - start);
}

/* Whether the surface crosses the edge from a node along an axis, and a cell around has it. */
static bool is_crossed(const lab_grid *g, const long node[3], int axis, double iso) {
    long next[3] = {node[0], node[1], node[2]};
    next[axis]++;
    const double from = sample(&g->f, node[0], node[1], node[2]),
                 to = sample(&g->f, next[0], next[1], next[2]);
    if (!isfinite(from) || !isfinite(to) || (from >= iso) == (to >= iso))
        return false;
    for (int around = 0; around < 4; around++) {
        long cell[3] = {node[0], node[1], node[2]};
        cell[(axis + 1) % 3] -= around & 1;
        cell[(axis + 2) % 3] -= around >> 1;
        if (is_sound(g, cell))
            return true;
    }
    return false;
}

/* Where the surface crosses the grid's edges, in the order of points; free it. */
static double (*grid_crossings(const lab_grid *g, double iso, size_t *count))[3] {
    const field *f = &g->f;
    double(*at)[3] = calloc(3 * (size_t)(f->dims[0] * f->dims[1] * f->dims[2]), sizeof *at);
    assert_non_null(at);
    *count = 0;
    for (int axis = 0; axis < 3; axis++) {
        long end[3] = {g->end[0], g->end[1], g->end[2]}, n[3];
        end[axis]--;
        for (n[2] = g->lo[2]; n[2] < end[2]; n[2]++)
            for (n[1] = g->lo[1]; n[1] < end[1]; n[1]++)
                for (n[0] = g->lo[0]; n[0] < end[0]; n[0]++)
                    if (is_crossed(g, n, axis, iso))
                        find_crossing(f, n, axis, iso, at[(*count)++]);
    }
    qsort(at, *count, sizeof *at, export_lab_by_point);
    return at;
}

/* A point in cells: the cell, and where in it. */
static void find_cell(const field *f, const double at[3], long cell[3], double u[3]) {
    for (int a = 0; a < 3; a++) {
        const bool down = f->axis[a] && f->axis[a][1] < f->axis[a][0];
        long i = 0;
        while (i + 2 < f->dims[a] &&
               (down ? plane(f, a, i + 1) >= at[a] : plane(f, a, i + 1) <= at[a]))
            i++;
        cell[a] = i;
        u[a] = (at[a] - plane(f, a, i)) / (plane(f, a, i + 1) - plane(f, a, i));
    }
}

static bool touches_nothing(const field *f, const long cell[3], const double u[3]) {
    for (int c = 0; c < 8; c++) {
        bool counts = true;
        for (int a = 0; a < 3; a++)
            counts &= u[a] != (c >> a & 1 ? 0.0 : 1.0);
        if (counts &&
            !isfinite(sample(f, cell[0] + (c & 1), cell[1] + (c >> 1 & 1), cell[2] + (c >> 2))))
            return true;
    }
    return false;
}

static long double interpolate(const field *f, const long cell[3], const long double u[3]) {
    long double sum = 0;
    for (int c = 0; c < 8; c++) {
        long double weight = 1;
        for (int a = 0; a < 3; a++)
            weight *= c >> a & 1 ? u[a] : 1 - u[a];
        if (weight != 0)
            sum += weight * (long double)sample(f, cell[0] + (c & 1), cell[1] + (c >> 1 & 1),
                                                cell[2] + (c >> 2));
    }
    return sum;
}

/* Whether the side changes within 1e-6 cell of a point in a cell. */
static bool is_near(const field *f, const long cell[3], const double u[3], double iso) {
    if (interpolate(f, cell, (long double[3]){u[0], u[1], u[2]}) == (long double)iso)
        return true;
    for (int way = 0; way < 27; way++) {
        bool side[2];
        for (int end = 0; end < 2; end++) {
            long double moved[3], value;
            for (int a = 0, step = way; a < 3; a++, step /= 3)
                moved[a] = u[a] + (end ? 1e-6L : -1e-6L) * (step % 3 - 1);
            value = interpolate(f, cell, moved);
            if (isnan(value))
                return true; /* beside what is missing; edges are counted, too */
            side[end] = value >= (long double)iso;
        }
        if (side[0] != side[1])
            return true;
    }
    return false;
}

/* Whether a vertex is on the surface, as one of the cells that it is in has it. */
static bool is_on_surface(const field *f, const double at[3], double iso) {
    long cell[3];
    double u[3];
    find_cell(f, at, cell, u);
    for (int a = 0; a < 3; a++) {
        if (fabs(u[a]) < 1e-9 || fabs(u[a] - 1) < 1e-9)
            u[a] = round(u[a]);
    }
    assert_false(touches_nothing(f, cell, u));
    for (int other = 0; other < 8; other++) {
        long beside[3];
        double v[3];
        bool there = true;
        for (int a = 0; a < 3; a++) {
            const bool moved = other >> a & 1;
            beside[a] = cell[a] - moved;
            v[a] = u[a] + moved;
            there &= !moved || (u[a] == 0 && cell[a] > 0);
        }
        if (there && is_near(f, beside, v, iso))
            return true;
    }
    return false;
}

static void write_axis(leaf_case *c, const field *f, int a) {
    static char text[3][1 << 16];
    static const char *const names[3] = {"x.txt", "y.txt", "z.txt"};
    size_t at = 0;
    if (!f->axis[a])
        return;
    for (long i = 0; i < f->dims[a]; i++)
        at += (size_t)snprintf(text[a] + at, sizeof text[a] - at, "%.17g\n", f->axis[a][i]);
    c->axis_file[a] = scratch_text(names[a], text[a]);
}

static const char *leaf_of(const field *f, uint32_t cells_log2, uint32_t halo) {
    leaf_case c = leaf_files_case((uint32_t)f->dims[0], (uint32_t)f->dims[1], (uint32_t)f->dims[2],
                                  SAMPLE_F32);
    c.samples = f->samples;
    c.options.file.cells_log2 = cells_log2;
    c.options.file.halo = halo;
    for (int a = 0; a < 3; a++)
        write_axis(&c, f, a);
    return leaf_files_make(&c, "grid.leaf");
}

/* Open sides lie in the faces of the part, or beside cells without a surface. */
static void check_rim(const lab_grid *g, const ply_surface *s, const ply_sides *sides) {
    for (size_t i = 0; i < sides->open; i++) {
        bool rim = false;
        for (int a = 0; a < 3; a++)
            for (int end = 0; end < 2; end++) {
                const double border = plane(&g->f, a, end ? g->end[a] - 1 : g->lo[a]);
                rim |= s->at[sides->rim[i][0]][a] == border && s->at[sides->rim[i][1]][a] == border;
            }
        if (!rim)
            fail_msg("%s: open between %.17g %.17g %.17g and %.17g %.17g %.17g", g->f.name,
                     s->at[sides->rim[i][0]][0], s->at[sides->rim[i][0]][1],
                     s->at[sides->rim[i][0]][2], s->at[sides->rim[i][1]][0],
                     s->at[sides->rim[i][1]][1], s->at[sides->rim[i][1]][2]);
    }
}

static bool has_gaps(const field *f) {
    bool gaps = false;
    for (long i = 0; i < f->dims[0] * f->dims[1] * f->dims[2]; i++)
        gaps |= !isfinite(f->samples[i]);
    return gaps;
}

/* All crossings are vertices, each as often as it is there; the others are centres of cells. */
static void check_crossings(const lab_grid *g, const ply_surface *s, double iso) {
    size_t count, found = 0;
    double(*want)[3] = grid_crossings(g, iso, &count);
    double(*at)[3] = calloc(s->vertices + 1, sizeof *at);
    assert_non_null(at);
    memcpy(at, s->at, s->vertices * sizeof *at);
    qsort(at, s->vertices, sizeof *at, export_lab_by_point);
    for (size_t v = 0; v < s->vertices; v++)
        found += found < count && export_lab_by_point(at[v], want[found]) == 0;
    if (found != count)
        fail_msg("%s: %zu of %zu crossings are no vertices", g->f.name, count - found, count);
    assert_true(s->vertices - count <= count / 8);
    free(want);
    free(at);
}

static void check_surface(const lab_grid *g, const ply_surface *s, double iso) {
    for (size_t v = 0; v < s->vertices; v++)
        if (!is_on_surface(&g->f, s->at[v], iso))
            fail_msg("%s: vertex %zu at %.17g %.17g %.17g is not on the surface", g->f.name, v,
                     s->at[v][0], s->at[v][1], s->at[v][2]);
    check_crossings(g, s, iso);
    ply_sides sides = ply_surface_sides(s);
    assert_int_equal(sides.repeated, 0);
    if (!has_gaps(&g->f)) {
        check_rim(g, s, &sides);
        assert_int_equal(ply_surface_fans(s), 0);
    }
    free(sides.rim);
    (void)ply_surface_euler(s);
}

/* ---- grids ---- */

static lab_grid whole(const field *f) {
    lab_grid g = {.f = *f};
    for (int a = 0; a < 3; a++)
        g.end[a] = (uint32_t)f->dims[a];
    return g;
}

static void test_fields(void **state) {
    (void)state;
    skip_under_thread();
    for (int i = 0; i < field_count(); i++) {
        field f;
        assert_true(field_make(&f, field_name(i), 21, FIELD_SEED));
        const lab_grid g = whole(&f);
        for (uint32_t halo = WATCHED ? (uint32_t)i % 2 : 0; halo < 2; halo += WATCHED ? 2 : 1) {
            const export_how h = export_lab_plain(f.iso);
            ply_surface s = export_lab_surface(leaf_of(&f, 4, halo), &h);
            check_surface(&g, &s, f.iso);
            ply_surface_release(&s);
        }
        field_release(&f);
    }
}

/* Noise of few values, so that many samples are the isovalue, and of many; sparse gaps. */
static void make_noise(field *f, uint64_t seed, long levels, long gaps) {
    field_random r = {seed};
    *f = (field){.name = "noise", .dims = {19, 34, 18}};
    const size_t count = (size_t)(f->dims[0] * f->dims[1] * f->dims[2]);
    f->samples = malloc(count * sizeof *f->samples);
    assert_non_null(f->samples);
    for (size_t i = 0; i < count; i++) {
        f->samples[i] =
            levels ? (float)field_random_below(&r, levels) : (float)field_random_unit(&r);
        if (gaps && field_random_below(&r, gaps) == 0)
            f->samples[i] = NAN;
    }
}

static void test_noise(void **state) {
    (void)state;
    skip_under_thread();
    static const struct {
        long levels, gaps;
        double iso;
    } cases[] = {{0, 0, 0.5}, {0, 0, 0.3}, {0, 40, 0.5}, {3, 0, 1}, {2, 0, 0.5}, {2, 0, 1}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        for (uint64_t seed = 1; seed < (WATCHED ? 2 : 4); seed++) {
            lab_grid g;
            make_noise(&g.f, seed, cases[i].levels, cases[i].gaps);
            g = whole(&g.f);
            const export_how h = export_lab_plain(cases[i].iso);
            ply_surface s = export_lab_surface(leaf_of(&g.f, 4, seed & 1), &h);
            check_surface(&g, &s, cases[i].iso);
            ply_surface_release(&s);
            free(g.f.samples);
        }
}

static void test_box(void **state) {
    (void)state;
    const uint32_t box[6] = {3, 15, 1, 16, 32, 17};
    lab_grid g;
    make_noise(&g.f, 7, 0, 0);
    for (int a = 0; a < 3; a++) {
        g.lo[a] = box[a];
        g.end[a] = box[a + 3] + 1;
    }
    export_how h = export_lab_plain(0.5);
    h.box = box;
    ply_surface s = export_lab_surface(leaf_of(&g.f, 4, 1), &h);
    check_surface(&g, &s, 0.5);
    assert_true(s.triangles > 1000);
    ply_surface_release(&s);
    free(g.f.samples);
}

/* ---- how it is turned ---- */

/* A ball around the middle; its values fall outwards. */
static void make_ball(field *f, long n, bool mirrored) {
    *f = (field){.name = "ball", .dims = {n, n, n}};
    f->samples = malloc((size_t)(n * n * n) * sizeof *f->samples);
    assert_non_null(f->samples);
    const double middle = (double)(n - 1) / 2;
    for (long i = 0; i < n * n * n; i++) {
        const double x = (double)(i % n) - middle, y = (double)(i / n % n) - middle,
                     z = (double)(i / n / n) - middle;
        f->samples[i] = (float)(middle - sqrt(x * x + y * y + z * z));
    }
    if (!mirrored)
        return;
    f->axis[1] = malloc((size_t)n * sizeof(double));
    assert_non_null(f->axis[1]);
    for (long i = 0; i < n; i++)
        f->axis[1][i] = (double)(n - 1 - i);
}

static void test_ball(void **state) {
    (void)state;
    for (int mirrored = 0; mirrored < 2; mirrored++) {
        field f;
        make_ball(&f, 41, mirrored);
        const export_how h = export_lab_plain(5.5);
        ply_surface s = export_lab_surface(leaf_of(&f, 4, 1), &h);
        export_lab_check_ball(&s, 20, 14.5, 0.002);
        ply_surface_release(&s);
        free(f.samples);
        free(f.axis[1]);
    }
}

static void test_isovalues(void **state) {
    (void)state;
    field f;
    make_ball(&f, 33, false);
    export_how h = export_lab_plain(3.25);
    const char *path = leaf_of(&f, 4, 1);
    ply_surface one = export_lab_surface(path, &h);
    h.isovalues[0] = 8.5;
    ply_surface other = export_lab_surface(path, &h);
    h = (export_how){.format = "ply", .isovalues = {3.25, 8.5}, .count = 2, .threads = 2};
    ply_surface both = export_lab_surface(path, &h);
    assert_int_equal(both.vertices, one.vertices + other.vertices);
    assert_int_equal(both.triangles, one.triangles + other.triangles);
    assert_int_equal(ply_surface_euler(&both), 4);
    for (size_t v = 0; v < both.vertices; v++) {
        const double *at = v < one.vertices ? one.at[v] : other.at[v - one.vertices];
        assert_memory_equal(both.at[v], at, sizeof both.at[v]);
        assert_true(both.isovalue[v] == (v < one.vertices ? 3.25 : 8.5));
    }
    ply_surface_release(&one);
    ply_surface_release(&other);
    ply_surface_release(&both);
    free(f.samples);
}

/* ---- the table ---- */

static bool in_a_face(const marching_table *t, int e, int other) {
    for (int face = 0; face < 6; face++) {
        int corners = 0;
        for (int i = 0; i < 4; i++)
            for (int k = 0; k < 2; k++)
                corners +=
                    (t->edge[e][k] == t->face[face][i]) + (t->edge[other][k] == t->face[face][i]);
        if (corners == 4)
            return true;
    }
    return false;
}

/* Of all cases: sides that lie in a face are there once, others twice, turned against one another,
 * and these lie in no face; just the crossed edges are used. */
static void test_table(void **state) {
    (void)state;
    skip_under_thread();
    enum { CORNERS = MARCHING_EDGES + MARCHING_CENTRES };
    static marching_table t;
    marching_table_init(&t);
    int count = 0, centres = 0;
    for (int mask = 0; mask < 256; mask++) {
        const int cases = 1 << __builtin_popcount(t.undecided[mask]);
        assert_int_equal(t.first[mask], count);
        count += cases;
        for (int n = 0; n < cases; n++) {
            const marching_case *c = &t.cases[t.first[mask] + n];
            int side[CORNERS][CORNERS] = {{0}};
            bool used[CORNERS] = {false};
            centres += c->centres;
            for (int i = 0; i < c->triangles; i++)
                for (int k = 0; k < 3; k++) {
                    side[c->corner[i][k]][c->corner[i][(k + 1) % 3]]++;
                    used[c->corner[i][k]] = true;
                }
            for (int a = 0; a < CORNERS; a++)
                for (int b = 0; b < CORNERS; b++) {
                    if (!side[a][b])
                        continue;
                    const bool face =
                        a < MARCHING_EDGES && b < MARCHING_EDGES && in_a_face(&t, a, b);
                    assert_int_equal(side[a][b], 1);
                    assert_int_equal(side[b][a], !face);
                }
            for (int e = 0; e < MARCHING_EDGES; e++)
                assert_int_equal(used[e], (mask >> t.edge[e][0] & 1) != (mask >> t.edge[e][1] & 1));
        }
    }
    assert_int_equal(count, MARCHING_CASES);
    assert_int_equal(centres, 116);
}

/* ---- the same bytes ---- */

static void test_same(void **state) {
    (void)state;
    static const char *const formats[] = {"ply", "stl", "vtp"};
    field f;
    make_noise(&f, 5, 0, 30);
    const char *noise = leaf_of(&f, 4, 1);
    for (int i = 0; i < 3; i++)
        export_lab_check_same(noise, 0.5, formats[i], 12 << 20);
    free(f.samples);
}

/* ---- the same bytes ---- */

/* Facets of STL: those of the PLY whose corners are three points as floats. */
static void test_facets(void **state) {
    (void)state;
    field f;
    make_noise(&f, 3, 3, 0);
    const char *path = leaf_of(&f, 4, 1);
    export_how h = export_lab_plain(1);
    ply_surface s = export_lab_surface(path, &h);
    size_t size, at = 84;
    h.format = "stl";
    char *bytes = export_lab_bytes(path, &h, &size);
    uint32_t count, kept = 0;
    memcpy(&count, bytes + 80, sizeof count);
    assert_int_equal(size, 84 + 50 * (size_t)count);
    for (size_t t = 0; t < s.triangles; t++) {
        float corner[3][3];
        for (int i = 0; i < 3; i++)
            for (int a = 0; a < 3; a++)
                corner[i][a] = (float)s.at[s.corner[t][i]][a];
        if (!memcmp(corner[0], corner[1], 12) || !memcmp(corner[1], corner[2], 12) ||
            !memcmp(corner[2], corner[0], 12))
            continue;
        assert_memory_equal(bytes + at + 12, corner, sizeof corner);
        at += 50;
        kept++;
    }
    assert_int_equal(kept, count);
    assert_true(kept < s.triangles);
    free(bytes);
    ply_surface_release(&s);
    free(f.samples);
}

/* What a .vtp has is what the PLY has. */
static void test_arrays(void **state) {
    (void)state;
    field f;
    make_noise(&f, 4, 0, 0);
    const char *path = leaf_of(&f, 4, 1);
    export_how h = {.format = "ply", .isovalues = {0.5, 0.25}, .count = 2, .threads = 2};
    ply_surface s = export_lab_surface(path, &h);
    h.format = "vtp";
    char *bytes = export_lab_bytes(path, &h, NULL);
    const char *corners = export_lab_array(bytes, "connectivity"),
               *offsets = export_lab_array(bytes, "offsets");
    assert_memory_equal(export_lab_array(bytes, "Points"), s.at, s.vertices * sizeof *s.at);
    assert_memory_equal(export_lab_array(bytes, "Normals"), s.normal,
                        s.vertices * sizeof *s.normal);
    assert_memory_equal(export_lab_array(bytes, "isovalue"), s.isovalue,
                        s.vertices * sizeof *s.isovalue);
    for (size_t t = 0; t < s.triangles; t++) {
        int64_t v[3], end;
        memcpy(v, corners + t * sizeof v, sizeof v);
        memcpy(&end, offsets + t * sizeof end, sizeof end);
        assert_int_equal(end, 3 * (t + 1));
        for (int i = 0; i < 3; i++)
            assert_int_equal(v[i], s.corner[t][i]);
    }
    free(bytes);
    ply_surface_release(&s);
    free(f.samples);
}

/* ---- trouble ---- */

static void check_bytes(const char *want, size_t size) {
    size_t there;
    char *bytes = scratch_read(scratch_path("surface"), &there);
    assert_int_equal(there, size);
    assert_memory_equal(bytes, want, size);
    free(bytes);
}

static void test_faults(void **state) {
    (void)state;
    skip_under_thread();
    field f;
    piece_info info;
    mem m;
    mem_init(&m, 0);
    make_ball(&f, 33, false);
    const char *path = leaf_of(&f, 4, 1);
    export_how h = export_lab_plain(5.5);
    h.threads = 1;
    size_t size;
    char *good = export_lab_bytes(path, &h, &size);
    for (int kind = FAULT_ALLOC; kind <= FAULT_WRITE; kind++) {
        int fired = 0;
        bool hit = true;
        for (long k = 1; hit; k += WATCHED ? 1 + k / 4 : 1) {
            fault_arm((fault_kind)kind, k);
            const status st = export_lab_try(&m, path, &h, &info);
            hit = fault_fired((fault_kind)kind);
            fault_arm((fault_kind)kind, 0);
            /* The folder's sync, the last of all, may fail: the file is there. */
            if (st == ST_OK)
                check_bytes(good, size);
            else
                assert_true(hit);
            assert_int_equal(mem_used(&m), 0);
            fired += hit;
        }
        assert_true(fired > 5);
    }
    free(good);
    free(f.samples);
}

static void test_malice(void **state) {
    (void)state;
    field f;
    make_noise(&f, 9, 0, 30);
    const export_how h = export_lab_plain(0.5);
    export_lab_malice(leaf_of(&f, 4, 1), &h, 1, WATCHED_THREADS ? 20 : WATCHED ? 100 : 300);
    free(f.samples);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_table),  cmocka_unit_test(test_fields),
        cmocka_unit_test(test_noise),  cmocka_unit_test(test_box),
        cmocka_unit_test(test_ball),   cmocka_unit_test(test_isovalues),
        cmocka_unit_test(test_same),   cmocka_unit_test(test_facets),
        cmocka_unit_test(test_arrays), cmocka_unit_test(test_faults),
        cmocka_unit_test(test_malice),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
