#include "render/app/canvas.h"

#include <math.h>

void canvas_put(const canvas *c, long x, long y, const float rgb[3], float opacity) {
    float *const planes[4] = {c->image->r, c->image->g, c->image->b, c->image->a};
    const float what[4] = {rgb[0], rgb[1], rgb[2], 1.0f};
    if (x < 0 || y < 0 || x >= c->width || y >= c->height)
        return;
    const size_t at = (size_t)y * (size_t)c->width + (size_t)x;
    for (int i = 0; i < 4; i++)
        if (planes[i])
            planes[i][at] = opacity * what[i] + (1.0f - opacity) * planes[i][at];
}

void canvas_fill(const canvas *c, canvas_box box, const float rgb[3], float opacity) {
    for (long y = box.y0; y < box.y1; y++)
        for (long x = box.x0; x < box.x1; x++)
            canvas_put(c, x, y, rgb, opacity);
}

/* ---- Lines ---- */

/* A line to draw: step along its longer axis pixel by pixel, and at each step over the pixels
 * across that it covers. */
typedef struct stroke {
    const canvas_line *line;
    int along;         /* 0: x */
    double a[2], b[2]; /* its ends as (along, across), a before b */
    double length, reach;
    bool turned; /* a is `to` */
} stroke;

static stroke stroke_of(const canvas_line *line) {
    const double dx = line->to[0] - line->from[0], dy = line->to[1] - line->from[1];
    stroke s = {.line = line, .along = fabs(dx) < fabs(dy), .length = hypot(dx, dy)};
    s.turned = s.along ? dy < 0.0 : dx < 0.0;
    const double *a = s.turned ? line->to : line->from, *b = s.turned ? line->from : line->to;
    for (int i = 0; i < 2; i++) {
        s.a[i] = a[i ^ s.along];
        s.b[i] = b[i ^ s.along];
    }
    /* A slanted line covers more pixels across. */
    s.reach = 0.5 * line->width * s.length / fmax(s.b[0] - s.a[0], 1e-9) + 1.0;
    return s;
}

static void put_dot(const canvas *c, const stroke *s, long along, long across) {
    const canvas_line *line = s->line;
    const double p[2] = {(double)along + 0.5 - s->a[0], (double)across + 0.5 - s->a[1]};
    const double d[2] = {(s->b[0] - s->a[0]) / s->length, (s->b[1] - s->a[1]) / s->length};
    const double on = p[0] * d[0] + p[1] * d[1], off = fabs(p[0] * d[1] - p[1] * d[0]);
    const double beyond = fmax(fmax(-on, on - s->length), 0.0);
    const double cover = fmin(fmax(0.5 * line->width + 0.5 - hypot(off, beyond), 0.0), 1.0);
    const long x = s->along ? across : along, y = s->along ? along : across;
    const double share = fmin(fmax(on / s->length, 0.0), 1.0);
    if (!(cover > 0.0) || x < 0 || y < 0 || x >= c->width || y >= c->height)
        return;
    if (!line->seen || line->seen(line->ctx, s->turned ? 1.0 - share : share, x, y))
        canvas_put(c, x, y, line->rgb, (float)cover * line->opacity);
}

void canvas_draw_line(const canvas *c, const canvas_line *line) {
    const stroke s = stroke_of(line);
    const double end = (double)(s.along ? c->height : c->width);
    if (!(s.length > 0.0 && s.length < 1e9))
        return;
    const long first = (long)floor(fmax(s.a[0] - line->width - 1.0, 0.0)),
               last = (long)ceil(fmin(s.b[0] + line->width + 1.0, end));
    for (long i = first; i < last; i++) {
        const double share = ((double)i + 0.5 - s.a[0]) / (s.b[0] - s.a[0]);
        const double middle = s.a[1] + fmin(fmax(share, 0.0), 1.0) * (s.b[1] - s.a[1]);
        for (long k = (long)floor(middle - s.reach); k <= (long)ceil(middle + s.reach); k++)
            put_dot(c, &s, i, k);
    }
}
