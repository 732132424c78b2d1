#include "render/look/samples.h"

bool samples_valid(int count) {
    return count == 0 || count == 1 || count == 4 || count == 16;
}

void samples_shift(int count, int s, double shift[2]) {
    const int n = count == 16 ? 4 : count == 4 ? 2 : 1, i = s % n, j = s / n;
    shift[0] = (i + (j + 0.5) / n) / n - 0.5;
    shift[1] = (j + (n - i - 0.5) / n) / n - 0.5;
}

typedef struct sums {
    const leafcast_image *to, *from;
    float scale;
} sums;

static status add_row(void *ctx, size_t row, int worker) {
    (void)worker;
    const sums *s = ctx;
    float *const to[4] = {s->to->r, s->to->g, s->to->b, s->to->a};
    float *const from[4] = {s->from->r, s->from->g, s->from->b, s->from->a};
    for (int c = 0; c < 4; c++)
        for (size_t i = 0; to[c] && i < s->to->width; i++) {
            float *sum = &to[c][row * s->to->stride + i];
            *sum = (*sum + from[c][row * s->from->stride + i]) * s->scale;
        }
    return ST_OK;
}

status samples_add(pool *threads, const leafcast_image *to, const leafcast_image *from,
                   float scale) {
    sums s = {to, from, scale};
    return pool_run(threads, to->height, add_row, &s);
}
