#include "render/experiments/hex_lattice.h"

#include <math.h>

#include "formats/base/vec3.h"

status hex_lattice_make(hex_lattice *l, mem *m, const uint32_t (*nodes)[3], uint32_t zones) {
    uint64_t total = 0, cells = 0;
    *l = (hex_lattice){.m = m, .zones = zones, .zone = mem_array(m, zones, sizeof *l->zone)};
    if (!l->zone)
        return ST_NOMEM;
    for (uint32_t i = 0; i < zones; i++) {
        const uint32_t *n = nodes[i];
        l->zone[i] = (hex_zone){.nodes = {n[0], n[1], n[2]},
                                .node = (uint32_t)total,
                                .cell = (uint32_t)cells,
                                .sense = 1};
        if ((double)n[0] * n[1] * n[2] + (double)total >= UINT32_MAX)
            return status_describe(ST_UNSUPPORTED, "a grid of 2^32 nodes or more");
        total += (uint64_t)n[0] * n[1] * n[2];
        cells += (uint64_t)(n[0] - 1) * (n[1] - 1) * (n[2] - 1);
    }
    l->nodes = (uint32_t)total;
    l->cells = (uint32_t)cells;
    l->node = mem_array(m, l->nodes, sizeof *l->node);
    l->normal = mem_array(m, l->nodes, sizeof *l->normal);
    l->there = mem_array(m, l->cells, 1);
    return l->node && l->normal && l->there ? ST_OK : ST_NOMEM;
}

void hex_lattice_free(hex_lattice *l) {
    mem_free(l->m, l->zone);
    mem_free(l->m, l->node);
    mem_free(l->m, l->normal);
    mem_free(l->m, l->there);
}

/* ---- senses ---- */

/* Of a cell, in its middle. */
static int sense_of(const hex_lattice *l, const uint32_t stride[3], uint32_t first) {
    double edge[3][3] = {{0.0}};
    for (int c = 0; c < HEX_CORNERS; c++) {
        const float *p = l->node[hex_lattice_corner(stride, first, c)];
        for (int k = 0; k < 3; k++)
            for (int a = 0; a < 3; a++)
                edge[k][a] += c >> k & 1 ? p[a] : -p[a];
    }
    const double det = vec3_det(edge[0], edge[1], edge[2]);
    return det > 0.0 ? 1 : det < 0.0 ? -1 : 0;
}

void hex_lattice_finish(hex_lattice *l) {
    for (uint32_t i = 0; i < l->zones; i++) {
        hex_zone *z = &l->zone[i];
        uint32_t stride[3], at[3];
        int64_t votes = 0;
        hex_lattice_strides(z, stride);
        for (at[2] = 0; at[2] + 1 < z->nodes[2]; at[2]++)
            for (at[1] = 0; at[1] + 1 < z->nodes[1]; at[1]++)
                for (at[0] = 0; at[0] + 1 < z->nodes[0]; at[0]++)
                    if (l->there[hex_lattice_cell(z, at)])
                        votes += sense_of(l, stride, hex_lattice_node(z, at));
        z->sense = votes < 0 ? -1 : 1;
    }
}

/* ---- normals ---- */

/* Differences along an axis by its unit, of place and value: central ones, one-sided where a
 * neighbour is none or has no value, 0 without any. */
static void differ(const hex_lattice *l, const hex_zone *z, const uint32_t at[3], int axis,
                   double out[4]) {
    const uint32_t n = hex_lattice_node(z, at);
    uint32_t stride[3], end[2] = {n, n};
    hex_lattice_strides(z, stride);
    if (at[axis] > 0 && !isnan(l->node[n - stride[axis]][3]))
        end[0] -= stride[axis];
    if (at[axis] + 1 < z->nodes[axis] && !isnan(l->node[n + stride[axis]][3]))
        end[1] += stride[axis];
    const double share = end[1] - end[0] > stride[axis] ? 0.5 : 1.0;
    for (int a = 0; a < 4; a++)
        out[a] = share * ((double)l->node[end[1]][a] - l->node[end[0]][a]);
}

/* The sum of the columns, or of the rows of the inverse but for its determinant's modulus. */
static void combine(double d[3][4], hex_normals how, double out[3]) {
    double row[3][3], det = 1.0;
    for (int k = 0; k < 3; k++)
        if (how == HEX_NORMALS_INVERSE)
            vec3_cross(d[(k + 1) % 3], d[(k + 2) % 3], row[k]);
        else
            vec3_sub(d[k], (double[3]){0.0}, row[k]);
    if (how == HEX_NORMALS_INVERSE)
        det = vec3_dot(d[0], row[0]) < 0.0 ? -1.0 : 1.0;
    for (int a = 0; a < 3; a++)
        out[a] = -det * (d[0][3] * row[0][a] + d[1][3] * row[1][a] + d[2][3] * row[2][a]);
}

void hex_lattice_normals(hex_lattice *l, hex_normals how) {
    for (uint32_t i = 0; i < l->zones; i++) {
        const hex_zone *z = &l->zone[i];
        uint32_t at[3];
        for (at[2] = 0; at[2] < z->nodes[2]; at[2]++)
            for (at[1] = 0; at[1] < z->nodes[1]; at[1]++)
                for (at[0] = 0; at[0] < z->nodes[0]; at[0]++) {
                    double d[3][4], normal[3], unit[3] = {0.0};
                    for (int a = 0; a < 3; a++)
                        differ(l, z, at, a, d[a]);
                    combine(d, how, normal);
                    (void)vec3_unit(normal, unit);
                    for (int a = 0; a < 3; a++)
                        l->normal[hex_lattice_node(z, at)][a] = (float)unit[a];
                }
    }
}
