#include "prep/grid/convert_notes.h"

#include <math.h>
#include <string.h>

#include "formats/base/num.h"

#define DEGREE 111195.0 /* metres of latitude on a ball of the earth's mean radius */
#define FOOT   0.3048

/* Returns the extent of a grid along world axis a. The grid's axis a must be parallel to it. */
static double extent(const grid *g, int a) {
    const uint32_t last = g->dims[a] - 1;
    const double steps = g->axis[a] ? g->axis[a][last] - g->axis[a][0] : last;
    return fabs(g->to_world[a][a]) * steps;
}

static void note_units(const cli_common *common, const grid *g) {
    const char *across = g->frame.unit[0], *up = g->frame.unit[2];
    const bool angles = strncmp(across, "degree", 6) == 0 && strncmp(up, "degree", 6) == 0;
    const double wide = fmax(extent(g, 0), extent(g, 1)), high = extent(g, 2);
    if (!across[0] || !up[0] || strcmp(across, up) == 0 || angles || !(high > 0))
        return;
    cli_note(common, 1,
             "%s: %s along x stand beside %s along z, %g wide and %g high: --exaggerate=%.1g makes "
             "it half as high as wide",
             common->input, across, up, wide, high, wide / high / 2);
}

/* Elevations have no extent yet, but a degree of latitude has. */
static void note_degrees(const cli_common *common, const grid *g) {
    const bool feet = strstr(g->frame.unit[2], "ft") != NULL;
    if (strncmp(g->frame.unit[0], "degree", 6) != 0 || strncmp(g->frame.unit[2], "degree", 6) == 0)
        return;
    cli_note(common, 1,
             "%s: degrees across stand beside elevations in %s: --exaggerate=%.2g shows them in "
             "proportion, as a degree of latitude is 111 km",
             common->input, feet ? "feet" : "metres", (feet ? FOOT : 1.0) / DEGREE);
}

void convert_note_grid(const cli_common *common, const grid *g, bool exaggerated) {
    if (g->note[0])
        cli_note(common, 1, "%s: %s", common->input, g->note);
    if (!exaggerated)
        (g->heights ? note_degrees : note_units)(common, g);
}

/* The value is printed in the form that --missing takes. That is compared in the samples' own
 * precision: a float's, or that of a double written in few digits. */
void convert_note_marker(const cli_common *common, const histogram_marker *m) {
    char value[NUM_TEXT_MAX];
    if (m->share == 0.0)
        return;
    cli_note(common, 0,
             "%s: %.3g %% of the samples are %s, others %g .. %g; if that stands for no data, "
             "--missing=%s says so",
             common->input, 100.0 * m->share, num_print_float((float)m->value, value), m->others[0],
             m->others[1], value);
}
