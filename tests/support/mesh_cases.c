#include "tests/support/mesh_cases.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/fields.h"
#include "tests/support/scratch.h"

static mesh_case allocate(size_t points, size_t tets) {
    mesh_case c = {.point_count = points, .tet_count = tets, .options = mesh_options_default()};
    c.points = malloc(points * sizeof *c.points);
    c.values = malloc(points * sizeof *c.values);
    c.tets = malloc((tets ? tets : 1) * sizeof *c.tets);
    if (!c.points || !c.values || !c.tets)
        abort();
    c.options.force = true;
    c.options.memory = (uint64_t)1 << 30;
    c.options.threads = 2;
    return c;
}

void mesh_cases_free(mesh_case *c) {
    free(c->points);
    free(c->values);
    free(c->tets);
}

/* The six tets of a cell go from its first corner to its last, an axis at a time. */
static void cut_cell(uint32_t (*tets)[4], uint32_t corner, const uint32_t step[3]) {
    static const int ORDER[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1},
                                    {1, 0, 2}, {0, 2, 1}, {2, 1, 0}};
    for (int t = 0; t < 6; t++) {
        tets[t][0] = corner;
        for (int k = 0; k < 3; k++)
            tets[t][k + 1] = tets[t][k] + step[ORDER[t][k]];
        /* The last three are mirrored. */
        if (t >= 3) {
            uint32_t swap = tets[t][2];
            tets[t][2] = tets[t][3];
            tets[t][3] = swap;
        }
    }
}

mesh_case mesh_cases_kuhn(uint32_t nx, uint32_t ny, uint32_t nz) {
    const uint32_t n[3] = {nx + 1, ny + 1, nz + 1}, step[3] = {1, n[0], n[0] * n[1]};
    mesh_case c = allocate((size_t)n[0] * n[1] * n[2], (size_t)6 * nx * ny * nz);
    for (uint32_t i = 0; i < c.point_count; i++) {
        const uint32_t at[3] = {i % n[0], i / n[0] % n[1], i / step[2]};
        double value = 0;
        for (int a = 0; a < 3; a++) {
            c.points[i][a] = (float)at[a];
            value += sin(0.4 * (double)at[a] + a);
        }
        c.values[i] = (float)value;
    }
    size_t t = 0;
    for (uint32_t z = 0; z < nz; z++)
        for (uint32_t y = 0; y < ny; y++)
            for (uint32_t x = 0; x < nx; x++, t += 6)
                cut_cell(c.tets + t, x + y * step[1] + z * step[2], step);
    return c;
}

mesh_case mesh_cases_soup(size_t points, size_t tets, uint64_t seed) {
    mesh_case c = allocate(points, tets);
    field_random r = {seed};
    for (size_t i = 0; i < points; i++) {
        for (int a = 0; a < 3; a++)
            c.points[i][a] = (float)(field_random_bits(&r) % 2000) * 0.001F - 1.0F;
        c.values[i] = (float)(field_random_bits(&r) % 1000);
        if (i > 0 && field_random_bits(&r) % 10 == 0)
            memcpy(c.points[i], c.points[i - 1], sizeof c.points[i]);
        if (field_random_bits(&r) % 100 == 0)
            c.values[i] = i % 2 ? NAN : INFINITY;
    }
    for (size_t t = 0; t < tets; t++) {
        const uint64_t first = field_random_bits(&r) % (points - 3);
        for (uint32_t k = 0; k < 4; k++)
            c.tets[t][k] = (uint32_t)first + (k + (uint32_t)t) % 4;
    }
    return c;
}

void mesh_cases_shuffle(mesh_case *c, uint64_t seed) {
    field_random r = {seed};
    uint32_t *to = malloc(c->point_count * sizeof *to);
    mesh_case before = allocate(c->point_count, 0);
    if (!to)
        abort();
    for (uint32_t i = 0; i < c->point_count; i++) {
        uint32_t k = (uint32_t)(field_random_bits(&r) % (i + 1));
        to[i] = to[k];
        to[k] = i;
    }
    memcpy(before.points, c->points, c->point_count * sizeof *c->points);
    memcpy(before.values, c->values, c->point_count * sizeof *c->values);
    for (size_t i = 0; i < c->point_count; i++) {
        memcpy(c->points[to[i]], before.points[i], sizeof c->points[i]);
        c->values[to[i]] = before.values[i];
    }
    for (size_t t = 0; t < c->tet_count; t++) {
        uint32_t tet[4];
        for (int k = 0; k < 4; k++)
            tet[k] = to[c->tets[t][(k + (int)(t % 4)) % 4]];
        const size_t other = field_random_bits(&r) % (t + 1);
        memcpy(c->tets[t], c->tets[other], sizeof tet);
        memcpy(c->tets[other], tet, sizeof tet);
    }
    mesh_cases_free(&before);
    free(to);
}

/* ---- converting ---- */

enum { CHUNK = 10007 };

static size_t chunk_at(size_t at, size_t count) {
    return count - at < CHUNK ? count - at : CHUNK;
}

static status give_points(const mesh_case *c, const mesh_sink *sink) {
    status st = ST_OK;
    for (size_t i = 0; st == ST_OK && i < c->point_count; i += CHUNK)
        st = sink->points(sink->ctx, i, chunk_at(i, c->point_count),
                          (const float(*)[3])(c->points + i));
    for (size_t i = 0; st == ST_OK && i < c->point_count; i += CHUNK)
        st = sink->values(sink->ctx, i, chunk_at(i, c->point_count), c->values + i);
    return st;
}

static status give_tets(const mesh_case *c, const mesh_sink *sink) {
    status st = ST_OK;
    for (size_t i = 0; st == ST_OK && i < c->tet_count; i += CHUNK)
        st = sink->tets(sink->ctx, chunk_at(i, c->tet_count), (const uint32_t(*)[4])(c->tets + i));
    return st;
}

status mesh_cases_convert(mem *m, const mesh_case *c, const char *name, int tets_first,
                          mesh_result *result) {
    const char *path = scratch_path(name);
    *result = (mesh_result){.report = {.field = "wavy"}};
    m->limit = (size_t)c->options.memory;
    mesh_gather g;
    mesh_gather_init(&g, m, path, m->limit / 2, NULL);
    const mesh_sink sink = mesh_gather_sink(&g);
    status st = tets_first ? give_tets(c, &sink) : give_points(c, &sink);
    if (st == ST_OK)
        st = tets_first ? give_points(c, &sink) : give_tets(c, &sink);
    if (st == ST_OK)
        return mesh_convert_gathered(m, &g, "case", path, &c->options, NULL, result);
    mesh_gather_release(&g);
    return st;
}
