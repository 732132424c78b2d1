/* plot3d_options.h - options that say what goes with a grid of PLOT3D, which does not say it
 * itself: for verbs that open inputs. With any of them the input is one
 * (curvilinear_input_is_asked()).
 */
#ifndef FORMATS_PLOT3D_OPTIONS_H
#define FORMATS_PLOT3D_OPTIONS_H

#include <argp.h>

#include "formats/base/status.h"
#include "formats/curvilinear/curvilinear_hints.h"

enum { PLOT3D_KEY_SOLUTION = 0x3100, PLOT3D_KEY_FUNCTIONS, PLOT3D_KEY_LAYOUT };

/* The three rows for a table of options. */
#define PLOT3D_OPTIONS(group)                                                             \
    {"solution",                                                                          \
     PLOT3D_KEY_SOLUTION,                                                                 \
     "FILE",                                                                              \
     0,                                                                                   \
     "with a grid of PLOT3D: its solution (Q), whose functions are the fields: density, " \
     "momentum, energy, velocity, pressure, ..; several, or a pattern: time steps",       \
     group},                                                                              \
        {"functions",                                                                     \
         PLOT3D_KEY_FUNCTIONS,                                                            \
         "FILE",                                                                          \
         0,                                                                               \
         "with a grid of PLOT3D: its file of functions, which are fields too; likewise",  \
         group},                                                                          \
    {                                                                                     \
        "plot3d", PLOT3D_KEY_LAYOUT, "WORDS", 0,                                          \
            "the input is PLOT3D, and written so: words such as "                         \
            "records,big,f64,blanks,multi,planes",                                        \
            group                                                                         \
    }

/* plot3d_option() - set one of these options. ST_AGAIN: the key is none of them.
 * plot3d_options_release() - free what they have set. */
static inline status plot3d_option(curvilinear_hints *h, int key, const char *text) {
    switch (key) {
    case PLOT3D_KEY_SOLUTION: return path_list_add(&h->solutions, text);
    case PLOT3D_KEY_FUNCTIONS: return path_list_add(&h->functions, text);
    case PLOT3D_KEY_LAYOUT: h->layout = text; return ST_OK;
    default: return ST_AGAIN;
    }
}

static inline void plot3d_options_release(curvilinear_hints *h) {
    path_list_release(&h->solutions);
    path_list_release(&h->functions);
}

#endif
