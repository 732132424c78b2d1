#include "prep/import/exodus/exodus_averages.h"

#include <assert.h>
#include <stdio.h>

enum { CHUNK = 512 };

/* Add elements of a block. */
static status add_cells(exodus_averages *a, const exodus_block *block, int values, uint64_t first,
                        size_t count) {
    const size_t corners = (size_t)cell_shape_vertices(block->shape);
    uint32_t ids[CHUNK * CELL_VERTICES_MAX];
    double numbers[CHUNK];
    const size_t start[2] = {a->step, (size_t)first}, size[2] = {1, count};
    status st = exodus_block_cells(block, a->n, first, count, ids);
    if (st == ST_OK)
        st = exodus_numbers_read(a->n, values, 2, start, size, numbers);
    for (size_t i = 0; i < count && st == ST_OK; i++) {
        uint64_t wide[CELL_VERTICES_MAX];
        for (size_t c = 0; c < corners; c++)
            wide[c] = ids[i * corners + c];
        mesh_average_add(&a->sums, 0, block->shape, wide, numbers[i]);
    }
    return st;
}

static status add_block(exodus_averages *a, const exodus_block *block) {
    char name[64];
    snprintf(name, sizeof name, "vals_elem_var%ueb%llu", a->variable,
             (unsigned long long)block->number);
    const int values = exodus_numbers_find(a->n, name);
    status st = ST_OK;
    for (uint64_t i = 0; values >= 0 && i < block->cells && st == ST_OK; i += CHUNK)
        st = add_cells(a, block, values, i,
                       block->cells - i < CHUNK ? (size_t)(block->cells - i) : CHUNK);
    return st;
}

static status add_all(exodus_averages *a) {
    status st = ST_OK;
    for (size_t i = 0; i < a->blocks->count && st == ST_OK; i++)
        st = add_block(a, &a->blocks->of[i]);
    return st;
}

/* Go to the window that has a node. */
static status reach(exodus_averages *a, uint32_t variable, uint64_t node) {
    status st = ST_OK;
    if (a->variable != variable + 1) {
        exodus_averages_release(a);
        a->variable = variable + 1;
        st = mesh_average_begin_rounds(&a->sums, a->m, a->nodes, 1);
    } else if (node < a->sums.first + a->sums.count) {
        return ST_OK;
    } else {
        const bool more = mesh_average_next(&a->sums);
        assert(more && node == a->sums.first);
        (void)more;
    }
    return st == ST_OK ? add_all(a) : st;
}

status exodus_averages_read(exodus_averages *a, uint32_t variable, uint64_t first, size_t count,
                            float *to) {
    status st = ST_OK;
    for (size_t i = 0; i < count && st == ST_OK; i++) {
        st = reach(a, variable, first + i);
        if (st == ST_OK)
            to[i] = (float)mesh_average_value(&a->sums, 0, (size_t)(first + i - a->sums.first));
    }
    return st;
}

void exodus_averages_release(exodus_averages *a) {
    mesh_average_release(&a->sums);
    a->sums = (mesh_average){0};
    a->variable = 0;
}
