/* curvilinear_options.h - options that make an input a curvilinear grid, for verbs that open
 * inputs: what goes with a grid of PLOT3D, which does not say it itself; and where the nodes of
 * netCDF go. With any of them the input is one (curvilinear_input_is_asked()).
 */
#ifndef FORMATS_CURVILINEAR_OPTIONS_H
#define FORMATS_CURVILINEAR_OPTIONS_H

#include <argp.h>

#include "formats/base/cli_value.h"
#include "formats/base/status.h"
#include "formats/curvilinear/curvilinear_hints.h"

enum {
    CURVILINEAR_KEY_SOLUTION = 0x3100,
    CURVILINEAR_KEY_FUNCTIONS,
    CURVILINEAR_KEY_LAYOUT,
    CURVILINEAR_KEY_TO
};

#define CURVILINEAR_PLACES "cartesian|sphere"

/* The rows for a table of options. */
#define CURVILINEAR_OPTIONS(group)                                                          \
    {"to",                                                                                  \
     CURVILINEAR_KEY_TO,                                                                    \
     CURVILINEAR_PLACES,                                                                    \
     0,                                                                                     \
     "netCDF as a curvilinear grid: its nodes lie where longitudes, latitudes and heights " \
     "say, on a plane or on a globe",                                                       \
     group},                                                                                \
        {"solution",                                                                        \
         CURVILINEAR_KEY_SOLUTION,                                                          \
         "FILE",                                                                            \
         0,                                                                                 \
         "with a grid of PLOT3D: its solution (Q), whose functions are the fields: "        \
         "density, momentum, energy, velocity, pressure, ..; several, or a pattern: time "  \
         "steps",                                                                           \
         group},                                                                            \
        {"functions",                                                                       \
         CURVILINEAR_KEY_FUNCTIONS,                                                         \
         "FILE",                                                                            \
         0,                                                                                 \
         "with a grid of PLOT3D: its file of functions, which are fields too; likewise",    \
         group},                                                                            \
    {                                                                                       \
        "plot3d", CURVILINEAR_KEY_LAYOUT, "WORDS", 0,                                       \
            "the input is PLOT3D, and written so: words such as "                           \
            "records,big,f64,blanks,multi,planes",                                          \
            group                                                                           \
    }

/* curvilinear_option() - set one of these options. ST_AGAIN: the key is none of them.
 * curvilinear_options_release() - free what they have set. */
static inline status curvilinear_option(curvilinear_hints *h, int key, const char *text) {
    int word;
    switch (key) {
    case CURVILINEAR_KEY_SOLUTION: return path_list_add(&h->solutions, text);
    case CURVILINEAR_KEY_FUNCTIONS: return path_list_add(&h->functions, text);
    case CURVILINEAR_KEY_LAYOUT: h->layout = text; return ST_OK;
    case CURVILINEAR_KEY_TO: h->to = text; return cli_word(text, "--to", CURVILINEAR_PLACES, &word);
    default: return ST_AGAIN;
    }
}

static inline void curvilinear_options_release(curvilinear_hints *h) {
    path_list_release(&h->solutions);
    path_list_release(&h->functions);
}

#endif
