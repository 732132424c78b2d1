#include <math.h>

#include "tests/spheres/spheres.h"

/* A float beyond x: rounding never brings a ball's rim out of its box. */
static float beyond(double x, float towards) {
    return nextafterf(nextafterf((float)x, towards), towards);
}

static const char *measure(const void *record, float box[6], float range[2]) {
    const sphere *x = record;
    bool sound = x->radius >= SPHERES_RADIUS_MIN && isfinite(x->radius) && x->peak > 0.0;
    for (int a = 0; a < 3; a++) {
        sound = sound && isfinite(x->centre[a]);
        box[a] = beyond(x->centre[a] - x->radius, -INFINITY);
        box[a + 3] = beyond(x->centre[a] + x->radius, INFINITY);
    }
    range[0] = 0.0f;
    range[1] = beyond(x->peak, INFINITY);
    return sound && isfinite(range[1]) ? NULL : "none";
}

static const leaf_cells cells = {"sphere", sizeof(sphere), SPHERES_TREELET_MAX, measure};

const leaf_geometry spheres_geometry = LEAF_CELLS_GEOMETRY(&cells);
