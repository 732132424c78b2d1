#include "render/app/slice_picture.h"

#include <math.h>
#include <stdbool.h>

/* Half an isoline's width, and how far from it a pixel of the other side may be; both in pixels. */
static const double HALF_WIDTH = 0.75;
enum { REACH = 2 };

typedef struct plane {
    const double *value;
    uint32_t width, height;
} plane;

static double at(const plane *p, int64_t x, int64_t y) {
    const bool inside = x >= 0 && y >= 0 && x < p->width && y < p->height;
    return inside ? p->value[(size_t)y * p->width + (size_t)x] : (double)NAN;
}

/* Returns the larger of the differences to two neighbours; NaN neighbours count as 0. */
static double slope(double before, double here, double behind) {
    const double a = fabs(here - before), b = fabs(behind - here);
    return fmax(isnan(a) ? 0.0 : a, isnan(b) ? 0.0 : b);
}

static double gradient(const plane *p, uint32_t x, uint32_t y) {
    const double here = at(p, x, y);
    const double across = slope(at(p, (int64_t)x - 1, y), here, at(p, (int64_t)x + 1, y));
    const double down = slope(at(p, x, (int64_t)y - 1), here, at(p, x, (int64_t)y + 1));
    return sqrt(across * across + down * down);
}

/* Returns whether a pixel within REACH lies on the other side of the isovalue. */
static bool changes_side(const plane *p, uint32_t x, uint32_t y, double iso) {
    const bool here = at(p, x, y) >= iso;
    for (int64_t j = (int64_t)y - REACH; j <= (int64_t)y + REACH; j++)
        for (int64_t i = (int64_t)x - REACH; i <= (int64_t)x + REACH; i++) {
            const double other = at(p, i, j);
            if (!isnan(other) && (other >= iso) != here)
                return true;
        }
    return false;
}

/* Returns how much of a pixel isolines cover, 0 to 1. */
static double coverage(const slice_look *look, const plane *p, uint32_t x, uint32_t y) {
    const double here = at(p, x, y), steep = look->isos > 0 ? gradient(p, x, y) : 0.0;
    double most = 0.0;
    for (int i = 0; i < look->isos && steep > 0.0; i++) {
        const double away = fabs(here - look->isovalues[i]) / steep;
        const double share = fmin(HALF_WIDTH + 0.5 - away, 1.0);
        if (share > most && changes_side(p, x, y, look->isovalues[i]))
            most = share;
    }
    return most;
}

static void fill_pixel(const slice_look *look, const plane *p, uint32_t x, uint32_t y,
                       const leafcast_image *out) {
    const size_t i = (size_t)y * p->width + x;
    const double value = p->value[i];
    float *const rgb[] = {out->r, out->g, out->b};
    out->a[i] = isnan(value) ? 0.0f : 1.0f;
    for (int c = 0; c < 3; c++)
        rgb[c][i] = 0.0f;
    if (isnan(value))
        return;
    const double line = coverage(look, p, x, y);
    const leafcast_transfer_point colour = transfer_list_at(&look->colours, value, true);
    for (int c = 0; c < 3; c++)
        rgb[c][i] = (float)((1.0 - line) * colour.rgb[c] + line * (double)look->line[c]);
}

void slice_picture_fill(const slice_look *look, const double *value, uint32_t width,
                        uint32_t height, const leafcast_image *out) {
    const plane p = {value, width, height};
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width; x++)
            fill_pixel(look, &p, x, y, out);
}
