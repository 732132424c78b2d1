#include "render/samples.h"

enum { CHUNK = 65536 };

bool samples_valid(int count) {
    return count == 0 || count == 1 || count == 4 || count == 16;
}

void samples_shift(int count, int s, double shift[2]) {
    const int n = count == 16 ? 4 : count == 4 ? 2 : 1, i = s % n, j = s / n;
    shift[0] = (i + (j + 0.5) / n) / n - 0.5;
    shift[1] = (j + (n - i - 0.5) / n) / n - 0.5;
}

typedef struct sums {
    float *to[4];
    const float *from[4];
    size_t pixels;
    float scale;
} sums;

static status add_chunk(void *ctx, size_t index, int worker) {
    (void)worker;
    const sums *s = ctx;
    const size_t first = index * CHUNK, left = s->pixels - first;
    const size_t count = left < CHUNK ? left : CHUNK;
    for (int c = 0; c < 4; c++) {
        if (!s->to[c])
            continue;
        float *to = s->to[c] + first;
        const float *from = s->from[c] + first;
        for (size_t i = 0; i < count; i++)
            to[i] = (to[i] + from[i]) * s->scale;
    }
    return ST_OK;
}

status samples_add(pool *threads, const leafcast_image *to, const leafcast_image *from,
                   size_t pixels, float scale) {
    sums s = {{to->r, to->g, to->b, to->a}, {from->r, from->g, from->b, from->a}, pixels, scale};
    return pool_run(threads, (pixels + CHUNK - 1) / CHUNK, add_chunk, &s);
}
