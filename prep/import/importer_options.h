/* importer_options.h - the options of every importer, as rows of argp: first those of its own. */
#ifndef PREP_IMPORT_IMPORTER_OPTIONS_H
#define PREP_IMPORT_IMPORTER_OPTIONS_H

#include <argp.h>

#include "formats/base/cli_options.h"

/* Keys of an importer's own options begin at IMPORT_KEY_OWN. */
enum {
    IMPORT_KEY_FIELD = 0x2000,
    IMPORT_KEY_COMPONENT,
    IMPORT_KEY_STEP,
    IMPORT_KEY_LIST,
    IMPORT_KEY_TILES,
    IMPORT_KEY_OWN
};

/* The end of an importer's table; a format without steps or components leaves their rows out. Who
 * asks for tiles can read a tile_stream.h where the importer has one. */
#define IMPORT_FIELD(what)                              \
    {                                                   \
        "field", IMPORT_KEY_FIELD, "NAME", CLI_BASIC,   \
            "the " what " to take (default: the first " \
            "that can be read)",                        \
            0                                           \
    }
#define IMPORT_COMPONENT                                                                  \
    {                                                                                     \
        "component", IMPORT_KEY_COMPONENT, "N", 0,                                        \
            "of vectors and colours: 1, 2, ..; default: their magnitude, or luminance", 0 \
    }
#define IMPORT_STEP \
    { "step", IMPORT_KEY_STEP, "N", 0, "the time step to take (default: the first, 0)", 0 }
#define IMPORT_LIST(what) \
    { "list", IMPORT_KEY_LIST, NULL, CLI_BASIC, "print what " what " there are; write nothing", 0 }
#define IMPORT_END                                                        \
    {"tiles", IMPORT_KEY_TILES, NULL, OPTION_HIDDEN, "for convert", 0}, { \
        NULL, 0, NULL, 0, NULL, 0                                         \
    }

#endif
