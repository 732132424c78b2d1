#include "tests/support/naive_histogram.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/naive_bytes.h"

enum { ELEMENT = 7744 };

/* One thing that was drawn. */
typedef struct draw {
    bool has_value, has_cell;
    float value, lo, hi, slope, area;
    int position[3];
} draw;

static uint64_t hash(uint64_t x) {
    x += 0x9E3779B97F4A7C15u;
    x = (x ^ x >> 30) * 0xBF58476D1CE4E5B9u;
    x = (x ^ x >> 27) * 0x94D049BB133111EBu;
    return x ^ x >> 31;
}

static bool near(double a, double b) {
    return fabs(a - b) <= 1e-5 * fmax(fabs(a), fabs(b));
}

/* One element against all that was drawn; every bin goes through all draws. */
static const char *compare(const unsigned char *at, const draw *draws, size_t count,
                           uint64_t total) {
    static char why[200];
    const long bins = (long)naive_number(at, 4);
    uint64_t values = 0, cells = 0, inside = 0;
    for (size_t i = 0; i < count; i++) {
        values += draws[i].has_value;
        cells += draws[i].has_cell;
    }
    if (bins > 256 || !naive_zeros(at, 4, 8) || !naive_zeros(at, 32, 56))
        return "its head";
    if (naive_number(at + 8, 8) != values || naive_number(at + 16, 8) != (bins ? cells : 0) ||
        naive_number(at + 24, 8) != total)
        return "how many were drawn";
    if (!naive_zeros(at, 56 + 8 * (uint64_t)(bins + (bins > 0)), 2112))
        return "edges behind the last";
    for (long k = 0; k < 256; k++) {
        const double from = naive_real64(at + 56 + 8 * k), to = naive_real64(at + 64 + 8 * k);
        uint64_t here = 0, active = 0;
        double slope = 0, area = 0;
        int box[6] = {0, 0, 0, 0, 0, 0};
        for (size_t i = 0; k < bins && i < count; i++) {
            const draw *d = &draws[i];
            here += d->has_value && (double)d->value >= from && (double)d->value < to;
            if (!d->has_cell || !((double)d->lo < from && from <= (double)d->hi))
                continue;
            for (int a = 0; a < 3; a++) {
                box[a] = !active || d->position[a] < box[a] ? d->position[a] : box[a];
                box[a + 3] = !active || d->position[a] > box[a + 3] ? d->position[a] : box[a + 3];
            }
            active++;
            slope += (double)d->slope;
            area += (double)d->area;
        }
        inside += here;
        if (naive_number(at + 2112 + 4 * k, 4) != here ||
            naive_number(at + 3136 + 4 * k, 4) != active ||
            !near((double)naive_real32(at + 4160 + 4 * k), active ? slope / (double)active : 0) ||
            !near((double)naive_real32(at + 5184 + 4 * k),
                  area * (double)total / (double)(count ? count : 1))) {
            snprintf(why, sizeof why, "bin %ld: %llu samples, %llu active", k,
                     (unsigned long long)here, (unsigned long long)active);
            return why;
        }
        for (int a = 0; a < 6; a++)
            if (at[6208 + 6 * k + a] != box[a])
                return "a box";
    }
    return inside == values ? NULL : "values outside all bins";
}

/* ---- a grid ---- */

/* The gradient in the middle of a cell, in the world: solves M^T g = gradient in grid space. */
static double slope_of(const naive_leaf *leaf, const float v[8], const long node[3],
                       double *volume) {
    double own[3], m[3][4];
    double size = 1;
    for (unsigned a = 0; a < 3; a++) {
        const double width =
            leaf->rectilinear ? leaf->axis[a][node[a] + 1] - leaf->axis[a][node[a]] : 1;
        own[a] = 0;
        for (unsigned i = 0; i < 8; i++)
            own[a] += (i >> a & 1 ? 1.0 : -1.0) * (double)v[i] / 4 / width;
        size *= width;
    }
    for (int r = 0; r < 3; r++) {
        for (int c = 0; c < 3; c++)
            m[r][c] = leaf->to_world[c][r];
        m[r][3] = own[r];
    }
    double det = 1;
    for (int i = 0; i < 3; i++) {
        int best = i;
        for (int r = i; r < 3; r++)
            best = fabs(m[r][i]) > fabs(m[best][i]) ? r : best;
        for (int c = 0; c < 4; c++) {
            const double swap = m[i][c];
            m[i][c] = m[best][c];
            m[best][c] = swap;
        }
        det *= m[i][i];
        for (int r = 0; r < 3; r++)
            for (int c = 3; r != i && c >= i; c--)
                m[r][c] -= m[r][i] / m[i][i] * m[i][c];
    }
    *volume = fabs(det) * size;
    return sqrt(pow(m[0][3] / m[0][0], 2) + pow(m[1][3] / m[1][1], 2) + pow(m[2][3] / m[2][2], 2));
}

static draw draw_node(const naive_leaf *leaf, const long node[3]) {
    draw d = {.value = naive_leaf_sample(leaf, 0, node[0], node[1], node[2])};
    float v[8];
    d.has_value = isfinite(d.value);
    for (int a = 0; a < 3; a++)
        if (node[a] == leaf->dims[a] - 1)
            return d;
    for (int i = 0; i < 8; i++) {
        v[i] = naive_leaf_sample(leaf, 0, node[0] + (i & 1), node[1] + (i >> 1 & 1),
                                 node[2] + (i >> 2));
        if (!isfinite(v[i]))
            return d;
        d.lo = i == 0 || v[i] < d.lo ? v[i] : d.lo;
        d.hi = i == 0 || v[i] > d.hi ? v[i] : d.hi;
    }
    d.has_cell = true;
    double volume;
    d.slope = (float)slope_of(leaf, v, node, &volume);
    d.area = d.hi > d.lo ? (float)(volume * (double)d.slope / ((double)d.hi - (double)d.lo)) : 0;
    for (int a = 0; a < 3; a++)
        d.position[a] = (int)(255 * node[a] / (leaf->dims[a] - 1));
    return d;
}

const char *naive_histogram_grid(const naive_leaf *leaf) {
    const uint64_t size = leaf->sections.histogram_bytes;
    const unsigned char *at = leaf->sections.histograms;
    long s = 1, b[3] = {0, 0, 0}, i = 0;
    if (!at)
        return "none";
    for (;; s++) {
        for (int a = 0; a < 3; a++)
            b[a] = (leaf->dims[a] + s - 1) / s;
        if (b[0] * b[1] * b[2] <= 1 << 16)
            break;
    }
    draw *draws = calloc((size_t)(b[0] * b[1] * b[2]), sizeof *draws);
    if (!draws || size != ELEMENT)
        return "no memory, or its size";
    for (long z = 0; z < b[2]; z++)
        for (long y = 0; y < b[1]; y++)
            for (long x = 0; x < b[0]; x++, i++) {
                const long first[3] = {s * x, s * y, s * z};
                long node[3];
                for (int a = 0; a < 3; a++) {
                    const long left = leaf->dims[a] - first[a], most = s < left ? s : left;
                    node[a] =
                        first[a] + ((long)(hash((uint64_t)i) >> 20 * a & 0xFFFFF) * most >> 20);
                }
                draws[i] = draw_node(leaf, node);
            }
    const char *why =
        compare(at, draws, (size_t)i,
                (uint64_t)leaf->dims[0] * (uint64_t)leaf->dims[1] * (uint64_t)leaf->dims[2]);
    free(draws);
    return why;
}

/* ---- a mesh ---- */

static draw draw_tet(const naive_mesh *mesh, const naive_part *p, const long tet[4], long set) {
    draw d = {.has_value = true, .has_cell = true};
    const long step = set % mesh->steps, place = mesh->places > 1 ? step : 0;
    double e[3][3], rise[3], sum = 0, n[3], g[3] = {0, 0, 0}, det = 0;
    float v[4];
    const float *x[4];
    for (int c = 0; c < 4; c++) {
        v[c] = p->values[set * p->vertices + tet[c]];
        x[c] = p->positions[place * p->vertices + tet[c]];
        if (!isfinite(v[c]))
            return (draw){0};
        d.lo = c == 0 || v[c] < d.lo ? v[c] : d.lo;
        d.hi = c == 0 || v[c] > d.hi ? v[c] : d.hi;
        sum += (double)v[c];
    }
    d.value = (float)(sum / 4);
    for (int c = 0; c < 3; c++) {
        rise[c] = (double)v[c + 1] - (double)v[0];
        for (int a = 0; a < 3; a++)
            e[c][a] = (double)x[c + 1][a] - (double)x[0][a];
    }
    for (int c = 0; c < 3; c++) {
        const double *u = e[(c + 1) % 3], *w = e[(c + 2) % 3];
        for (int a = 0; a < 3; a++) {
            n[a] = u[(a + 1) % 3] * w[(a + 2) % 3] - u[(a + 2) % 3] * w[(a + 1) % 3];
            g[a] += rise[c] * n[a];
            det += c == 0 ? n[a] * e[0][a] : 0;
        }
    }
    const double slope = sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]) / fabs(det);
    if (det == 0 || d.lo == d.hi)
        return d;
    d.slope = (float)slope;
    d.area = (float)(fabs(det) / 6 * slope / ((double)d.hi - (double)d.lo));
    return d;
}

const char *naive_histogram_mesh(const naive_mesh *mesh) {
    const uint64_t size = mesh->sections.histogram_bytes;
    const unsigned char *at = mesh->sections.histograms;
    const long k = mesh->sets < 1 << 16 ? (1 << 16) / mesh->sets : 1, s = (mesh->tets + k - 1) / k;
    const long runs = (mesh->tets + s - 1) / s;
    const char *why = NULL;
    if (!at)
        return "none";
    if (size != ELEMENT * (uint64_t)mesh->sets)
        return "its size";
    draw *draws = calloc((size_t)runs, sizeof *draws);
    if (!draws)
        return "no memory";
    for (long set = 0; set < mesh->sets && !why; set++) {
        const naive_part *p = mesh->part;
        long before = 0;
        for (long i = 0; i < runs; i++) {
            const long left = mesh->tets - s * i, most = s < left ? s : left;
            const long tet = s * i + (long)(hash((uint64_t)i) % (uint64_t)most);
            for (; tet >= before + p->tets; p++)
                before += p->tets;
            draws[i] = draw_tet(mesh, p, p->tet[tet - before], set);
        }
        why = compare(at + ELEMENT * set, draws, (size_t)runs, (uint64_t)mesh->tets);
    }
    free(draws);
    return why;
}
