/* test_export_surface.c - exported isosurfaces, read back by a naive reader: every crossing of a
 * grid's or a mesh's edges is a vertex, once; each side belongs to two triangles; all vertices are
 * on the interpolant's surface; the same bytes whatever the threads, the memory and the treelets.
 */
/* marks: threads, bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/fault.h"
#include "prep/export/grid_surface.h"
#include "prep/export/marching_table.h"
#include "prep/export/piece_export.h"
#include "prep/export/tet_pieces.h"
#include "prep/export/tet_surface.h"
#include "tests/support/fields.h"
#include "tests/support/lab_leaf.h"
#include "tests/support/leaf_files.h"
#include "tests/support/ply_surface.h"
#include "tests/support/scratch.h"

static const piece_format *format_of(const char *name) {
    for (int i = 0; i < piece_format_count; i++)
        if (strcmp(piece_formats[i].name, name) == 0)
            return &piece_formats[i];
    fail_msg("no format %s", name);
    return NULL;
}

/* ---- to a file, and back ---- */

/* How a surface is made. */
typedef struct how {
    const char *format;
    double isovalues[2];
    uint32_t count;
    int threads;
    size_t memory; /* 0: any */
    const uint32_t *box;
    uint32_t level;
} how;

static status write_pieces(mem *m, const how *h, const piece_source *source, piece_info *info) {
    const piece_export e = {.source = source,
                            .format = format_of(h->format),
                            .path = scratch_path("surface"),
                            .beside = scratch_path("surface"),
                            .force = true,
                            .threads = h->threads};
    info->name = "lab";
    info->isovalues = h->count;
    info->floats |= e.format->loose;
    return piece_export_run(m, &e, info);
}

static status try_grid(mem *m, leaf_file *f, const how *h, piece_info *info) {
    grid_part part;
    grid_surface *s = NULL;
    status st = grid_part_of(f, h->level, h->box, &part);
    if (st == ST_OK)
        st = grid_surface_create(m, f, &part, h->isovalues, h->count, h->threads, &s);
    if (st == ST_OK) {
        const piece_source source = grid_surface_source(s);
        st = write_pieces(m, h, &source, info);
    }
    grid_surface_destroy(s);
    return st;
}

static status try_mesh(mem *m, leaf_file *f, const how *h, piece_info *info) {
    const uint32_t first = 0;
    const tet_choice choice = {.f = f, .fields = &first, .count = 1, .gradients = true};
    tet_surface *s = NULL;
    status st = tet_surface_create(m, &choice, h->isovalues, h->count, h->threads, &s);
    if (st == ST_OK) {
        const piece_source source = tet_surface_source(s);
        st = write_pieces(m, h, &source, info);
    }
    tet_surface_destroy(s);
    return st;
}

static status try_surface(mem *m, const char *path, const how *h, piece_info *info) {
    leaf_file *f = NULL;
    *info = (piece_info){.floats = false};
    status st = leaf_file_open(m, path, &f);
    if (st == ST_OK) {
        m->limit = h->memory ? mem_used(m) + h->memory : 0;
        st = f->mesh ? try_mesh(m, f, h, info) : try_grid(m, f, h, info);
        m->limit = 0;
    }
    leaf_file_close(f);
    return st;
}

/* The file's bytes; free them. */
static char *surface_bytes(const char *path, const how *h, size_t *size) {
    mem m;
    piece_info info;
    mem_init(&m, 0);
    if (try_surface(&m, path, h, &info) != ST_OK)
        fail_msg("%s", status_text());
    assert_int_equal(mem_used(&m), 0);
    return scratch_read(scratch_path("surface"), size);
}

static ply_surface surface_of(const char *path, const how *h) {
    size_t size;
    char *bytes = surface_bytes(path, h, &size);
    const ply_surface s = ply_surface_read(bytes, size);
    free(bytes);
    return s;
}

static how plain(double isovalue) {
    return (how){.format = "ply", .isovalues = {isovalue}, .count = 1, .threads = 2};
}

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

static int by_place(const void *a, const void *b) {
    const double *x = a, *y = b;
    for (int i = 0; i < 3; i++)
        if (x[i] != y[i])
            return x[i] < y[i] ? -1 : 1;
    return 0;
}

static void place_crossing(const field *f, const long node[3], int axis, double iso, double at[3]) {
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

/* Where the surface crosses the grid's edges, in the order of the places; free it. */
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
                        place_crossing(f, n, axis, iso, at[(*count)++]);
    }
    qsort(at, *count, sizeof *at, by_place);
    return at;
}

/* A place in cells: the cell, and where in it. */
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

/* Whether the side changes within 1e-6 cell of a place in a cell. */
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
    qsort(at, s->vertices, sizeof *at, by_place);
    for (size_t v = 0; v < s->vertices; v++)
        found += found < count && by_place(at[v], want[found]) == 0;
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
    for (int i = 0; i < field_count(); i++) {
        field f;
        assert_true(field_make(&f, field_name(i), 21, FIELD_SEED));
        const lab_grid g = whole(&f);
        for (uint32_t halo = 0; halo < 2; halo++) {
            const how h = plain(f.iso);
            ply_surface s = surface_of(leaf_of(&f, 4, halo), &h);
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
    static const struct {
        long levels, gaps;
        double iso;
    } cases[] = {{0, 0, 0.5}, {0, 0, 0.3}, {0, 40, 0.5}, {3, 0, 1}, {2, 0, 0.5}, {2, 0, 1}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        for (uint64_t seed = 1; seed < 4; seed++) {
            lab_grid g;
            make_noise(&g.f, seed, cases[i].levels, cases[i].gaps);
            g = whole(&g.f);
            const how h = plain(cases[i].iso);
            ply_surface s = surface_of(leaf_of(&g.f, 4, seed & 1), &h);
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
    how h = plain(0.5);
    h.box = box;
    ply_surface s = surface_of(leaf_of(&g.f, 4, 1), &h);
    check_surface(&g, &s, 0.5);
    assert_true(s.triangles > 1000);
    ply_surface_release(&s);
    free(g.f.samples);
}

/* ---- how it is turned ---- */

static double volume_of(const ply_surface *s) {
    double sum = 0;
    for (size_t t = 0; t < s->triangles; t++) {
        const double *a = s->at[s->corner[t][0]], *b = s->at[s->corner[t][1]],
                     *c = s->at[s->corner[t][2]];
        sum += a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
               a[2] * (b[0] * c[1] - b[1] * c[0]);
    }
    return sum / 6;
}

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

static void check_ball(const ply_surface *s, double middle, double radius, double tolerance) {
    assert_int_equal(ply_surface_euler(s), 2);
    ply_sides sides = ply_surface_sides(s);
    assert_int_equal(sides.open + sides.repeated, 0);
    free(sides.rim);
    assert_true(fabs(volume_of(s) / (4.0 / 3 * M_PI * radius * radius * radius) - 1) < 0.01);
    for (size_t v = 0; v < s->vertices; v++) {
        double dot = 0, length = 0;
        for (int a = 0; a < 3; a++) {
            dot += (double)s->normal[v][a] * (s->at[v][a] - middle) / radius;
            length += (double)s->normal[v][a] * (double)s->normal[v][a];
        }
        assert_true(fabs(length - 1) < 1e-6);
        assert_true(dot > 1 - tolerance);
    }
}

static void test_ball(void **state) {
    (void)state;
    for (int mirrored = 0; mirrored < 2; mirrored++) {
        field f;
        make_ball(&f, 41, mirrored);
        const how h = plain(5.5);
        ply_surface s = surface_of(leaf_of(&f, 4, 1), &h);
        check_ball(&s, 20, 14.5, 0.002);
        ply_surface_release(&s);
        free(f.samples);
        free(f.axis[1]);
    }
}

static void test_isovalues(void **state) {
    (void)state;
    field f;
    make_ball(&f, 33, false);
    how h = plain(3.25);
    const char *path = leaf_of(&f, 4, 1);
    ply_surface one = surface_of(path, &h);
    h.isovalues[0] = 8.5;
    ply_surface other = surface_of(path, &h);
    h = (how){.format = "ply", .isovalues = {3.25, 8.5}, .count = 2, .threads = 2};
    ply_surface both = surface_of(path, &h);
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

/* ---- meshes ---- */

/* Ends from the lower to the higher vertex: place, value. Those that look the same are one. */
typedef struct mesh_edge {
    float end[2][4];
} mesh_edge;

static int by_ends(const void *a, const void *b) {
    return memcmp(a, b, sizeof(mesh_edge));
}

static mesh_edge edge_between(const lab_mesh *lab, uint32_t one, uint32_t other) {
    const uint32_t ends[2] = {one < other ? one : other, one < other ? other : one};
    mesh_edge e;
    for (int i = 0; i < 2; i++) {
        memcpy(e.end[i], lab->points[ends[i]], sizeof lab->points[0]);
        e.end[i][3] = lab->values[ends[i]];
    }
    return e;
}

/* Where the surface crosses edges of tets, each once; free it. */
static double (*mesh_crossings(const lab_mesh *lab, double iso, size_t *count))[3] {
    mesh_edge *edges = calloc(6 * lab->tet_count + 1, sizeof *edges);
    size_t n = 0;
    assert_non_null(edges);
    for (size_t t = 0; t < lab->tet_count; t++) {
        const uint32_t *v = lab->tets[t];
        bool sound = true;
        for (int i = 0; i < 4; i++) {
            sound &= v[i] < lab->point_count;
            for (int k = 0; k < i; k++)
                sound &= v[i] != v[k];
        }
        for (int i = 0; i < 4 && sound; i++)
            sound &= isfinite(lab->values[v[i]]);
        for (int i = 0; i < 4 && sound; i++)
            for (int k = i + 1; k < 4; k++)
                if (((double)lab->values[v[i]] >= iso) != ((double)lab->values[v[k]] >= iso))
                    edges[n++] = edge_between(lab, v[i], v[k]);
    }
    qsort(edges, n, sizeof *edges, by_ends);
    double(*at)[3] = calloc(n + 1, sizeof *at);
    assert_non_null(at);
    *count = 0;
    for (size_t i = 0; i < n; i++) {
        if (i > 0 && by_ends(&edges[i], &edges[i - 1]) == 0)
            continue;
        const float *low = edges[i].end[0], *high = edges[i].end[1];
        const double t = (iso - (double)low[3]) / ((double)high[3] - (double)low[3]);
        for (int a = 0; a < 3; a++) {
            const double p = (double)low[a], q = (double)high[a];
            at[*count][a] = t == 1 ? q : p + t * (q - p);
        }
        ++*count;
    }
    free(edges);
    return at;
}

static void check_mesh(const lab_mesh *lab, const ply_surface *s) {
    size_t count;
    double(*at)[3] = mesh_crossings(lab, lab->iso, &count);
    double(*found)[3] = calloc(s->vertices + 1, sizeof *found);
    assert_non_null(found);
    memcpy(found, s->at, s->vertices * sizeof *found);
    if (s->vertices != count)
        fail_msg("%s: %zu vertices, %zu edges are crossed", lab->name, s->vertices, count);
    qsort(at, count, sizeof *at, by_place);
    qsort(found, count, sizeof *found, by_place);
    assert_memory_equal(at, found, count * sizeof *at);
    ply_sides sides = ply_surface_sides(s);
    /* A tet that is there twice has its triangles twice. */
    if (lab->sound && strcmp(lab->name, "repeated") != 0) {
        if (sides.repeated > 0 || (lab->closed && sides.open > 0))
            fail_msg("%s: %zu sides are there twice, %zu open", lab->name, sides.repeated,
                     sides.open);
    }
    free(sides.rim);
    free(at);
    free(found);
}

static void test_meshes(void **state) {
    (void)state;
    for (int i = 0; i < lab_mesh_count(); i++) {
        lab_mesh lab;
        assert_true(lab_mesh_make(&lab, lab_mesh_name(i), 8, 1));
        for (uint32_t tets = 60; tets < 5000; tets *= 70) {
            const char *path = lab_leaf_make(&lab, tets, tets < 100);
            const how h = plain(lab.iso);
            ply_surface s = surface_of(path, &h);
            check_mesh(&lab, &s);
            ply_surface_release(&s);
        }
        lab_mesh_release(&lab);
    }
}

static double ball_value(const double p[3]) {
    return 6 - sqrt((p[0] - 6) * (p[0] - 6) + (p[1] - 6) * (p[1] - 6) + (p[2] - 6) * (p[2] - 6));
}

static void test_mesh_ball(void **state) {
    (void)state;
    lab_mesh lab;
    lab_mesh_kuhn(&lab, (int[3]){24, 24, 24}, (double[3]){0, 0, 0}, 0.5, ball_value);
    for (int gradients = 0; gradients < 2; gradients++) {
        const how h = plain(1.7);
        ply_surface s = surface_of(lab_leaf_make(&lab, 300, gradients), &h);
        check_ball(&s, 6, 4.3, gradients ? 0.01 : 0.05);
        ply_surface_release(&s);
    }
    lab_mesh_release(&lab);
}

/* ---- a mesh as it is ---- */

static uint64_t sum_of(const float at[3], float value) {
    float all[4] = {at[0], at[1], at[2], value};
    return hash_bytes(all, sizeof all);
}

static int by_number(const void *a, const void *b) {
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

static const char *array_at(const char *bytes, const char *name) {
    char declared[64];
    snprintf(declared, sizeof declared, "Name=\"%s\"", name);
    const char *at = strstr(bytes, declared),
               *data = strstr(bytes, "<AppendedData encoding=\"raw\">\n_");
    assert_non_null(at);
    assert_non_null(data);
    return data + strlen("<AppendedData encoding=\"raw\">\n_") +
           strtoull(strstr(at, "offset=\"") + 8, NULL, 10) + 8;
}

static void test_tets(void **state) {
    (void)state;
    lab_mesh lab;
    lab_mesh_kuhn(&lab, (int[3]){9, 8, 7}, (double[3]){-1, 5, 0}, 0.75, ball_value);
    const char *path = lab_leaf_make(&lab, 100, false);
    mem m;
    leaf_file *f;
    tet_pieces *s;
    const uint32_t first = 0;
    const char *const names[] = {"f<\"x\">"};
    mem_init(&m, 0);
    assert_int_equal(leaf_file_open(&m, path, &f), ST_OK);
    const tet_choice choice = {.f = f, .fields = &first, .count = 1};
    assert_int_equal(tet_pieces_create(&m, &choice, 3, &s), ST_OK);
    const piece_source source = tet_pieces_source(s);
    piece_info info = {.fields = names, .field_count = 1, .floats = true};
    const how h = {.format = "vtu", .threads = 3};
    assert_int_equal(write_pieces(&m, &h, &source, &info), ST_OK);
    assert_int_equal(info.vertices, lab.point_count);
    assert_int_equal(info.cells, lab.tet_count);
    char *bytes = scratch_read(scratch_path("surface"), NULL);
    const float(*at)[3] = (const float(*)[3])(const void *)array_at(bytes, "Points");
    const char *values = array_at(bytes, "f&lt;&quot;x&quot;&gt;"),
               *corners = array_at(bytes, "connectivity");
    uint64_t *want = calloc(lab.tet_count, sizeof *want), *got = calloc(lab.tet_count, sizeof *got);
    for (size_t t = 0; t < lab.tet_count; t++) {
        int64_t v[4];
        double p[4][3];
        memcpy(v, corners + t * sizeof v, sizeof v);
        for (int i = 0; i < 4; i++) {
            float place[3], value;
            memcpy(place, (const char *)at + v[i] * 12, sizeof place);
            memcpy(&value, values + v[i] * 4, sizeof value);
            got[t] += sum_of(place, value);
            want[t] += sum_of(lab.points[lab.tets[t][i]], lab.values[lab.tets[t][i]]);
            for (int a = 0; a < 3; a++)
                p[i][a] = (double)place[a] - (i > 0 ? p[0][a] : 0);
        }
        assert_true(p[1][0] * (p[2][1] * p[3][2] - p[2][2] * p[3][1]) +
                        p[1][1] * (p[2][2] * p[3][0] - p[2][0] * p[3][2]) +
                        p[1][2] * (p[2][0] * p[3][1] - p[2][1] * p[3][0]) >
                    0);
    }
    qsort(want, lab.tet_count, sizeof *want, by_number);
    qsort(got, lab.tet_count, sizeof *got, by_number);
    assert_memory_equal(want, got, lab.tet_count * sizeof *want);
    free(want);
    free(got);
    free(bytes);
    tet_pieces_destroy(s);
    leaf_file_close(f);
    assert_int_equal(mem_used(&m), 0);
    lab_mesh_release(&lab);
}

/* ---- the same bytes ---- */

static void check_same(const char *path, double iso, const char *format, size_t little) {
    how h = plain(iso);
    size_t size, other;
    h.format = format;
    h.threads = 1;
    char *bytes = surface_bytes(path, &h, &size);
    for (int i = 0; i < 3; i++) {
        h.threads = 1 + i;
        h.memory = i == 1 ? 0 : little;
        char *again = surface_bytes(path, &h, &other);
        assert_int_equal(size, other);
        assert_memory_equal(bytes, again, size);
        free(again);
    }
    free(bytes);
}

static void test_same(void **state) {
    (void)state;
    static const char *const formats[] = {"ply", "stl", "vtp"};
    lab_mesh lab;
    field f;
    make_noise(&f, 5, 0, 30);
    const char *noise = leaf_of(&f, 4, 1);
    for (int i = 0; i < 3; i++)
        check_same(noise, 0.5, formats[i], 12 << 20);
    free(f.samples);
    assert_true(lab_mesh_make(&lab, "sphere", 20, 1));
    const char *mesh = lab_leaf_make(&lab, 40, false);
    for (int i = 0; i < 3; i++)
        check_same(mesh, lab.iso, formats[i], 4 << 20);
    lab_mesh_release(&lab);
}

/* Facets of STL: those of the PLY whose corners are three places as floats. */
static void test_facets(void **state) {
    (void)state;
    field f;
    make_noise(&f, 3, 3, 0);
    const char *path = leaf_of(&f, 4, 1);
    how h = plain(1);
    ply_surface s = surface_of(path, &h);
    size_t size, at = 84;
    h.format = "stl";
    char *bytes = surface_bytes(path, &h, &size);
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
    field f;
    piece_info info;
    mem m;
    mem_init(&m, 0);
    make_ball(&f, 33, false);
    const char *path = leaf_of(&f, 4, 1);
    how h = plain(5.5);
    h.threads = 1;
    size_t size;
    char *good = surface_bytes(path, &h, &size);
    for (int kind = FAULT_ALLOC; kind <= FAULT_WRITE; kind++) {
        int fired = 0;
        for (long k = 1; fired == k - 1; k++) {
            fault_arm((fault_kind)kind, k);
            const status st = try_surface(&m, path, &h, &info);
            const bool hit = fault_fired((fault_kind)kind);
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

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_table),  cmocka_unit_test(test_fields),
        cmocka_unit_test(test_noise),  cmocka_unit_test(test_box),
        cmocka_unit_test(test_ball),   cmocka_unit_test(test_isovalues),
        cmocka_unit_test(test_meshes), cmocka_unit_test(test_mesh_ball),
        cmocka_unit_test(test_tets),   cmocka_unit_test(test_same),
        cmocka_unit_test(test_facets), cmocka_unit_test(test_faults),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
