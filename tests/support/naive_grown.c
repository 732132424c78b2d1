#include "tests/support/naive_grown.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/naive_bytes.h"
#include "tests/support/scratch.h"

static bool wrong(naive_grown *g, const char *format, ...) __attribute__((format(printf, 2, 3)));
static bool wrong(naive_grown *g, const char *format, ...) {
    va_list args;
    va_start(args, format);
    vsnprintf(g->why, sizeof g->why, format, args);
    va_end(args);
    return false;
}

/* Where each segment begins: from the last one back to the first. */
static bool find(naive_grown *g, const unsigned char *file, size_t size,
                 uint64_t at[NAIVE_SEGMENTS_MAX]) {
    uint64_t place = naive_number(file + 1512, 8);
    g->segments = (long)naive_number(file + 1520, 4);
    if (g->segments < 1 || g->segments > NAIVE_SEGMENTS_MAX || (g->segments == 1 && place))
        return wrong(g, "%ld segments", g->segments);
    for (long i = g->segments; i-- > 0;) {
        if (place > size - 4096 || (place == 0) != (i == 0))
            return wrong(g, "segment %ld at byte %llu", i, (unsigned long long)place);
        at[i] = place;
        place = naive_number(file + place + 1528, 8);
    }
    return true;
}

/* Whether two segments have the same cells, with the same parameters: all of their headers before
 * the number of steps, and what else describes them. */
static bool alike(const unsigned char *a, const unsigned char *b) {
    static const int fields[][2] = {{12, 68}, {80, 88}, {136, 232}, {1344, 1408}, {1424, 1500}};
    for (size_t i = 0; i < sizeof fields / sizeof *fields; i++)
        if (memcmp(a + fields[i][0], b + fields[i][0], (size_t)(fields[i][1] - fields[i][0])))
            return false;
    return true;
}

/* A segment's bytes, a copy. */
static unsigned char *copy(const unsigned char *from, uint64_t bytes) {
    unsigned char *to = malloc(bytes + 1);
    if (to)
        memcpy(to, from, bytes);
    return to;
}

static bool take_grid(naive_grown *g, const unsigned char *at, uint64_t bytes, long i, long set,
                      const char *path) {
    naive_leaf *leaf = &g->segment[i];
    leaf->before = g->segment;
    leaf->segments_before = i;
    leaf->size = bytes;
    leaf->bytes = copy(at, bytes);
    if (!leaf->bytes || !naive_leaf_read(leaf, path, set))
        return wrong(g, "segment %ld: %s", i, leaf->why);
    const naive_leaf *last = leaf - 1;
    return i == 0 ||
           (!last->times == !leaf->times &&
            (!last->times || leaf->times[0] > last->times[last->steps - 1])) ||
           wrong(g, "segment %ld: times", i);
}

static bool take_mesh(naive_grown *g, const unsigned char *at, uint64_t bytes, long i) {
    naive_mesh *mesh = &g->mesh[i];
    mesh->before = g->mesh;
    mesh->segments_before = i;
    mesh->size = bytes;
    mesh->bytes = copy(at, bytes);
    if (!mesh->bytes || !naive_mesh_read(mesh))
        return wrong(g, "segment %ld: %s", i, mesh->why);
    const naive_mesh *last = mesh - 1;
    const unsigned char *const *where = mesh->sections.where;
    const unsigned char *const *first = g->mesh[0].sections.where;
    const size_t n = (size_t)mesh->treelets;
    if (memcmp(where[NAIVE_COUNTS], first[NAIVE_COUNTS], 16 * n) ||
        memcmp(where[NAIVE_BOUNDS], first[NAIVE_BOUNDS], 24 * n))
        return wrong(g, "segment %ld: counts or bounds", i);
    return i == 0 ||
           (!last->times == !mesh->times &&
            (!last->times || mesh->times[0] > last->times[last->steps - 1])) ||
           wrong(g, "segment %ld: times", i);
}

static bool take(naive_grown *g, const unsigned char *file, size_t size, long i, uint64_t at,
                 long step, const char *path) {
    const uint64_t bytes = naive_number(file + at + 96, 8);
    const long steps = (long)naive_number(file + at + 68, 4);
    if (bytes > size - at || (i > 0 && !alike(file, file + at)))
        return wrong(g, "segment %ld: its bytes or its cells", i);
    g->first[i] = g->steps;
    if (i > 0 && (long)naive_number(file + at + 1524, 4) != g->steps)
        return wrong(g, "segment %ld: the steps before", i);
    g->size[i] = bytes;
    g->steps += steps;
    const long set = step >= g->first[i] && step < g->steps ? step - g->first[i] : 0;
    return naive_number(file + 12, 4) == 2 ? take_mesh(g, file + at, bytes, i)
                                           : take_grid(g, file + at, bytes, i, set, path);
}

bool naive_grown_load(naive_grown *g, const char *path, long step) {
    size_t size;
    uint64_t at[NAIVE_SEGMENTS_MAX], end = 0;
    memset(g, 0, sizeof *g);
    unsigned char *file = (unsigned char *)scratch_read(path, &size);
    bool good = size >= 4096 && find(g, file, size, at);
    for (long i = 0; good && i < g->segments; i++) {
        good = at[i] == end || wrong(g, "segment %ld is not behind the one before", i);
        good = good && take(g, file, size, i, at[i], step, path);
        end += g->size[i];
    }
    free(file);
    return good;
}

void naive_grown_release(naive_grown *g) {
    for (long i = 0; i < NAIVE_SEGMENTS_MAX; i++) {
        naive_leaf_release(&g->segment[i]);
        naive_mesh_release(&g->mesh[i]);
    }
}

static long index_of(const naive_grown *g, long step) {
    long i = g->segments - 1;
    while (i > 0 && g->first[i] > step)
        i--;
    return i;
}

const naive_leaf *naive_grown_segment(const naive_grown *g, long step) {
    return &g->segment[index_of(g, step)];
}

const naive_mesh *naive_grown_mesh(const naive_grown *g, long step, long *own) {
    const long i = index_of(g, step);
    *own = step - g->first[i];
    return &g->mesh[i];
}
