#include "render/grid/level_planes.h"

static double coordinate(const leaf_file *f, int a, uint64_t node) {
    const double *axis = f->axis[a];
    const uint64_t last = f->layout.level[0].cells[a];
    if (node <= last)
        return axis[node];
    return axis[last] + (double)(node - last) * (axis[last] - axis[last - 1]);
}

status level_planes_init(level_planes_table *table, mem *m, const leaf_file *f) {
    const leaf_layout *layout = &f->layout;
    size_t doubles = 0;
    for (uint32_t l = 0; l < layout->levels; l++)
        for (int a = 0; a < 3; a++)
            doubles += 3 * (((size_t)layout->level[l].treelets[a] << layout->cells_log2) + 1);
    table->m = m;
    table->block = mem_array(m, doubles, sizeof *table->block);
    if (!table->block)
        return ST_NOMEM;
    double *next = table->block;
    for (uint32_t l = 0; l < layout->levels; l++) {
        for (int a = 0; a < 3; a++) {
            const size_t cells = (size_t)layout->level[l].treelets[a] << layout->cells_log2;
            double *at = next, *inverse = at + cells + 1, *central = inverse + cells + 1;
            next = central + cells + 1;
            for (size_t i = 0; i <= cells; i++)
                at[i] = coordinate(f, a, (uint64_t)i << l);
            for (size_t i = 0; i < cells; i++)
                inverse[i] = 1.0 / (at[i + 1] - at[i]);
            const size_t last = layout->level[l].cells[a];
            for (size_t i = 0; i <= last; i++)
                central[i] = 1.0 / (at[i < last ? i + 1 : i] - at[i > 0 ? i - 1 : i]);
            table->levels[l].at[a] = at;
            table->levels[l].inverse[a] = inverse;
            table->levels[l].central[a] = central;
            table->levels[l].cells[a] = layout->level[l].cells[a];
        }
    }
    return ST_OK;
}

void level_planes_release(level_planes_table *table) {
    mem_free(table->m, table->block);
    table->block = NULL;
}
