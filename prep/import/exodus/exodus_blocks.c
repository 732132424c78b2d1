#include "prep/import/exodus/exodus_blocks.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "prep/import/import_mesh.h"

enum { TET_NODES = 4, NODES_MAX = 64, READ_IDS = 2048 };

/* ---- shapes ---- */

/* Elements are called by their shape, with or without the number of their nodes: HEX, HEX8, HEX20.
 * Of what is in the mesh beside its volumes nothing is drawn. */
static const struct {
    const char *begins;
    bool volume;
    cell_shape shape;
} names[] = {
    {"hex", true, CELL_HEXAHEDRON}, {"tet", true, CELL_TET},     {"wedge", true, CELL_WEDGE},
    {"pyr", true, CELL_PYRAMID},    {"shell", false, CELL_TET},  {"quad", false, CELL_TET},
    {"tri", false, CELL_TET},       {"bar", false, CELL_TET},    {"beam", false, CELL_TET},
    {"truss", false, CELL_TET},     {"rod", false, CELL_TET},    {"edge", false, CELL_TET},
    {"sphere", false, CELL_TET},    {"circle", false, CELL_TET}, {"point", false, CELL_TET},
    {"nsided", false, CELL_TET},    {"super", false, CELL_TET},  {"null", false, CELL_TET},
};
enum { NAMES = sizeof names / sizeof *names };

static int find_name(const char *type) {
    for (int i = 0; i < NAMES; i++)
        if (strncasecmp(type, names[i].begins, strlen(names[i].begins)) == 0)
            return i;
    return -1;
}

/* ---- the blocks ---- */

static status refuse(const exodus_numbers *n, uint64_t block, const char *type, size_t nodes,
                     const char *why) {
    return status_describe(ST_UNSUPPORTED,
                           "%s: block %llu (counted from 1) has elements %.32s of %zu nodes%s",
                           n->path, (unsigned long long)block, type, nodes, why);
}

static status add_block(const exodus_numbers *n, uint64_t number, int connect, bool by_corners,
                        exodus_blocks *b) {
    char text[64], type[64];
    exodus_block block = {.number = number, .connect = connect};
    snprintf(text, sizeof text, "num_el_in_blk%llu", (unsigned long long)number);
    block.cells = exodus_numbers_dim(n, text);
    snprintf(text, sizeof text, "num_nod_per_el%llu", (unsigned long long)number);
    block.nodes = (size_t)exodus_numbers_dim(n, text);
    netcdf_text(n->id, connect, "elem_type", type, sizeof type);
    const int name = find_name(type);
    if (block.cells == 0)
        return ST_OK;
    if (name < 0 && block.nodes >= TET_NODES)
        return refuse(n, number, *type ? type : "(not said)", block.nodes,
                      ", expected hexahedra, wedges, pyramids or tets");
    if (name < 0 || !names[name].volume) {
        b->skipped += block.cells;
        return ST_OK;
    }
    block.shape = import_mesh_shape(names[name].shape, block.nodes, by_corners);
    const size_t corners = (size_t)cell_shape_vertices(block.shape);
    if (block.nodes < corners || block.nodes > NODES_MAX)
        return refuse(n, number, type, block.nodes, ", which no such element has");
    if (block.nodes > corners && !by_corners)
        return refuse(n, number, type, block.nodes,
                      ": higher order (--by-corners takes it as a linear one)");
    status st = mem_grow(b->m, &b->of, sizeof *b->of, b->count, 16, &b->room);
    if (st != ST_OK)
        return st;
    b->of[b->count++] = block;
    b->cells[block.shape] += block.cells;
    b->higher += block.nodes > corners ? block.cells : 0;
    return ST_OK;
}

static uint64_t count_all(const exodus_blocks *b) {
    uint64_t all = b->skipped;
    for (int i = 0; i < CELL_SHAPES; i++)
        all += b->cells[i];
    return all;
}

status exodus_blocks_read(mem *m, const exodus_numbers *n, bool by_corners, exodus_blocks *b) {
    const uint64_t count = exodus_numbers_dim(n, "num_el_blk");
    const uint64_t all = exodus_numbers_dim(n, "num_elem");
    *b = (exodus_blocks){.m = m};
    status st = ST_OK;
    if (all > MESH_STREAM_CELLS_MAX)
        st = status_describe(ST_UNSUPPORTED, "%s: %llu elements, at most %llu are read", n->path,
                             (unsigned long long)all, (unsigned long long)MESH_STREAM_CELLS_MAX);
    for (uint64_t i = 1; i <= count && st == ST_OK; i++) {
        char text[64];
        snprintf(text, sizeof text, "connect%llu", (unsigned long long)i);
        const int connect = exodus_numbers_find(n, text);
        snprintf(text, sizeof text, "fbconn%llu", (unsigned long long)i);
        if (exodus_numbers_find(n, text) >= 0)
            st = status_describe(ST_UNSUPPORTED,
                                 "%s: block %llu (counted from 1) has polyhedra (nfaced)", n->path,
                                 (unsigned long long)i);
        else if (connect >= 0) /* blocks without elements have none */
            st = add_block(n, i, connect, by_corners, b);
        if (st == ST_OK && count_all(b) > all)
            st = status_describe(ST_CORRUPT, "%s: its blocks have more elements than num_elem",
                                 n->path);
    }
    return st;
}

void exodus_blocks_release(exodus_blocks *b) {
    mem_free(b->m, b->of);
}

/* ---- elements ---- */

status exodus_block_cells(const exodus_block *block, exodus_numbers *n, uint64_t first,
                          size_t count, uint32_t *ids) {
    const size_t corners = (size_t)cell_shape_vertices(block->shape);
    int64_t numbers[READ_IDS];
    const size_t most = READ_IDS / block->nodes;
    status st = ST_OK;
    for (size_t i = 0, some; i < count && st == ST_OK; i += some) {
        some = count - i < most ? count - i : most;
        const size_t start[2] = {(size_t)first + i, 0}, size[2] = {some, block->nodes};
        st = exodus_numbers_cells(n, block->connect, start, size, numbers);
        for (size_t e = 0; e < some && st == ST_OK; e++)
            for (size_t c = 0; c < corners; c++) {
                const int64_t id = numbers[e * block->nodes + c];
                ids[(i + e) * corners + c] =
                    id >= 1 && id <= UINT32_MAX ? (uint32_t)(id - 1) : UINT32_MAX; /* from 1 */
            }
    }
    return st;
}

status exodus_blocks_cells(const exodus_blocks *b, exodus_numbers *n, cell_shape shape,
                           uint64_t first, size_t count, uint32_t *ids) {
    const size_t corners = (size_t)cell_shape_vertices(shape);
    uint64_t begin = 0;
    status st = ST_OK;
    for (size_t i = 0; i < b->count && count > 0 && st == ST_OK; i++) {
        const exodus_block *block = &b->of[i];
        if (block->shape != shape)
            continue;
        if (first < begin + block->cells) {
            const uint64_t left = begin + block->cells - first;
            const size_t some = left < count ? (size_t)left : count;
            st = exodus_block_cells(block, n, first - begin, some, ids);
            ids += some * corners;
            first += some;
            count -= some;
        }
        begin += block->cells;
    }
    return st;
}
