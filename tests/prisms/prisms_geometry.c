#include <math.h>

#include "tests/prisms/prisms.h"

static const char *measure(const void *record, float box[6], float range[2]) {
    const prism *x = record;
    bool sound = x->z[0] < x->z[1] && isfinite(x->z[1] - x->z[0]) && x->value > 0.0f;
    for (int a = 0; a < 2; a++) {
        box[a] = fminf(fminf(x->base[0][a], x->base[1][a]), x->base[2][a]);
        box[a + 3] = fmaxf(fmaxf(x->base[0][a], x->base[1][a]), x->base[2][a]);
        for (int k = 0; k < 3; k++)
            sound = sound && isfinite(x->base[k][a]);
        sound = sound && box[a] < box[a + 3];
    }
    box[2] = x->z[0];
    box[5] = x->z[1];
    range[0] = 0.0f; /* that of the outside, as its surface is where the value steps */
    range[1] = x->value;
    return sound && isfinite(x->value) ? NULL : "none";
}

static const leaf_cells cells = {"prism", sizeof(prism), PRISMS_TREELET_MAX, measure};

const leaf_geometry prisms_geometry = LEAF_CELLS_GEOMETRY(&cells);
