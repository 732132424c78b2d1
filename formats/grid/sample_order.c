#include "formats/grid/sample_order.h"

#include <stdbool.h>
#include <string.h>

typedef struct gathering {
    const sample_order *o;
    const sample_bytes *from;
    const uint32_t *first, *end;
    size_t step[ORDER_AXES]; /* bytes from one number to the next in out */
    uint64_t passed;         /* numbers read or skipped so far */
    char *run;
} gathering;

static status skip_to(gathering *g, uint64_t number) {
    const uint64_t count = number - g->passed;
    g->passed = number;
    return count ? g->from->skip(g->from->ctx, count * g->o->width) : ST_OK;
}

#define SCATTER(bytes)                 \
    for (size_t i = 0; i < count; i++) \
        memcpy(to + i * step, run + i * (bytes), bytes);

static void scatter(const char *run, size_t width, size_t count, size_t step, char *to) {
    switch (width) {
    case 1: SCATTER(1) break;
    case 2: SCATTER(2) break;
    case 4: SCATTER(4) break;
    default: SCATTER(8) break;
    }
}

/* Take the wanted part of a run along the input's fastest axis. The run starts at number `start`,
 * its part goes to `to` in out. */
static status take_run(gathering *g, uint64_t start, char *to) {
    const int a = g->o->axis[0];
    const size_t width = g->o->width, count = g->end[a] - g->first[a];
    status st = skip_to(g, start + g->first[a]);
    if (st != ST_OK)
        return st;
    const bool straight = g->step[a] == width;
    st = g->from->read(g->from->ctx, straight ? to : g->run, count * width);
    g->passed += count;
    if (st == ST_OK && !straight)
        scatter(g->run, width, count, g->step[a], to);
    return st;
}

/* Take all runs along the input's axes 0 .. axis - 1, from number `start` on. */
static status take_block(gathering *g, int axis, uint64_t start, uint64_t numbers, char *to) {
    if (axis == 0)
        return take_run(g, start, to);
    const int a = g->o->axis[axis];
    status st = ST_OK;
    numbers /= g->o->count[a];
    for (uint32_t i = g->first[a]; st == ST_OK && i < g->end[a]; i++)
        st = take_block(g, axis - 1, start + i * numbers, numbers,
                        to + (i - g->first[a]) * g->step[a]);
    return st;
}

status sample_order_gather(const sample_order *o, const sample_bytes *from,
                           const uint32_t first[ORDER_AXES], const uint32_t end[ORDER_AXES],
                           void *run, void *out) {
    static const int order[ORDER_AXES] = {ORDER_COMPONENT, ORDER_X, ORDER_Y, ORDER_Z, ORDER_STEP};
    gathering g = {.o = o, .from = from, .first = first, .end = end, .run = run};
    uint64_t all = 1;
    size_t step = o->width;
    for (int i = 0; i < ORDER_AXES; i++) {
        const int a = order[i];
        all *= o->count[a];
        g.step[a] = step;
        step *= end[a] - first[a];
    }
    status st = take_block(&g, ORDER_AXES - 1, 0, all, out);
    return st == ST_OK ? skip_to(&g, all) : st;
}
