/* importer_options.h - the options of every importer, as rows of argp: first those of its own. */
#ifndef PREP_IMPORT_IMPORTER_OPTIONS_H
#define PREP_IMPORT_IMPORTER_OPTIONS_H

#include <argp.h>

#include "formats/base/cli_options.h"
#include "formats/trust_options.h"

/* Keys of an importer's own options begin at IMPORT_KEY_OWN. */
enum {
    IMPORT_KEY_FIELD = 0x2000,
    IMPORT_KEY_COMPONENT,
    IMPORT_KEY_STEP,
    IMPORT_KEY_LIST,
    IMPORT_KEY_TILES,
    IMPORT_KEY_GUARD,
    IMPORT_KEY_OWN
};

/* The ends of an importer's table; a format without steps or components leaves their rows out. Who
 * asks for tiles can read a tile_stream.h where the importer has one; whose output must be none of
 * the inputs names it by --guard. */
#define IMPORT_FIELD_BY(what, which)                                            \
    {                                                                           \
        "field", IMPORT_KEY_FIELD, "NAME", CLI_BASIC,                           \
            "the " what " to take (default: the " which " that can be read)", 0 \
    }
#define IMPORT_FIELD(what) IMPORT_FIELD_BY(what, "first")
#define IMPORT_COMPONENT                                                                  \
    {                                                                                     \
        "component", IMPORT_KEY_COMPONENT, "N", 0,                                        \
            "of vectors and colours: 1, 2, ..; default: their magnitude, or luminance", 0 \
    }
#define IMPORT_STEP \
    { "step", IMPORT_KEY_STEP, "N", 0, "the time step to take (default: the first, 0)", 0 }
#define IMPORT_LIST(what) \
    { "list", IMPORT_KEY_LIST, NULL, CLI_BASIC, "print what " what " there are; write nothing", 0 }
#define IMPORT_LAST                                                             \
    {"tiles", IMPORT_KEY_TILES, NULL, OPTION_HIDDEN, "for convert", 0},         \
        {"guard", IMPORT_KEY_GUARD, "FILE", OPTION_HIDDEN, "for convert", 0}, { \
        NULL, 0, NULL, 0, NULL, 0                                               \
    }
/* Of a format whose files name no others, and have all that they should: taken, without effect. */
#define IMPORT_END       TRUST_OPTIONS_AS(OPTION_HIDDEN, 0), IMPORT_LAST
#define IMPORT_TRUST_END TRUST_OPTIONS_AS(0, 0), IMPORT_LAST

#endif
