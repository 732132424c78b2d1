#include "prep/resample/resample_cells.h"

#include "formats/leaf/hex_treelet.h"

const resample_cells *resample_cells_of(const leaf_file *f) {
    static const resample_cells *const rows[] = {&resample_tets, &resample_hexes};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        if (rows[i]->of ? rows[i]->of == f->geometry
                        : f->geometry->noded && f->geometry->noded->hexahedra)
            return rows[i];
    return NULL;
}
