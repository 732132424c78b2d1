#include "render/bench/peer_picture.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#include "render/app/image_out.h"

static int by_value(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double squares_of_colour(const leafcast_image *a, const leafcast_image *b, size_t i) {
    const double r = (double)a->r[i] - (double)b->r[i], g = (double)a->g[i] - (double)b->g[i];
    const double blue = (double)a->b[i] - (double)b->b[i];
    return r * r + g * g + blue * blue;
}

static bool far_apart(const leafcast_image *a, const leafcast_image *b, size_t i) {
    return fabsf(a->r[i] - b->r[i]) > 0.1f || fabsf(a->g[i] - b->g[i]) > 0.1f ||
           fabsf(a->b[i] - b->b[i]) > 0.1f;
}

status peer_picture_compare(mem *m, const leafcast_image *ours, const leafcast_image *peer,
                            size_t count, double cell, peer_difference *out) {
    double *apart = mem_array(m, count + 1, sizeof *apart), squares = 0.0;
    if (!apart)
        return ST_NOMEM;
    *out = (peer_difference){0};
    for (size_t i = 0; i < count; i++) {
        const bool here = ours->z[i] < INFINITY, there = peer->z[i] < INFINITY;
        out->only_ours += here && !there;
        out->only_peer += there && !here;
        if (!here || !there)
            continue;
        apart[out->both++] = fabs(ours->z[i] - peer->z[i]) / cell;
        squares += squares_of_colour(ours, peer, i);
        out->far += far_apart(ours, peer, i);
    }
    if (out->both > 0) {
        qsort(apart, out->both, sizeof *apart, by_value);
        out->median = apart[out->both / 2];
        out->p99 = apart[out->both - 1 - out->both / 100];
        out->worst = apart[out->both - 1];
        out->colour = sqrt(squares / (3.0 * (double)out->both));
    }
    mem_free(m, apart);
    return ST_OK;
}

/* ---- side by side ---- */

static void false_colour(double cells, float rgb[3]) {
    static const float ramp[5][3] = {{0.0f, 0.0f, 0.0f},
                                     {0.0f, 0.0f, 0.8f},
                                     {0.8f, 0.0f, 0.1f},
                                     {1.0f, 0.8f, 0.0f},
                                     {1.0f, 1.0f, 1.0f}};
    double at = cells > 1e-4 ? log10(cells) + 4.0 : 0.0;
    at = at < 4.0 ? at : 3.999999;
    const int step = (int)at;
    const float share = (float)(at - step);
    for (int i = 0; i < 3; i++)
        rgb[i] = ramp[step][i] + share * (ramp[step + 1][i] - ramp[step][i]);
}

static void difference_at(const leafcast_image *ours, const leafcast_image *peer, size_t at,
                          double cell, float rgb[3]) {
    const bool here = ours->z[at] < INFINITY, there = peer->z[at] < INFINITY;
    rgb[0] = rgb[2] = 0.0f;
    rgb[1] = here != there ? 1.0f : 0.0f;
    if (here && there)
        false_colour(fabs(ours->z[at] - peer->z[at]) / cell, rgb);
}

status peer_picture_write(mem *m, const char *path, bool force, uint32_t width, uint32_t height,
                          const leafcast_image *ours, const leafcast_image *peer, double cell) {
    const size_t pixels = (size_t)width * height;
    float *planes = mem_array(m, 9 * pixels, sizeof *planes);
    if (!planes)
        return ST_NOMEM;
    const leafcast_image both = {.size = sizeof(leafcast_image),
                                 .r = planes,
                                 .g = planes + 3 * pixels,
                                 .b = planes + 6 * pixels};
    for (size_t y = 0; y < height; y++)
        for (size_t x = 0; x < width; x++) {
            const size_t from = x + width * y, to = x + 3 * (size_t)width * y;
            float rgb[3];
            difference_at(ours, peer, from, cell, rgb);
            const float r[3] = {ours->r[from], peer->r[from], rgb[0]};
            const float g[3] = {ours->g[from], peer->g[from], rgb[1]};
            const float b[3] = {ours->b[from], peer->b[from], rgb[2]};
            for (size_t i = 0; i < 3; i++) {
                both.r[to + i * width] = r[i];
                both.g[to + i * width] = g[i];
                both.b[to + i * width] = b[i];
            }
        }
    status st = image_out_write(m, path, force,
                                &(picture){.width = 3 * width, .height = height, .image = &both});
    mem_free(m, planes);
    return st;
}
