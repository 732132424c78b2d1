#include "tests/support/mixed_file.h"
#include "prep/mesh/mixed_treelet.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

typedef struct node {
    double p[3], value;
    uint32_t number;
} node;

static int by_place(const void *a, const void *b) {
    const node *x = a, *y = b;
    for (int i = 0; i < 3; i++)
        if (x->p[i] != y->p[i])
            return x->p[i] < y->p[i] ? -1 : 1;
    return (x->value > y->value) - (x->value < y->value);
}

static node node_of(const cell_mix_cell *c, int vertex) {
    return (node){{c->p[vertex][0], c->p[vertex][1], c->p[vertex][2]}, c->value[vertex], 0};
}

bool mixed_file_keeps(const cell_mix_cell *c) {
    int different = 0;
    for (int i = 0; i < cell_shape_vertices(c->shape); i++) {
        const node x = node_of(c, i);
        bool is_new = true;
        for (int k = 0; k < i; k++) {
            const node y = node_of(c, k);
            is_new = is_new && by_place(&x, &y) != 0;
        }
        different += is_new;
    }
    return different >= 4;
}

/* All nodes, each once, numbered in order. */
static node *list_nodes(const cell_mix_cell *cells, int count, uint32_t *nodes) {
    node *all = malloc((size_t)count * HEX_CORNERS * sizeof *all);
    size_t n = 0, kept = 0;
    assert_non_null(all);
    for (int i = 0; i < count; i++)
        for (int v = 0; v < cell_shape_vertices(cells[i].shape); v++)
            all[n++] = node_of(&cells[i], v);
    qsort(all, n, sizeof *all, by_place);
    for (size_t i = 0; i < n; i++)
        if (kept == 0 || by_place(&all[kept - 1], &all[i]) != 0)
            all[kept++] = all[i];
    for (size_t i = 0; i < kept; i++)
        all[i].number = (uint32_t)i;
    *nodes = (uint32_t)kept;
    return all;
}

static void write_cells(FILE *f, const cell_mix_cell *cells, int count, const node *all,
                        uint32_t nodes) {
    static const int types[CELL_SHAPES] = {12, 13, 14, 11, 10};
    int ids = 0;
    for (int i = 0; i < count; i++)
        ids += 1 + cell_shape_vertices(cells[i].shape);
    fprintf(f, "CELLS %d %d\n", count, ids);
    for (int i = 0; i < count; i++) {
        const int vertices = cell_shape_vertices(cells[i].shape);
        fprintf(f, "%d", vertices);
        for (int v = 0; v < vertices; v++) {
            const node key = node_of(&cells[i], v);
            const node *found = bsearch(&key, all, nodes, sizeof *all, by_place);
            assert_non_null(found);
            fprintf(f, " %u", found->number);
        }
        fputc('\n', f);
    }
    fprintf(f, "CELL_TYPES %d\n", count);
    for (int i = 0; i < count; i++)
        fprintf(f, "%d\n", types[cells[i].shape]);
}

uint32_t mixed_file_write(const cell_mix_cell *cells, int count, const char *path) {
    uint32_t nodes;
    node *all = list_nodes(cells, count, &nodes);
    FILE *f = fopen(path, "w");
    assert_non_null(f);
    fprintf(f, "# vtk DataFile Version 3.0\nmixed\nASCII\nDATASET UNSTRUCTURED_GRID\n");
    fprintf(f, "POINTS %u float\n", nodes);
    for (uint32_t i = 0; i < nodes; i++)
        fprintf(f, "%.9g %.9g %.9g\n", all[i].p[0], all[i].p[1], all[i].p[2]);
    write_cells(f, cells, count, all, nodes);
    fprintf(f, "POINT_DATA %u\nSCALARS f float 1\nLOOKUP_TABLE default\n", nodes);
    for (uint32_t i = 0; i < nodes; i++)
        fprintf(f, "%.9g\n", all[i].value);
    assert_int_equal(fclose(f), 0);
    free(all);
    return nodes;
}

void mixed_file_convert(const char *input, const char *output, uint32_t treelet_cells,
                        uint64_t memory, mesh_result *result) {
    mem m;
    mesh_input *x = NULL;
    mesh_options o = mesh_options_default();
    o.cells = &mixed_treelets;
    o.force = true;
    o.treelet_tets = treelet_cells;
    o.memory = memory;
    o.threads = 2;
    o.file.histograms = true;
    mem_init(&m, memory);
    assert_int_equal(mesh_input_open(&m, input, NULL, &x), ST_OK);
    assert_int_equal(mesh_convert_run(&m, x, output, &o, NULL, result), ST_OK);
    mesh_input_close(x);
    assert_int_equal(mem_used(&m), 0);
}
