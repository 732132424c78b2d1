/* world_options.h - the flag --axes of render, probe and slice: which way the world's axes
 * point. */
#ifndef RENDER_APP_WORLD_OPTIONS_H
#define RENDER_APP_WORLD_OPTIONS_H

#include <argp.h>

#include "formats/base/cli_value.h"
#include "render/leafcast.h"

enum { WORLD_OPTION_KEY = 0x3f00 };

#define WORLD_OPTION(group)                                                                       \
    {                                                                                             \
        "axes", WORLD_OPTION_KEY, "LPS|RAS", 0,                                                   \
            "turn what says that its axes are RAS, or LPS, into this world: of the picture, and " \
            "of all points that are given (as the first file has it)",                            \
            group                                                                                 \
    }

static inline status world_option_set(const char *text, leafcast_axes *out) {
    int which = 0;
    status st = cli_word(text, "--axes", "LPS|RAS", &which);
    *out = which == 0 ? LEAFCAST_AXES_LPS : LEAFCAST_AXES_RAS;
    return st;
}

#endif
