#include "prep/import/minc.h"

#include <math.h>
#include <string.h>

int minc_space(const char *name) {
    return strlen(name) == 6 && strcmp(name + 1, "space") == 0 && name[0] >= 'x' && name[0] <= 'z'
               ? name[0] - 'x'
               : -1;
}

minc_dimension minc_usual(int space) {
    minc_dimension d = {.step = 1};
    d.cosines[space] = 1;
    return d;
}

void minc_place(const minc_dimension d[3], grid *g) {
    world_frame_set(&g->frame, WORLD_RAS, "mm");
    for (int row = 0; row < 3; row++) {
        g->to_world[row][3] = 0;
        for (int a = 0; a < 3; a++) {
            g->to_world[row][a] = d[a].cosines[row] * d[a].step;
            g->to_world[row][3] += d[a].cosines[row] * d[a].start;
        }
    }
}

void minc_range(sample_type stored, const double told[2], double range[2]) {
    const bool plus = stored == SAMPLE_U8 || stored == SAMPLE_U16 || stored == SAMPLE_U32;
    const double numbers = (double)(1ull << (8 * sample_size(stored)));
    const double least = plus ? 0.0 : -numbers / 2, most = least + numbers - 1;
    const double a = isnan(told[0]) ? least : told[0], b = isnan(told[1]) ? most : told[1];
    range[0] = fmin(a, b);
    range[1] = fmax(a, b);
}

void minc_scale(const double valid[2], double least, double most, double *scale, double *offset) {
    *scale = valid[1] > valid[0] ? (most - least) / (valid[1] - valid[0]) : 0;
    *offset = least - valid[0] * *scale;
}
