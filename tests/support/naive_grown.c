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

/* Whether two segments are of the same grid, with the same parameters: all of their headers before
 * the number of steps, and what else describes them. */
static bool alike(const unsigned char *a, const unsigned char *b) {
    static const int fields[][2] = {{12, 68}, {80, 88}, {136, 232}, {1424, 1488}, {1496, 1500}};
    for (size_t i = 0; i < sizeof fields / sizeof *fields; i++)
        if (memcmp(a + fields[i][0], b + fields[i][0], (size_t)(fields[i][1] - fields[i][0])))
            return false;
    return true;
}

static bool take(naive_grown *g, const unsigned char *file, size_t size, long i, uint64_t at,
                 long step, const char *path) {
    naive_leaf *leaf = &g->segment[i];
    const uint64_t bytes = naive_number(file + at + 96, 8);
    const long steps = (long)naive_number(file + at + 68, 4);
    if (bytes > size - at || (i > 0 && !alike(file, file + at)))
        return wrong(g, "segment %ld: its bytes or its grid", i);
    g->first[i] = g->steps;
    if (i > 0 && (long)naive_number(file + at + 1524, 4) != g->steps)
        return wrong(g, "segment %ld: the steps before", i);
    leaf->before = g->segment;
    leaf->segments_before = i;
    leaf->size = bytes;
    leaf->bytes = malloc(bytes + 1);
    if (!leaf->bytes)
        return wrong(g, "no memory");
    memcpy(leaf->bytes, file + at, bytes);
    g->steps += steps;
    const long set = step >= g->first[i] && step < g->steps ? step - g->first[i] : 0;
    return naive_leaf_read(leaf, path, set) || wrong(g, "segment %ld: %s", i, leaf->why);
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
        end += g->segment[i].size;
    }
    const naive_leaf *last = &g->segment[good ? g->segments - 1 : 0];
    for (long i = 1; good && i < g->segments; i++)
        good = !last->times == !g->segment[i].times &&
               (!last->times ||
                g->segment[i].times[0] > g->segment[i - 1].times[g->segment[i - 1].steps - 1]);
    free(file);
    return good || (*g->why ? false : wrong(g, "times"));
}

void naive_grown_release(naive_grown *g) {
    for (long i = 0; i < NAIVE_SEGMENTS_MAX; i++)
        naive_leaf_release(&g->segment[i]);
}

const naive_leaf *naive_grown_segment(const naive_grown *g, long step) {
    long i = g->segments - 1;
    while (i > 0 && g->first[i] > step)
        i--;
    return &g->segment[i];
}
