#include "tests/support/ply_surface.h"

#include <setjmp.h>
#include <stdarg.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void *room(size_t count, size_t size) {
    void *block = calloc(count ? count : 1, size);
    assert_non_null(block);
    return block;
}

static size_t count_of(const char *bytes, const char *element) {
    const char *at = strstr(bytes, element);
    assert_non_null(at);
    return (size_t)strtoull(at + strlen(element), NULL, 10);
}

static const char *read_vertices(ply_surface *s, const char *from, bool doubles, bool isovalues) {
    for (size_t v = 0; v < s->vertices; v++) {
        for (int a = 0; a < 3; a++) {
            float single;
            memcpy(doubles ? (void *)&s->at[v][a] : &single, from, doubles ? 8 : 4);
            if (!doubles)
                s->at[v][a] = (double)single;
            from += doubles ? 8 : 4;
        }
        memcpy(s->normal[v], from, 12);
        from += 12;
        if (isovalues) {
            memcpy(&s->isovalue[v], from, 8);
            from += 8;
        }
    }
    return from;
}

ply_surface ply_surface_read(const char *bytes, size_t size) {
    const char *end = strstr(bytes, "end_header\n");
    assert_non_null(end);
    assert_memory_equal(bytes, "ply\nformat binary_little_endian 1.0\n", 36);
    const bool doubles = strstr(bytes, "property double x\nproperty double y\nproperty double z\n");
    const char *isovalue = strstr(bytes, "property double isovalue\n");
    ply_surface s = {.vertices = count_of(bytes, "element vertex "),
                     .triangles = count_of(bytes, "element face ")};
    s.at = room(s.vertices, sizeof *s.at);
    s.normal = room(s.vertices, sizeof *s.normal);
    s.corner = room(s.triangles, sizeof *s.corner);
    if (isovalue && isovalue < end)
        s.isovalue = room(s.vertices, sizeof *s.isovalue);
    const char *from = read_vertices(&s, end + 11, doubles, s.isovalue != NULL);
    for (size_t t = 0; t < s.triangles; t++) {
        assert_int_equal(*from, 3);
        memcpy(s.corner[t], from + 1, 12);
        from += 13;
        for (int i = 0; i < 3; i++)
            assert_true(s.corner[t][i] < s.vertices);
    }
    assert_ptr_equal(from, bytes + size);
    return s;
}

void ply_surface_release(ply_surface *s) {
    free(s->at);
    free(s->normal);
    free(s->isovalue);
    free(s->corner);
}

static int by_number(const void *a, const void *b) {
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

static uint64_t *sorted_sides(const ply_surface *s) {
    uint64_t *sides = room(3 * s->triangles, sizeof *sides);
    for (size_t t = 0; t < s->triangles; t++)
        for (int i = 0; i < 3; i++)
            sides[3 * t + (size_t)i] = (uint64_t)s->corner[t][i] << 32 | s->corner[t][(i + 1) % 3];
    qsort(sides, 3 * s->triangles, sizeof *sides, by_number);
    return sides;
}

ply_sides ply_surface_sides(const ply_surface *s) {
    const size_t count = 3 * s->triangles;
    uint64_t *sides = sorted_sides(s);
    ply_sides r = {.rim = room(count, sizeof *r.rim)};
    for (size_t i = 0; i < count; i++) {
        const uint64_t back = sides[i] << 32 | sides[i] >> 32;
        r.repeated += i > 0 && sides[i] == sides[i - 1];
        const bool both = bsearch(&back, sides, count, sizeof *sides, by_number) != NULL;
        r.sides += !both || sides[i] < back;
        if (both)
            continue;
        r.rim[r.open][0] = (uint32_t)(sides[i] >> 32);
        r.rim[r.open++][1] = (uint32_t)sides[i];
    }
    free(sides);
    return r;
}

long ply_surface_euler(const ply_surface *s) {
    bool *used = room(s->vertices, sizeof *used);
    size_t count = 0;
    for (size_t t = 0; t < s->triangles; t++)
        for (int i = 0; i < 3; i++) {
            count += !used[s->corner[t][i]];
            used[s->corner[t][i]] = true;
        }
    free(used);
    assert_int_equal(count, s->vertices);
    ply_sides r = ply_surface_sides(s);
    free(r.rim);
    return (long)s->vertices - (long)r.sides + (long)s->triangles;
}

/* Around each vertex, the sides opposite to it make one path or one ring: as many of them as there
 * are vertices on them, or one less, and all joined. */
size_t ply_surface_fans(const ply_surface *s) {
    size_t *first = room(s->vertices + 1, sizeof *first), bad = 0;
    for (size_t t = 0; t < s->triangles; t++)
        for (int i = 0; i < 3; i++)
            first[s->corner[t][i] + 1]++;
    for (size_t v = 0; v < s->vertices; v++)
        first[v + 1] += first[v];
    size_t *at = room(s->vertices, sizeof *at);
    uint32_t(*around)[2] = room(3 * s->triangles, sizeof *around);
    for (size_t t = 0; t < s->triangles; t++)
        for (int i = 0; i < 3; i++) {
            const uint32_t v = s->corner[t][i];
            around[first[v] + at[v]][0] = s->corner[t][(i + 1) % 3];
            around[first[v] + at[v]++][1] = s->corner[t][(i + 2) % 3];
        }
    for (size_t v = 0; v < s->vertices; v++) {
        const size_t count = first[v + 1] - first[v];
        uint32_t(*fan)[2] = around + first[v];
        /* From one that none leads to, if there is any, on and on. */
        size_t begin = 0, seen = 1;
        for (size_t i = 0; i < count; i++) {
            bool led = false;
            for (size_t k = 0; k < count; k++)
                led |= fan[k][1] == fan[i][0];
            if (!led)
                begin = i;
        }
        for (uint32_t next = fan[begin][1]; seen <= count; seen++) {
            size_t k = 0;
            while (k < count && fan[k][0] != next)
                k++;
            if (k == count || k == begin)
                break;
            next = fan[k][1];
        }
        bad += seen != count;
    }
    free(first);
    free(at);
    free(around);
    return bad;
}
