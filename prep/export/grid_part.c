#include "prep/export/grid_part.h"

#include <math.h>
#include <string.h>

#include "formats/base/text.h"

static status check_box(const leaf_level *l, const uint32_t box[6]) {
    for (int a = 0; a < 3; a++)
        if (box[a] > box[a + 3] || box[a + 3] >= l->dims[a])
            return status_describe(ST_USAGE,
                                   "--box: %u to %u along %c: expected the first and the last "
                                   "sample, of 0 to %u",
                                   box[a], box[a + 3], "xyz"[a], l -> dims[a] - 1);
    return ST_OK;
}

status grid_part_of(const leaf_file *f, uint32_t level, const uint32_t box[6], grid_part *part) {
    status st = leaf_file_check_level(f, level);
    if (st != ST_OK)
        return st;
    const leaf_level *l = &f->layout.level[level];
    *part = (grid_part){.level = level};
    memcpy(part->end, l->dims, sizeof part->end);
    if (!box)
        return ST_OK;
    for (int a = 0; a < 3; a++) {
        part->lo[a] = box[a];
        part->end[a] = box[a + 3] + 1;
    }
    return check_box(l, box);
}

double grid_part_at(const leaf_file *f, uint32_t level, int axis, uint32_t node) {
    const double *at = f->axis[axis];
    const uint64_t last = f->layout.level[0].cells[axis], fine = (uint64_t)node << level;
    if (fine <= last)
        return at[fine];
    return at[last] + (double)(fine - last) * (at[last] - at[last - 1]);
}

static status copy_axes(mem *m, const leaf_file *f, const grid_part *part, grid *g) {
    for (int a = 0; a < 3; a++) {
        g->axis[a] = mem_array(m, g->dims[a], sizeof(double));
        if (!g->axis[a])
            return ST_NOMEM;
        for (uint32_t i = 0; i < g->dims[a]; i++)
            g->axis[a][i] = grid_part_at(f, part->level, a, part->lo[a] + i);
    }
    return ST_OK;
}

/* Set the part's map to the world. Its nodes are counted from the part's corner. */
static void put_map(const leaf_file *f, const grid_part *part, grid *g) {
    const double *map = f->header.to_world;
    const double apart = ldexp(1, (int)part->level);
    for (int row = 0; row < 3; row++) {
        g->to_world[row][3] = map[4 * row + 3];
        for (int a = 0; a < 3; a++) {
            g->to_world[row][a] = map[4 * row + a] * apart;
            g->to_world[row][3] += g->to_world[row][a] * part->lo[a];
        }
    }
}

status grid_part_describe(mem *m, const leaf_file *f, const grid_part *part, grid *g) {
    uint32_t dims[3];
    for (int a = 0; a < 3; a++)
        dims[a] = part->end[a] - part->lo[a];
    grid_init(g, dims, f->layout.type);
    text_name(g->name, sizeof g->name, f->header.name);
    g->frame = f->frame;
    if (!f->header.rectilinear) {
        put_map(f, part, g);
        return ST_OK;
    }
    memcpy(g->to_world, f->header.to_world, sizeof g->to_world);
    return copy_axes(m, f, part, g);
}
