#include "tests/support/surface_movie.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/surface/surface_readers.h"
#include "prep/mesh/triangle_treelet.h"
#include "tests/support/fields.h"
#include "tests/support/naive_surface.h"
#include "tests/support/scratch.h"

enum { LEFT_OUT = 2 };

/* ---- making ---- */

static void *room(size_t count, size_t size) {
    void *bytes = calloc(count, size);
    assert_non_null(bytes);
    return bytes;
}

static void place_points(surface_movie *v, uint32_t side, field_random *r) {
    for (uint32_t i = 0; i < v->points; i++) {
        const double x = i % (side + 1), y = i / (side + 1), jitter = field_random_in(r, 0.0, 0.3);
        for (uint32_t s = 0; s < v->steps; s++) {
            const double z = sin(0.1 * x) * cos(0.07 * y + (v->moves ? 0.2 * s : 0.0)) + jitter;
            v->xyz[s][i][0] = (float)x;
            v->xyz[s][i][1] = (float)y;
            v->xyz[s][i][2] = (float)z;
            for (uint32_t f = 0; f < v->fields; f++)
                v->values[s][f][i] = i % 97 == 5 ? NAN : (float)(x * y + 3.0 * f + 0.25 * s);
        }
    }
    /* Point 3 lies between 2 and 4, exactly. */
    for (uint32_t s = 0; s < v->steps; s++)
        for (uint32_t i = 2; i <= 4; i++)
            memcpy(v->xyz[s][i], (float[3]){(float)i, 0.0F, 0.0F}, sizeof(float[3]));
}

static void make_triangles(surface_movie *v, uint32_t side, field_random *r) {
    uint32_t n = 0;
    for (uint32_t y = 0; y < side; y++)
        for (uint32_t x = 0; x < side; x++) {
            const uint32_t a = y * (side + 1) + x, b = a + 1, c = a + side + 1, d = c + 1;
            memcpy(v->corner[n++], (uint32_t[3]){a, b, d}, sizeof v->corner[0]);
            memcpy(v->corner[n++], (uint32_t[3]){d, c, a}, sizeof v->corner[0]);
        }
    memcpy(v->corner[n++], (uint32_t[3]){2, 3, 4}, sizeof v->corner[0]);
    assert_int_equal(n, v->triangles);
    for (uint32_t i = n - 1; i > 0; i--) {
        uint32_t kept[3];
        const uint32_t k = (uint32_t)field_random_below(r, i + 1);
        memcpy(kept, v->corner[i], sizeof kept);
        memcpy(v->corner[i], v->corner[k], sizeof kept);
        memcpy(v->corner[k], kept, sizeof kept);
    }
}

static void write_face(FILE *f, const uint32_t corner[3]) {
    assert_int_equal(fputc(3, f), 3);
    assert_int_equal(fwrite(corner, sizeof *corner, 3, f), 3);
}

void surface_movie_normal(const surface_movie *v, uint32_t step, uint32_t point, float normal[3]) {
    const float about = (float)(point % 31) - 15.0F;
    (void)v;
    normal[0] = about;
    normal[1] = (float)step - 1.5F;
    normal[2] = 5.0F;
    if (point % 50 == 7)
        normal[0] = normal[1] = normal[2] = 0.0F;
}

static const char *write_step(const surface_movie *v, uint32_t step, const char *name) {
    char text[64];
    snprintf(text, sizeof text, "%s%u.ply", name, step);
    const char *path = strdup(scratch_path(text));
    FILE *f = fopen(path, "wb");
    assert_non_null(f);
    fprintf(f, "ply\nformat binary_little_endian 1.0\nelement vertex %u\n", v->points);
    fprintf(f, "property float x\nproperty float y\nproperty float z\n");
    if (v->normals)
        fprintf(f, "property float nx\nproperty float ny\nproperty float nz\n");
    for (uint32_t k = 0; k < v->fields; k++)
        fprintf(f, "property float f%u\n", k);
    fprintf(f, "element face %u\nproperty list uchar uint vertex_indices\nend_header\n",
            v->triangles + LEFT_OUT);
    for (uint32_t i = 0; i < v->points; i++) {
        float normal[3];
        assert_int_equal(fwrite(v->xyz[step][i], sizeof(float), 3, f), 3);
        surface_movie_normal(v, step, i, normal);
        assert_int_equal(fwrite(normal, sizeof(float), v->normals ? 3 : 0, f), v->normals ? 3 : 0);
        for (uint32_t k = 0; k < v->fields; k++)
            assert_int_equal(fwrite(&v->values[step][k][i], sizeof(float), 1, f), 1);
    }
    write_face(f, (uint32_t[3]){7, 8, 7});
    for (uint32_t i = 0; i < v->triangles; i++)
        write_face(f, v->corner[i]);
    write_face(f, (uint32_t[3]){0, 1, v->points});
    assert_int_equal(fclose(f), 0);
    return path;
}

surface_movie surface_movie_make(uint32_t side, uint32_t fields, uint32_t steps, bool moves,
                                 const char *name) {
    static const char *const names[] = {"f0", "f1"};
    field_random r = {FIELD_SEED};
    surface_movie v = {.points = (side + 1) * (side + 1),
                       .triangles = 2 * side * side + 1,
                       .fields = fields,
                       .steps = steps,
                       .moves = moves,
                       .options = mesh_options_default()};
    v.corner = room(v.triangles, sizeof *v.corner);
    for (uint32_t s = 0; s < steps; s++) {
        v.xyz[s] = room(v.points, sizeof *v.xyz[s]);
        for (uint32_t f = 0; f < fields; f++)
            v.values[s][f] = room(v.points, sizeof *v.values[s][f]);
    }
    place_points(&v, side, &r);
    make_triangles(&v, side, &r);
    for (uint32_t s = 0; s < steps; s++)
        v.paths[s] = write_step(&v, s, name);
    v.series = (mesh_series){
        .of = {.sets = {.fields = fields, .steps = steps, .names = names}, .fields = names},
        .readers = &surface_readers};
    v.options.cells = &triangle_treelets;
    v.options.force = true;
    v.options.treelet_tets = 100;
    v.options.threads = 2;
    return v;
}

void surface_movie_give_normals(surface_movie *v, const char *name) {
    v->normals = true;
    for (uint32_t s = 0; s < v->steps; s++) {
        free((void *)(uintptr_t)v->paths[s]);
        v->paths[s] = write_step(v, s, name);
    }
}

void surface_movie_release(surface_movie *v) {
    for (uint32_t s = 0; s < v->steps; s++) {
        free((void *)(uintptr_t)v->paths[s]);
        free(v->xyz[s]);
        for (uint32_t f = 0; f < v->fields; f++)
            free(v->values[s][f]);
    }
    free(v->corner);
}

/* ---- converting ---- */

status surface_movie_convert(mem *m, const surface_movie *v, const char *path, const progress *p,
                             bool dry, mesh_result *r) {
    mesh_series series = v->series;
    mesh_options o = v->options;
    mesh_input *x = NULL;
    series.of.paths = v->paths;
    o.series = &series;
    mem_init(m, (size_t)o.memory);
    status st = surface_input_open(m, v->paths[0], &series.hints, &x);
    if (st == ST_OK)
        st = dry ? mesh_convert_dry(m, x, &o, p, r) : mesh_convert_run(m, x, path, &o, p, r);
    mesh_input_close(x);
    assert_int_equal(mem_used(m), 0);
    return st;
}

/* ---- checking ---- */

/* All that is known of a corner: places at all steps, values of all sets. */
enum { EACH = SURFACE_MOVIE_STEPS * (3 + SURFACE_MOVIE_FIELDS), TUPLE = 3 * EACH };

typedef float tuple[TUPLE];

static int by_bits(const void *a, const void *b) {
    return memcmp(a, b, sizeof(tuple));
}

static tuple *tuples_of_movie(const surface_movie *v) {
    tuple *all = room(v->triangles, sizeof *all);
    for (uint32_t i = 0; i < v->triangles; i++)
        for (int k = 0; k < 3; k++) {
            float *to = all[i] + k * EACH;
            const uint32_t n = v->corner[i][k];
            for (uint32_t s = 0; s < v->steps; s++) {
                memcpy(to, v->xyz[s][n], sizeof(float[3]));
                to += 3;
                for (uint32_t f = 0; f < v->fields; f++)
                    *to++ = v->values[s][f][n];
            }
        }
    return all;
}

static void put_corner(const naive_surface *n, const naive_patch *p, long v, float *to) {
    for (long s = 0; s < n->steps; s++) {
        const float *xyz = p->xyz + (n->places > 1 ? s : 0) * 3 * p->vertices;
        for (long a = 0; a < 3; a++)
            *to++ = xyz[a * p->vertices + v];
        for (long f = 0; f < n->fields; f++)
            *to++ = p->values[(f * n->steps + s) * p->vertices + v];
    }
}

static tuple *tuples_of_file(const naive_surface *n) {
    tuple *all = room((size_t)n->triangles, sizeof *all), *to = all;
    for (long t = 0; t < n->treelets; t++)
        for (long i = 0; i < n->patch[t].triangles; i++, to++)
            for (int k = 0; k < 3; k++)
                put_corner(n, &n->patch[t], n->patch[t].row[i][k], *to + k * EACH);
    return all;
}

void surface_movie_check(const surface_movie *v, const char *path) {
    naive_surface n;
    if (!naive_surface_load(&n, path))
        fail_msg("%s: %s", path, n.why);
    assert_int_equal(n.triangles, v->triangles);
    assert_int_equal(n.vertices, v->points);
    assert_int_equal(n.fields, v->fields);
    assert_int_equal(n.steps, v->steps);
    assert_int_equal(n.places, v->moves ? v->steps : 1);
    tuple *want = tuples_of_movie(v), *got = tuples_of_file(&n);
    qsort(want, v->triangles, sizeof *want, by_bits);
    qsort(got, v->triangles, sizeof *got, by_bits);
    assert_memory_equal(want, got, v->triangles * sizeof *want);
    free(want);
    free(got);
    naive_surface_release(&n);
}
