#include "render/bench/bench_hex_errors.h"

#include <math.h>
#include <stdlib.h>

#include "formats/base/vec3.h"

void bench_hex_errors_init(bench_hex_errors *e, mem *m) {
    *e = (bench_hex_errors){.m = m};
}

void bench_hex_errors_free(bench_hex_errors *e) {
    for (int i = 0; i < BENCH_HEX_LISTS; i++)
        mem_free(e->m, e->list[i].error);
}

static status add(bench_hex_errors *e, int which, double error) {
    bench_hex_list *to = &e->list[which];
    const status st = mem_grow(e->m, &to->error, sizeof(double), to->count, 4096, &to->room);
    if (st == ST_OK)
        to->error[to->count++] = error;
    return st;
}

/* The mean of its twelve edges. */
static double edge_of(const hex_lattice *l, uint32_t zone, uint32_t cell) {
    const hex_zone *z = &l->zone[zone];
    const uint32_t *n = z->nodes, i = cell - z->cell;
    const uint32_t at[3] = {i % (n[0] - 1), i / (n[0] - 1) % (n[1] - 1),
                            i / ((n[0] - 1) * (n[1] - 1))};
    uint32_t stride[3];
    double sum = 0.0;
    hex_lattice_strides(z, stride);
    for (int a = 0; a < 3; a++)
        for (int c = 0; c < HEX_CORNERS; c++) {
            const uint32_t first = hex_lattice_node(z, at);
            const float *p = l->node[hex_lattice_corner(stride, first, c)],
                        *q = l->node[hex_lattice_corner(stride, first, c ^ 1 << a)];
            sum += vec3_length((double[3]){q[0] - p[0], q[1] - p[1], q[2] - p[2]});
        }
    return sum / 24.0; /* each edge twice */
}

static uint32_t zone_of(const hex_lattice *l, uint32_t cell) {
    uint32_t z = l->zones - 1;
    while (l->zone[z].cell > cell)
        z--;
    return z;
}

/* In degrees; 180 without a normal. */
static double angle_between(const double a[3], const float b[3]) {
    const double cosine = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    return vec3_size(a) > 0.0
               ? acos(real_max(-1.0, real_min(1.0, cosine))) * (180.0 / 3.14159265358979324)
               : 180.0;
}

status bench_hex_errors_add(bench_hex_errors *e, const hex_lattice *l, hex_normals how,
                            const leafcast_ray_hit *exact, const hex_surface *found) {
    const bool hits = isfinite(exact->t), first = how == HEX_NORMALS_COLUMNS;
    if (first) {
        e->hits += found->found;
        e->missed += hits && !found->found;
        e->made_up += !hits && found->found;
    }
    if (!hits || !found->found)
        return ST_OK;
    status st = ST_OK;
    if (first)
        st = add(e, BENCH_HEX_DISTANCE,
                 fabs(found->t - exact->t) / edge_of(l, zone_of(l, found->cell), found->cell));
    return st == ST_OK ? add(e, first ? BENCH_HEX_COLUMNS : BENCH_HEX_INVERSE,
                             angle_between(found->normal, exact->normal))
                       : st;
}

/* ---- rows ---- */

static int ascending(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void add_list(bench_hex_list *l, const char *format, bool worst, bench_table *table) {
    double sum = 0.0;
    for (size_t i = 0; i < l->count; i++)
        sum += l->error[i];
    if (l->count > 0)
        qsort(l->error, l->count, sizeof *l->error, ascending);
    const size_t last = l->count > 0 ? l->count - 1 : 0;
    bench_table_add(table, format, l->count > 0 ? sum / (double)l->count : 0.0);
    bench_table_add(table, format, l->count > 0 ? l->error[(size_t)(0.99 * (double)last)] : 0.0);
    if (worst)
        bench_table_add(table, format, l->count > 0 ? l->error[last] : 0.0);
}

void bench_hex_errors_row(bench_hex_errors *e, bool any, bench_table *table) {
    for (int i = 0; i < 10 && !any; i++)
        bench_table_add(table, "-");
    if (!any)
        return;
    bench_table_add(table, "%llu", (unsigned long long)e->missed);
    bench_table_add(table, "%llu", (unsigned long long)e->made_up);
    add_list(&e->list[BENCH_HEX_DISTANCE], "%.5f", true, table);
    add_list(&e->list[BENCH_HEX_COLUMNS], "%.3f", true, table);
    add_list(&e->list[BENCH_HEX_INVERSE], "%.3f", false, table);
}
