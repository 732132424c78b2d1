#include "formats/leaf/histogram_draw.h"

#include <math.h>
#include <stdbool.h>

#include "formats/base/vec3.h"

/* ---- what is drawn ---- */

/* splitmix64's mixer: every bit of the result depends on every bit of x. */
static uint64_t mixed(uint64_t x) {
    x += 0x9E3779B97F4A7C15u;
    x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
    x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
    return x ^ (x >> 31);
}

static uint32_t blocks_of(uint32_t nodes, uint32_t step) {
    return (nodes - 1) / step + 1;
}

static uint64_t total_blocks(const uint32_t dims[3], uint32_t step) {
    return (uint64_t)blocks_of(dims[0], step) * blocks_of(dims[1], step) * blocks_of(dims[2], step);
}

histogram_draw histogram_draw_grid(const uint32_t dims[3]) {
    histogram_draw d = {.step = 1};
    while (total_blocks(dims, d.step) > HISTOGRAM_DRAWS)
        d.step++;
    for (int a = 0; a < 3; a++) {
        d.dims[a] = dims[a];
        d.blocks[a] = blocks_of(dims[a], d.step);
    }
    d.count = (uint32_t)total_blocks(dims, d.step);
    return d;
}

uint32_t histogram_draw_node(const histogram_draw *d, const uint32_t block[3], uint32_t node[3]) {
    const uint32_t index = block[0] + d->blocks[0] * (block[1] + d->blocks[1] * block[2]);
    uint64_t bits = mixed(index);
    for (int a = 0; a < 3; a++) {
        const uint32_t first = block[a] * d->step, left = d->dims[a] - first;
        const uint32_t size = left < d->step ? left : d->step;
        node[a] = first + (uint32_t)((bits & 0xFFFFF) * size >> 20);
        bits >>= 20;
    }
    return index;
}

histogram_run histogram_draw_tets(uint64_t total, uint32_t sets) {
    const uint64_t most = sets < HISTOGRAM_TETS ? HISTOGRAM_TETS / sets : 1;
    histogram_run r = {.total = total, .step = total > most ? (total - 1) / most + 1 : 1};
    r.count = total ? (uint32_t)((total - 1) / r.step + 1) : 0;
    return r;
}

uint64_t histogram_draw_tet(const histogram_run *r, uint32_t i) {
    const uint64_t first = i * r->step, left = r->total - first;
    const uint64_t size = left < r->step ? left : r->step;
    return first + mixed(i) % size;
}

/* ---- what is measured ---- */

static const histogram_cell nothing = {NAN, INFINITY, -INFINITY, 0, 0, {0, 0, 0, 0}};

/* Find the range of some values; false if one is not finite. */
static bool range_of(const float *v, int count, histogram_cell *c) {
    float lo = v[0], hi = v[0], sum = 0;
    for (int i = 0; i < count; i++) {
        lo = v[i] < lo ? v[i] : lo;
        hi = v[i] > hi ? v[i] : hi;
        sum += v[i] - v[i]; /* NaN where v[i] is NaN or inf */
    }
    if (!(sum == 0))
        return false;
    c->lo = lo + 0.0F; /* -0 becomes +0 */
    c->hi = hi + 0.0F;
    return true;
}

histogram_space histogram_space_of(const double *to_world) {
    const double *m = to_world;
    histogram_space s = {.axis = {NULL, NULL, NULL}};
    double det = 0;
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++) {
            const int r1 = (r + 1) % 3, r2 = (r + 2) % 3, c1 = (c + 1) % 3, c2 = (c + 2) % 3;
            const double minor = m[4 * r1 + c1] * m[4 * r2 + c2] - m[4 * r1 + c2] * m[4 * r2 + c1];
            s.inverse[c][r] = minor;
            det += r == 0 ? m[c] * minor : 0;
        }
    for (int i = 0; i < 9; i++)
        s.inverse[i / 3][i % 3] /= det;
    s.volume = fabs(det);
    return s;
}

/* Compute slope and area of the cell at a node from its gradient in index space. */
static void measure(const histogram_space *s, const uint32_t node[3], const double gradient[3],
                    histogram_cell *c) {
    double own[3], square = 0, volume = s->volume;
    for (int a = 0; a < 3; a++) {
        const double *x = s->axis[a];
        const double width = x ? x[node[a] + 1] - x[node[a]] : 1;
        own[a] = gradient[a] / width;
        volume *= width;
    }
    for (int r = 0; r < 3; r++) {
        const double g =
            s->inverse[0][r] * own[0] + s->inverse[1][r] * own[1] + s->inverse[2][r] * own[2];
        square += g * g;
    }
    const double slope = sqrt(square), span = (double)c->hi - (double)c->lo;
    c->slope = histogram_limited(slope);
    c->area = histogram_limited(volume * (slope / span));
}

static void corners_of(const histogram_block *b, size_t at, float v[8]) {
    for (unsigned i = 0; i < 8; i++)
        v[i] = sample_get(b->type, b->samples,
                          at + (i & 1) + (i >> 1 & 1) * b->row + (i >> 2) * b->slice);
}

static histogram_cell look(const histogram_draw *d, const histogram_space *s,
                           const histogram_block *b, const uint32_t node[3]) {
    const size_t at = (node[0] - b->first[0]) + (node[1] - b->first[1]) * b->row +
                      (node[2] - b->first[2]) * b->slice;
    histogram_cell c = nothing;
    const float value = sample_get(b->type, b->samples, at);
    float v[8];
    if (isfinite(value))
        c.value = value + 0.0F;
    for (int a = 0; a < 3; a++)
        if (node[a] + 1 == d->dims[a])
            return c;
    for (int a = 0; a < 3; a++)
        c.position[a] = (uint8_t)((uint64_t)node[a] * 255 / (d->dims[a] - 1));
    corners_of(b, at, v);
    if (!range_of(v, 8, &c) || c.lo == c.hi)
        return c;
    double g[3] = {0, 0, 0};
    for (unsigned a = 0; a < 3; a++) {
        for (unsigned i = 0; i < 8; i++)
            g[a] += i >> a & 1 ? (double)v[i] : -(double)v[i];
        g[a] *= 0.25;
    }
    measure(s, node, g, &c);
    return c;
}

void histogram_draw_take(const histogram_draw *d, const histogram_space *s,
                         const histogram_block *b, histogram_cell *cells) {
    uint32_t i[3], node[3];
    for (i[2] = b->first[2] / d->step; i[2] * d->step < b->end[2]; i[2]++)
        for (i[1] = b->first[1] / d->step; i[1] * d->step < b->end[1]; i[1]++)
            for (i[0] = b->first[0] / d->step; i[0] * d->step < b->end[0]; i[0]++) {
                const uint32_t index = histogram_draw_node(d, i, node);
                bool inside = true;
                for (int a = 0; a < 3; a++)
                    inside &= node[a] >= b->first[a] && node[a] < b->end[a];
                if (inside)
                    cells[index] = look(d, s, b, node);
            }
}

histogram_cell histogram_tet(const float *const corners[4], const float values[4]) {
    histogram_cell c = nothing;
    if (!range_of(values, 4, &c))
        return c;
    c.value =
        (float)(((double)values[0] + (double)values[1] + ((double)values[2] + (double)values[3])) *
                0.25) +
        0.0F;
    double edge[3][3], normal[3], sum[3] = {0, 0, 0}, det = 0;
    for (int e = 0; e < 3; e++)
        for (int a = 0; a < 3; a++)
            edge[e][a] = (double)corners[e + 1][a] - (double)corners[0][a];
    for (int e = 0; e < 3; e++) {
        const double rise = (double)values[e + 1] - (double)values[0];
        vec3_cross(edge[(e + 1) % 3], edge[(e + 2) % 3], normal);
        for (int a = 0; a < 3; a++) {
            sum[a] += rise * normal[a];
            det += e == 0 ? edge[0][a] * normal[a] : 0;
        }
    }
    /* The gradient is sum / det, and the volume is |det| / 6. */
    const double length = vec3_length(sum);
    const double span = (double)c.hi - (double)c.lo;
    if (det == 0 || span == 0)
        return c;
    c.slope = histogram_limited(length / fabs(det));
    c.area = histogram_limited(length / span / 6);
    return c;
}

/* The edges that are parallel in a cube, added up, are four times the derivative in the middle. */
histogram_cell histogram_hex(const float *const corners[HISTOGRAM_CORNERS],
                             const float values[HISTOGRAM_CORNERS]) {
    histogram_cell c = nothing;
    double along[3][3] = {{0}}, rise[3] = {0}, normal[3], sum[3] = {0}, mean = 0, det = 0;
    if (!range_of(values, HISTOGRAM_CORNERS, &c))
        return c;
    for (int n = 0; n < HISTOGRAM_CORNERS; n++) {
        mean += (double)values[n] / HISTOGRAM_CORNERS;
        for (int e = 0; e < 3; e++) {
            const double sign = n >> e & 1 ? 0.25 : -0.25;
            rise[e] += sign * (double)values[n];
            for (int a = 0; a < 3; a++)
                along[e][a] += sign * (double)corners[n][a];
        }
    }
    c.value = (float)mean + 0.0F;
    for (int e = 0; e < 3; e++) {
        vec3_cross(along[(e + 1) % 3], along[(e + 2) % 3], normal);
        for (int a = 0; a < 3; a++) {
            sum[a] += rise[e] * normal[a];
            det += e == 0 ? along[0][a] * normal[a] : 0;
        }
    }
    /* The gradient is sum / det, and the volume is |det|. */
    const double length = vec3_length(sum), span = (double)c.hi - (double)c.lo;
    if (det == 0 || span == 0)
        return c;
    c.slope = histogram_limited(length / fabs(det));
    c.area = histogram_limited(length / span);
    return c;
}
