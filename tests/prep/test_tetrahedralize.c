/* test_tetrahedralize.c - points to Delaunay meshes, held to an exact in-sphere test; surfaces to
 * meshes of their inside; distances against brute force; fields; each failure of TetGen as an
 * error; faults.
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
#include "formats/base/sibling.h"
#include "prep/tetrahedralize/tetrahedralize.h"
#include "prep/tetrahedralize/triangle_tree.h"
#include "tests/support/in_sphere.h"
#include "tests/support/mesh_files.h"
#include "tests/support/scratch.h"
#include "tests/support/watched.h"

static char path_before[8192];

/* The worker lies in libexec; a folder of its own comes before, for workers that misbehave. */
static void set_path(const char *first) {
    char path[16384];
    const char *build = getenv("LEAFCAST_BUILD");
    snprintf(path, sizeof path, "%s:%s/libexec:%s", first, build ? build : "build/release",
             path_before);
    setenv("PATH", path, 1);
}

static void need_tetgen(void) {
    char program[SIBLING_PATH];
    set_path("/nonexistent");
    if (!sibling_find("leafcast-tetgen", program)) {
        print_message("# no TetGen here\n");
        skip();
    }
}

static double random_unit(uint64_t *seed) {
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(*seed >> 40) / (double)(1 << 24);
}

/* ---- running it ---- */

static const tetrahedralize_options standard = {.ratio = 2, .seconds = 60, .threads = 2};

static status run(const char *input, tetrahedralize_options how, tetrahedralize_report *report) {
    mem m;
    mem_init(&m, how.memory);
    const size_t files = scratch_count();
    how.input = input;
    how.output = scratch_path("out.mesh");
    how.force = true;
    (void)remove(how.output);
    const status st = tetrahedralize(&m, &how, NULL, report);
    assert_int_equal(mem_used(&m), 0);
    if (st != ST_OK)
        assert_true(scratch_count() <= files); /* nothing half-written is left */
    return st;
}

static const mesh_copy *good(const char *input, tetrahedralize_options how,
                             tetrahedralize_report *report) {
    if (run(input, how, report) != ST_OK)
        fail_msg("%s", status_text());
    const mesh_copy *a = mesh_files_good(scratch_path("out.mesh"), NULL);
    assert_int_equal(a->report.points, report->points);
    assert_int_equal(a->report.tets, report->tets);
    assert_string_equal(a->report.field, report->field);
    return a;
}

static void refused(const char *input, tetrahedralize_options how, status want, const char *said) {
    tetrahedralize_report report;
    const status st = run(input, how, &report);
    if (st != want || !strstr(status_text(), said))
        fail_msg("%s: %d \"%s\", not %d \"%s\"", input, (int)st, status_text(), (int)want, said);
}

/* ---- Delaunay ---- */

/* Every tet has a volume, no point is inside its sphere, and together they fill the hull. */
static void check_delaunay(const mesh_copy *a, double six_hull) {
    __int128 sum = 0;
    for (size_t t = 0; t < a->report.tets; t++) {
        const float *p[4];
        for (int c = 0; c < 4; c++)
            p[c] = a->xyz[a->tets[t][c]];
        const __int128 volume = in_sphere_volume(p[0], p[1], p[2], p[3]);
        assert_true(volume != 0);
        sum += volume > 0 ? volume : -volume;
        for (size_t i = 0; i < a->report.points; i++)
            if (in_sphere(p[0], p[1], p[2], p[3], a->xyz[i]) > 0)
                fail_msg("point %zu is inside the sphere of tet %zu", i, t);
    }
    assert_true((double)sum == six_hull);
    assert_true(mesh_files_closed(a));
}

/* The corners of a cube and points in it, as whole numbers; a value each. */
static const char *write_cloud(int points, int size, uint64_t seed) {
    char *text = malloc((size_t)(points + 10) * 60);
    int n = sprintf(text, "x,y,z,heat\n");
    for (int i = 0; i < 8 + points; i++) {
        int p[3];
        for (int k = 0; k < 3; k++)
            p[k] = i < 8 ? (i >> k & 1) * size : (int)(random_unit(&seed) * size);
        n += sprintf(text + n, "%d,%d,%d,%d\n", p[0], p[1], p[2], i % 977);
    }
    const char *path = scratch_text("cloud.csv", text);
    free(text);
    return path;
}

static void test_in_sphere(void **state) {
    (void)state;
    skip_under_thread();
    const float p[6][3] = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0, 0, 4}, {4, 4, 4}, {1, 1, 1}};
    const float far[3] = {-1, 0, 0};
    assert_int_equal(in_sphere(p[0], p[1], p[2], p[3], p[4]), 0);
    assert_int_equal(in_sphere(p[0], p[1], p[2], p[3], p[5]), 1);
    assert_int_equal(in_sphere(p[1], p[0], p[2], p[3], p[5]), 1);
    assert_int_equal(in_sphere(p[0], p[1], p[2], p[3], far), -1);
    assert_int_equal(in_sphere(p[1], p[0], p[2], p[3], far), -1);
    assert_true(in_sphere_volume(p[0], p[1], p[2], p[3]) == 64);
}

static void test_delaunay(void **state) {
    (void)state;
    skip_under_thread();
    need_tetgen();
    tetrahedralize_report r;
    for (uint64_t seed = 1; seed <= 3; seed++) {
        print_message("# seed %d\n", (int)seed);
        const int size = 1 << 20;
        const mesh_copy *a = good(write_cloud(500, size, seed), standard, &r);
        check_delaunay(a, 6.0 * size * size * (double)size);
        assert_string_equal(r.field, "heat");
        for (size_t i = 0; i < r.points; i++)
            assert_true(a->values[i] == (float)(i % 977));
        assert_false(r.surface);
        assert_int_equal(r.unused + r.flat, 0);
        assert_true(fabs(r.volume / pow(size, 3) - 1) < 1e-12);
    }
    /* Many points on common spheres, many twice: a lattice of 5^3 from 600 points. */
    const mesh_copy *a = good(write_cloud(600, 4, 7), standard, &r);
    assert_int_equal(r.points + r.cleaned.welded, 608);
    check_delaunay(a, 6 * 64);
}

/* ---- surfaces ---- */

/* A torus of n x n/2 quads, cut in two; turned around z by an angle, so that nothing is aligned. */
static const char *write_torus(const char *name, int n, double x, bool open) {
    char *text = malloc((size_t)n * (size_t)n * 200 + 200);
    const int m = n / 2, faces = 2 * n * m - open;
    int at = sprintf(text, "OFF\n%d %d 0\n", n * m, faces), written = 0;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < m; j++) {
            const double u = 0.1 + 2 * 3.14159265 * i / n, v = 2 * 3.14159265 * j / m;
            at += sprintf(text + at, "%.9g %.9g %.9g\n", x + (2 + 0.7 * cos(v)) * cos(u),
                          (2 + 0.7 * cos(v)) * sin(u), 0.7 * sin(v));
        }
    for (int i = 0; i < n; i++)
        for (int j = 0; j < m; j++) {
            const int p = i * m + j, q = (i + 1) % n * m + j;
            const int r = (i + 1) % n * m + (j + 1) % m, s = i * m + (j + 1) % m;
            at += sprintf(text + at, "3 %d %d %d\n", p, q, r);
            if (++written < faces)
                at += sprintf(text + at, "3 %d %d %d\n", p, r, s);
            written++;
        }
    const char *path = scratch_text(name, text);
    free(text);
    return path;
}

/* What a closed surface of triangles encloses, by the divergence theorem. */
static double enclosed(const char *path) {
    mem m;
    plc x;
    mem_init(&m, 0);
    assert_int_equal(plc_read(&m, path, NULL, &x), ST_OK);
    double six = 0;
    const uint32_t *c = x.corners.data;
    for (size_t f = 0; f < x.facets.count; f++, c += 3) {
        const double *p = plc_point(&x, c[0]), *q = plc_point(&x, c[1]), *r = plc_point(&x, c[2]);
        six += p[0] * (q[1] * r[2] - q[2] * r[1]) + p[1] * (q[2] * r[0] - q[0] * r[2]) +
               p[2] * (q[0] * r[1] - q[1] * r[0]);
    }
    plc_release(&x);
    return fabs(six) / 6;
}

static double distance_to(const float (*xyz)[3], const uint32_t t[3], const float p[3]);

/* The faces that one tet alone has. */
static size_t boundary(const mesh_copy *a, uint32_t (*out)[3]) {
    static const int face[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
    size_t n = 0;
    for (size_t t = 0; t < a->report.tets; t++)
        for (int f = 0; f < 4; f++) {
            bool alone = true;
            const uint32_t *tet = a->tets[t];
            for (size_t u = 0; u < a->report.tets && alone; u++) {
                int common = 0;
                for (int c = 0; c < 3 && u != t; c++)
                    for (int d = 0; d < 4; d++)
                        common += a->tets[u][d] == tet[face[f][c]];
                alone = common < 3;
            }
            for (int c = 0; c < 3 && alone; c++)
                out[n][c] = tet[face[f][c]];
            n += alone;
        }
    return n;
}

static void test_torus(void **state) {
    (void)state;
    need_tetgen();
    tetrahedralize_report r;
    tetrahedralize_options how = standard;
    how.max_volume = 0.02;
    how.meshing = true;
    const char *path = write_torus("torus.off", 16, 0, false);
    const mesh_copy *a = good(path, how, &r);
    assert_true(r.surface);
    assert_int_equal(r.points_in, 128);
    assert_true(r.points > 128 && r.tets > 700);
    assert_true(fabs(r.volume / enclosed(path) - 1) < 1e-6);
    assert_true(mesh_files_closed(a));
    double all, sum = mesh_files_volume(a, &all);
    assert_true(fabs(fabs(sum) - all) < 1e-12 * all);
    assert_int_equal(r.flat + r.unused, 0);
    /* Exact distances to the surface. */
    static uint32_t faces[20000][3];
    const size_t n = boundary(a, faces);
    assert_true(n >= 256 && n < 20000);
    double most = 0;
    for (size_t i = 0; i < r.points; i++) {
        double least = INFINITY;
        for (size_t f = 0; f < n; f++)
            least = fmin(least, distance_to((const float(*)[3])a->xyz, faces[f], a->xyz[i]));
        if (!(fabs((double)a->values[i] - least) < 1e-6))
            fail_msg("point %zu: %g, not %g", i, (double)a->values[i], least);
        most = fmax(most, least);
    }
    for (size_t f = 0; f < n; f++)
        for (int c = 0; c < 3; c++)
            assert_true(a->values[faces[f][c]] == 0);
    assert_true(most > 0.4);
    /* The same whatever the threads. */
    mesh_copy *kept = mesh_files_keep(a);
    how.threads = 1;
    mesh_files_same(kept, good(path, how, &r));
    free(kept);
}

static double to_segment(const double a[3], const double b[3], const double p[3]) {
    double along = 0, length = 0, square = 0;
    for (int k = 0; k < 3; k++) {
        along += (b[k] - a[k]) * (p[k] - a[k]);
        length += (b[k] - a[k]) * (b[k] - a[k]);
    }
    const double t = length > 0 ? fmin(1, fmax(0, along / length)) : 0;
    for (int k = 0; k < 3; k++)
        square += pow(p[k] - a[k] - t * (b[k] - a[k]), 2);
    return sqrt(square);
}

static void cross(const double a[3], const double b[3], const double c[3], double out[3]) {
    for (int k = 0; k < 3; k++) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        out[k] = (b[i] - a[i]) * (c[j] - a[j]) - (b[j] - a[j]) * (c[i] - a[i]);
    }
}

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The nearest of the edges, or the plane where p is seen between them: by other formulas than the
 * tree's. */
static double distance_to(const float (*xyz)[3], const uint32_t t[3], const float p[3]) {
    double q[4][3], n[3], side[3];
    for (int k = 0; k < 3; k++) {
        for (int c = 0; c < 3; c++)
            q[c][k] = (double)xyz[t[c]][k];
        q[3][k] = (double)p[k];
    }
    double least = INFINITY;
    bool inside = true;
    cross(q[0], q[1], q[2], n);
    for (int c = 0; c < 3; c++) {
        least = fmin(least, to_segment(q[c], q[(c + 1) % 3], q[3]));
        cross(q[c], q[(c + 1) % 3], q[3], side);
        inside = inside && dot(side, n) > 0;
    }
    const double area = sqrt(dot(n, n));
    for (int k = 0; k < 3; k++)
        side[k] = q[3][k] - q[0][k];
    return inside && area > 1e-12 ? fmin(least, fabs(dot(side, n)) / area) : least;
}

/* A cube of side 3 around one of side 1: three ways to say what is inside; facets as quads. */
static const char *write_cubes(bool hole, bool field) {
    static const int quads[6][4] = {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                    {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}};
    char text[4096];
    int n = sprintf(text, "16 3 %d 0\n", field);
    for (int i = 0; i < 16; i++) {
        const double lo = i < 8 ? 0 : 1, size = i < 8 ? 3 : 1;
        n += sprintf(text + n, "%d %g %g %g", i, lo + (i & 1) * size, lo + (i >> 1 & 1) * size,
                     lo + (i >> 2 & 1) * size);
        n += sprintf(text + n, field ? " %g\n" : "\n", 10 + lo + (i & 1) * size);
    }
    n += sprintf(text + n, "12 0\n");
    for (int i = 0; i < 12; i++) {
        const int *q = quads[i % 6], base = i / 6 * 8;
        n += sprintf(text + n, "1\n4 %d %d %d %d\n", q[0] + base, q[1] + base, q[2] + base,
                     q[3] + base);
    }
    sprintf(text + n, hole ? "1\n0 1.5 1.5 1.5\n" : "0\n");
    return scratch_text("cubes.poly", text);
}

static void test_cubes(void **state) {
    (void)state;
    skip_under_thread();
    need_tetgen();
    tetrahedralize_report r;
    tetrahedralize_options how = standard;
    good(write_cubes(false, false), how, &r);
    assert_true(fabs(r.volume - 27) < 1e-5);
    good(write_cubes(true, false), how, &r);
    assert_true(fabs(r.volume - 26) < 1e-5);
    assert_string_equal(r.field, "distance");
    /* A field of the surface, 10 + x, which is linear on every face. */
    how.field = "attr1";
    how.max_volume = 0.05;
    how.meshing = true;
    const mesh_copy *a = good(write_cubes(true, true), how, &r);
    assert_string_equal(r.field, "attr1");
    size_t inside = 0, exact = 0;
    for (size_t i = 0; i < r.points; i++) {
        const float *p = a->xyz[i];
        const float nearest[2] = {fminf(fminf(p[0], p[1]), p[2]), fmaxf(fmaxf(p[0], p[1]), p[2])};
        const bool on = nearest[0] == 0 || nearest[1] == 3;
        if (on)
            assert_true(fabsf(a->values[i] - 10 - p[0]) < 1e-5f);
        exact += on;
        inside += !on;
        assert_true(a->values[i] >= 10 && a->values[i] <= 13);
    }
    assert_true(inside > 100 && exact > 100);
    /* An inner wall is no hole; tets are cut at it, and distances count from it. */
    how.field = NULL;
    a = good(write_cubes(false, true), how, &r);
    assert_string_equal(r.field, "distance");
    for (size_t i = 0; i < r.points; i++)
        assert_true(a->values[i] <= 1.001f);
}

static void test_points_of_surface(void **state) {
    (void)state;
    skip_under_thread();
    need_tetgen();
    tetrahedralize_report r;
    tetrahedralize_options how = standard;
    how.points = true;
    good(write_cubes(false, true), how, &r);
    assert_false(r.surface);
    assert_int_equal(r.points, 16);
    assert_true(fabs(r.volume - 27) < 1e-5);
    assert_string_equal(r.field, "attr1");
}

/* ---- the tree of triangles ---- */

static void test_nearest(void **state) {
    (void)state;
    skip_under_thread();
    enum { TRIANGLES = 300, POINTS = 3 * TRIANGLES };
    static float xyz[POINTS][3];
    static uint32_t corners[TRIANGLES][3];
    uint64_t seed = 5;
    mem m;
    mem_init(&m, 0);
    for (int i = 0; i < POINTS; i++)
        for (int k = 0; k < 3; k++)
            xyz[i][k] = (float)(random_unit(&seed) + (k == 0 ? i / 3 % 7 : 0));
    for (uint32_t i = 0; i < POINTS; i++)
        corners[i / 3][i % 3] = i % 50 ? i : i / 3 * 3; /* some are flat */
    for (size_t count = 1; count <= TRIANGLES; count += count < 20 ? 1 : 93) {
        triangle_tree *t;
        assert_int_equal(triangle_tree_build(&m, (const float(*)[3])xyz,
                                             (const uint32_t(*)[3])corners, count, &t),
                         ST_OK);
        for (int i = 0; i < 20; i++) {
            float p[3], foot[3] = {0};
            for (int k = 0; k < 3; k++)
                p[k] = (float)(3 * random_unit(&seed) - 1);
            const triangle_near near = triangle_tree_nearest(t, p);
            double least = INFINITY, square = 0;
            for (size_t f = 0; f < count; f++)
                least = fmin(least, distance_to((const float(*)[3])xyz, corners[f], p));
            assert_true(fabs(near.distance - least) < 1e-6);
            for (int k = 0; k < 3; k++) {
                for (int c = 0; c < 3; c++)
                    foot[k] += (float)near.weight[c] * xyz[corners[near.triangle][c]][k];
                square += pow((double)foot[k] - (double)p[k], 2);
            }
            assert_true(fabs(sqrt(square) - near.distance) < 1e-5);
        }
        for (size_t f = 0; f < count; f++)
            assert_true(triangle_tree_nearest(t, xyz[corners[f][f % 3]]).distance == 0);
        triangle_tree_free(t);
    }
    assert_int_equal(mem_used(&m), 0);
}

/* ---- failures ---- */

static void test_refused_points(void **state) {
    (void)state;
    skip_under_thread();
    need_tetgen();
    refused(scratch_text("p.csv", "0 0 0\n1 0 0\n0 1 0\n"), standard, ST_CORRUPT,
            "p.csv: 3 different points, expected 4 or more");
    refused(scratch_text("p.csv", "0 0 5\n1 0 5\n0 1 5\n2 2 5\n"), standard, ST_CORRUPT,
            "p.csv: all 4 points lie in one plane");
    refused(scratch_text("p.csv", "0 0 5\n1 0 nan\n"), standard, ST_CORRUPT,
            "p.csv: line 2: point 1 (counted from 0): z is nan");
    tetrahedralize_options how = standard;
    how.meshing = true;
    const char *cloud = write_cloud(10, 100, 3);
    refused(cloud, how, ST_USAGE, "--quality and --max-volume are of surfaces");
    how = standard;
    how.field = "distance";
    refused(cloud, how, ST_USAGE, "the distance is of surfaces");
    how.field = "cold";
    refused(cloud, how, ST_UNSUPPORTED, "no field \"cold\"");
    how = standard;
    how.memory = 8 << 20;
    refused(cloud, how, ST_NOMEM, "18 points need about 64 MiB, expected at most 8 MiB");
}

static const char *write_crossing(void) {
    char *one = scratch_read(write_torus("a.off", 16, 0, false), NULL);
    char *two = scratch_read(write_torus("b.off", 16, 0.5, false), NULL);
    char *text = malloc(1 << 20);
    int n = sprintf(text, "OFF\n256 512 0\n");
    const char *start = strchr(strchr(one, '\n') + 1, '\n') + 1, *faces = strstr(start, "\n3 ") + 1;
    n += sprintf(text + n, "%.*s", (int)(faces - start), start);
    const char *start2 = strchr(strchr(two, '\n') + 1, '\n') + 1;
    const char *faces2 = strstr(start2, "\n3 ") + 1;
    n += sprintf(text + n, "%.*s%s", (int)(faces2 - start2), start2, faces);
    for (const char *line = faces2; *line; line = strchr(line, '\n') + 1) {
        int a, b, c;
        assert_int_equal(sscanf(line, "3 %d %d %d", &a, &b, &c), 3);
        n += sprintf(text + n, "3 %d %d %d\n", a + 128, b + 128, c + 128);
    }
    const char *path = scratch_text("cross.off", text);
    free(one);
    free(two);
    free(text);
    return path;
}

static void test_refused_surfaces(void **state) {
    (void)state;
    skip_under_thread();
    need_tetgen();
    refused(write_torus("open.off", 16, 0, true), standard, ST_CORRUPT,
            "open.off: the surface is open: facet ");
    refused(write_crossing(), standard, ST_CORRUPT, "cross.off: the surface cuts itself: facets ");
    assert_non_null(strstr(status_text(), "(counted from 0), near ("));
    /* A .poly may have walls that end in the open, but must enclose something. */
    refused(scratch_text("open.poly",
                         "4 3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n3 0\n1\n3 1 2 3\n1\n"
                         "3 1 2 4\n1\n3 1 3 4\n0\n"),
            standard, ST_CORRUPT, "open.poly: the surface is open: facet 1 (counted from 1)");
    tetrahedralize_options how = standard;
    how.max_volume = 1e-7;
    how.meshing = true;
    how.memory = 100 << 20;
    const char *torus = write_torus("torus.off", 16, 0, false);
    refused(torus, how, ST_NOMEM, "torus.off: TetGen needs more than the ");
    how.memory = 0;
    how.seconds = 0.3;
    refused(torus, how, ST_UNSUPPORTED, "did not come to an end within 0.3 s (--timeout)");
}

/* Workers that do what TetGen may do: crash, be killed, exit, say nonsense. */
static void test_bad_workers(void **state) {
    (void)state;
    static const struct {
        const char *script;
        status st;
        const char *said;
    } cases[] = {
        {"kill -SEGV $$", ST_UNSUPPORTED, "TetGen crashed on this input"},
        {"echo first >&2; echo 'Assertion failed' >&2; kill -ABRT $$", ST_UNSUPPORTED,
         "TetGen crashed on this input: Assertion failed"},
        {"kill -KILL $$", ST_NOMEM, "was killed, as by a system short of memory"},
        {"kill -TERM $$", ST_STOPPED, "was ended by signal 15"},
        {"cat >/dev/null; exit 0", ST_FAILED, "ended with exit code 0"},
        {"echo 'what is this' >&2; exit 3", ST_FAILED, "ended with exit code 3: what is this"},
        {"exit 4", ST_NOMEM, "TetGen needs more than the "},
        {"exit 21", ST_NOMEM, "TetGen needs more than the "},
        {"exit 22", ST_UNSUPPORTED, "TetGen failed on this input"},
        {"exit 23", ST_CORRUPT, "the surface cuts itself, expected"},
        {"exit 24", ST_CORRUPT, "a detail too small to be meshed"},
        {"exit 25", ST_CORRUPT, "two facets all but on top of each other"},
        {"echo 'Error:  odd.' >&2; exit 30", ST_CORRUPT, "TetGen refuses the input: Error:  odd."},
        {"cat >/dev/null; head -c 100 /dev/zero; sleep 5", ST_FAILED, "gave no reply of its kind"},
        {"cat >/dev/null; printf LFTGREP1", ST_FAILED, "ended with exit code 0"},
        {"sleep 5", ST_UNSUPPORTED, "did not come to an end within 0.5 s"},
    };
    need_tetgen();
    tetrahedralize_options how = standard;
    how.seconds = 0.5;
    const char *cloud = write_cloud(10, 100, 3);
    char folder[4096], script[4096];
    snprintf(folder, sizeof folder, "%s", cloud);
    *strrchr(folder, '/') = 0;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        snprintf(script, sizeof script, "#!/bin/sh\n%s\n", cases[i].script);
        snprintf(script + 3000, 1000, "chmod 755 %s", scratch_text("leafcast-tetgen", script));
        assert_int_equal(system(script + 3000), 0);
        set_path(folder);
        refused(cloud, how, cases[i].st, cases[i].said);
    }
    /* A surface, unlike points, can be repaired. */
    static const struct {
        const char *script;
        status st;
        const char *said;
    } surfaces[] = {
        {"kill -SEGV $$", ST_UNSUPPORTED, "TetGen crashed on this input; `meshfix in.ply -o out'"},
        {"exit 22", ST_UNSUPPORTED, "TetGen failed on this input; `meshfix in.ply -o out'"},
        {"exit 23", ST_CORRUPT, "edges and corners alone; `meshfix in.ply -o out'"},
        {"exit 24", ST_CORRUPT, "without such places; `meshfix in.ply -o out'"},
    };
    const char *torus = write_torus("torus.off", 16, 0, false);
    for (size_t i = 0; i < sizeof surfaces / sizeof *surfaces; i++) {
        snprintf(script, sizeof script, "#!/bin/sh\n%s\n", surfaces[i].script);
        snprintf(script + 3000, 1000, "chmod 755 %s", scratch_text("leafcast-tetgen", script));
        assert_int_equal(system(script + 3000), 0);
        set_path(folder);
        refused(torus, how, surfaces[i].st, surfaces[i].said);
    }
    (void)remove(scratch_path("leafcast-tetgen"));
}

static bool stop_at_once(void *ctx) {
    return ++*(int *)ctx > 2;
}

static void test_stopped(void **state) {
    (void)state;
    need_tetgen();
    int asked = 0;
    const progress p = {.stop = stop_at_once, .ctx = &asked};
    mem m;
    mem_init(&m, 0);
    tetrahedralize_report r;
    tetrahedralize_options how = standard;
    how.input = write_torus("torus.off", 16, 0, false);
    how.max_volume = 1e-6;
    how.output = scratch_path("out.mesh");
    (void)remove(how.output);
    const size_t files = scratch_count();
    assert_int_equal(tetrahedralize(&m, &how, &p, &r), ST_STOPPED);
    assert_int_equal(mem_used(&m), 0);
    assert_int_equal(scratch_count(), files);
}

static void sweep(const char *input, fault_kind kind) {
    tetrahedralize_report r;
    long k = 0;
    for (bool fired = true; fired;) {
        fault_arm(kind, ++k);
        const status st = run(input, standard, &r);
        fired = fault_fired(kind);
        fault_arm(kind, 0);
        if (st == ST_OK) /* the folder may stay unsynced, for one */
            assert_int_equal(mesh_files_good(scratch_path("out.mesh"), NULL)->report.tets, r.tets);
        if (st != ST_OK && !fired)
            fail_msg("fault %ld of kind %d: %d \"%s\"", k, (int)kind, (int)st, status_text());
    }
    assert_true(k > 1);
}

static void test_faults(void **state) {
    (void)state;
    need_tetgen();
    const char *torus = write_torus("torus.off", 8, 0, false);
    sweep(torus, FAULT_ALLOC);
    sweep(torus, FAULT_READ);
    sweep(torus, FAULT_WRITE);
    sweep(torus, FAULT_THREAD);
}

static void test_no_worker(void **state) {
    (void)state;
    setenv("PATH", "/nonexistent", 1);
    refused(write_cloud(10, 100, 3), standard, ST_UNSUPPORTED, "leafcast-tetgen is not there");
}

int main(void) {
    snprintf(path_before, sizeof path_before, "%s", getenv("PATH") ? getenv("PATH") : "/bin");
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_in_sphere),      cmocka_unit_test(test_nearest),
        cmocka_unit_test(test_delaunay),       cmocka_unit_test(test_torus),
        cmocka_unit_test(test_cubes),          cmocka_unit_test(test_points_of_surface),
        cmocka_unit_test(test_refused_points), cmocka_unit_test(test_refused_surfaces),
        cmocka_unit_test(test_bad_workers),    cmocka_unit_test(test_stopped),
        cmocka_unit_test(test_faults),         cmocka_unit_test(test_no_worker),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
