/* The mesh that peers are given: closed, in place, the same whatever the threads. */
/* marks: threads */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "render/bench/peer_mesh.h"

enum { AXES = 3 };

/* A field that the test owns: node (i, j, k) at 2i - 3, j, 1.5k. */
static void make_field(mem *m, const uint32_t dims[AXES], peer_field *f) {
    static const double to_world[12] = {2, 0, 0, -3, 0, 1, 0, 0, 0, 0, 1.5, 0};
    *f = (peer_field){.m = m};
    for (int a = 0; a < AXES; a++) {
        f->dims[a] = dims[a];
        f->axis[a] = mem_array(m, dims[a], sizeof *f->axis[a]);
        assert_non_null(f->axis[a]);
        for (uint32_t i = 0; i < dims[a]; i++)
            f->axis[a][i] = i;
    }
    affine_init(&f->space, to_world);
    f->samples = mem_array(m, (size_t)dims[0] * dims[1] * dims[2], sizeof *f->samples);
    assert_non_null(f->samples);
}

static bool on_border(const peer_field *f, const uint32_t node[AXES]) {
    for (int a = 0; a < AXES; a++)
        if (node[a] == 0 || node[a] + 1 == f->dims[a])
            return true;
    return false;
}

/* Fill a field by a function of the node; the border is outside, so that surfaces close. */
static void fill(peer_field *f, float (*value)(const uint32_t node[AXES])) {
    uint32_t n[AXES];
    for (n[2] = 0; n[2] < f->dims[2]; n[2]++)
        for (n[1] = 0; n[1] < f->dims[1]; n[1]++)
            for (n[0] = 0; n[0] < f->dims[0]; n[0]++)
                f->samples[peer_field_at(f, n[0], n[1], n[2])] = on_border(f, n) ? -1.0f : value(n);
}

/* About every second node inside: all 256 cases, in all neighbourhoods. */
static float coin(const uint32_t node[AXES]) {
    uint32_t h = node[0] * 0x9E3779B1u ^ node[1] * 0x85EBCA77u ^ node[2] * 0xC2B2AE3Du;
    h = (h ^ h >> 15) * 0x2C1B3C6Du;
    h = (h ^ h >> 12) * 0x297A2D39u;
    return (float)((double)(h ^ h >> 15) / 4294967296.0 - 0.5);
}

/* Positive inside a ball in index space. */
static float ball(const uint32_t node[AXES]) {
    const double x = node[0] - 35.3, y = node[1] - 10.1, z = node[2] - 9.7;
    return (float)(8.0 - sqrt(x * x + y * y + z * z));
}

static int by_pair(const void *a, const void *b) {
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

/* Each edge is passed as often in one direction as in the other; returns how many edges. */
static size_t count_balanced_edges(const peer_mesh *mesh) {
    const size_t count = 3 * mesh->triangles;
    uint64_t *there = malloc(count * sizeof *there), *back = malloc(count * sizeof *back);
    assert_non_null(there);
    assert_non_null(back);
    for (size_t i = 0; i < count; i++) {
        const uint64_t a = mesh->corners[i], b = mesh->corners[i % 3 == 2 ? i - 2 : i + 1];
        assert_true(a < mesh->vertices && b < mesh->vertices && a != b);
        there[i] = a << 32 | b;
        back[i] = b << 32 | a;
    }
    qsort(there, count, sizeof *there, by_pair);
    qsort(back, count, sizeof *back, by_pair);
    assert_memory_equal(there, back, count * sizeof *there);
    free(there);
    free(back);
    return count / 2;
}

static void extract(mem *m, const peer_field *f, int threads, peer_mesh *mesh) {
    pool *workers = NULL;
    assert_int_equal(pool_create(m, threads, &workers), ST_OK);
    assert_int_equal(peer_mesh_extract(m, f, 0.0, workers, mesh), ST_OK);
    pool_destroy(workers);
}

static void random_fields_are_closed(void **state) {
    /* Rows shorter than, as long as, and longer than a word of bits. */
    static const uint32_t dims[][AXES] = {{2, 9, 9},  {17, 12, 11}, {64, 9, 7},
                                          {65, 8, 9}, {66, 7, 8},   {130, 6, 7}};
    (void)state;
    for (size_t i = 0; i < sizeof dims / sizeof *dims; i++) {
        mem m;
        peer_field f;
        peer_mesh mesh;
        mem_init(&m, 0);
        make_field(&m, dims[i], &f);
        fill(&f, coin);
        extract(&m, &f, 2, &mesh);
        if (dims[i][0] > 2)
            assert_true(mesh.triangles > 1000);
        else
            assert_int_equal(mesh.triangles, 0);
        count_balanced_edges(&mesh);
        peer_mesh_release(&mesh);
        peer_field_release(&f);
        assert_int_equal(mem_used(&m), 0);
    }
}

static void ball_is_a_ball(void **state) {
    static const uint32_t dims[AXES] = {70, 21, 20};
    mem m;
    peer_field f;
    peer_mesh mesh;
    (void)state;
    mem_init(&m, 0);
    make_field(&m, dims, &f);
    fill(&f, ball);
    extract(&m, &f, 1, &mesh);
    const size_t edges = count_balanced_edges(&mesh);
    assert_int_equal(mesh.vertices + mesh.triangles - edges, 2); /* Euler */
    for (size_t v = 0; v < mesh.vertices; v++) {
        /* Back in index space, about the ball's middle. */
        const double x = (mesh.positions[3 * v] + mesh.origin[0] + 3.0) / 2.0 - 35.3;
        const double y = mesh.positions[3 * v + 1] + mesh.origin[1] - 10.1;
        const double z = (mesh.positions[3 * v + 2] + mesh.origin[2]) / 1.5 - 9.7;
        assert_true(fabs(sqrt(x * x + y * y + z * z) - 8.0) < 0.02);
        /* Normals point outwards: gradients of world space. */
        const double gradient[AXES] = {x / 2.0, y, z / 1.5};
        double along = 0.0, square = 0.0, unit = 0.0;
        for (int a = 0; a < AXES; a++) {
            const double n = mesh.normals[3 * v + a];
            along += n * gradient[a];
            square += gradient[a] * gradient[a];
            unit += n * n;
        }
        assert_true(fabs(unit - 1.0) < 1e-5);
        assert_true(along / sqrt(square) > 0.995);
    }
    peer_mesh_release(&mesh);
    peer_field_release(&f);
}

static void threads_do_not_matter(void **state) {
    static const uint32_t dims[AXES] = {67, 19, 23};
    mem m;
    peer_field f;
    peer_mesh one, three;
    (void)state;
    mem_init(&m, 0);
    make_field(&m, dims, &f);
    fill(&f, coin);
    extract(&m, &f, 1, &one);
    extract(&m, &f, 3, &three);
    assert_int_equal(one.vertices, three.vertices);
    assert_int_equal(one.triangles, three.triangles);
    assert_memory_equal(one.positions, three.positions, 12 * one.vertices);
    assert_memory_equal(one.normals, three.normals, 12 * one.vertices);
    assert_memory_equal(one.corners, three.corners, 12 * one.triangles);
    peer_mesh_release(&one);
    peer_mesh_release(&three);
    peer_field_release(&f);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(random_fields_are_closed),
                                       cmocka_unit_test(ball_is_a_ball),
                                       cmocka_unit_test(threads_do_not_matter)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
