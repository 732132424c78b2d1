/* importer_options.h - options of all importers, as rows for argp; an importer's own come first. */
#ifndef PREP_IMPORT_IMPORTER_OPTIONS_H
#define PREP_IMPORT_IMPORTER_OPTIONS_H

#include <argp.h>

#include "formats/base/cli_options.h"
#include "formats/curvilinear_options.h"
#include "formats/trust_options.h"

/* Keys of an importer's own options begin at IMPORT_KEY_OWN. */
enum {
    IMPORT_KEY_FIELD = 0x2000,
    IMPORT_KEY_COMPONENT,
    IMPORT_KEY_STEP,
    IMPORT_KEY_LIST,
    IMPORT_KEY_TILES,
    IMPORT_KEY_CHUNKS,
    IMPORT_KEY_GUARD,
    IMPORT_KEY_BY_CORNERS,
    IMPORT_KEY_CELLS_TO_POINTS,
    IMPORT_KEY_ZONES,
    IMPORT_KEY_TO,
    IMPORT_KEY_EXAGGERATE,
    IMPORT_KEY_OWN
};

/* Common rows for the end of an importer's table. Formats without steps or components leave those
 * rows out. --tiles: the caller can read a tile_stream.h, if the importer has one. --chunks:
 * write where the samples' chunks are (imported_chunks.h), not the samples. --guard: names the
 * caller's output, which must not be an input. */
#define IMPORT_FIELD_BY(what, which)                                            \
    {                                                                           \
        "field", IMPORT_KEY_FIELD, "NAME", CLI_BASIC,                           \
            "the " what " to take (default: the " which " that can be read)", 0 \
    }
#define IMPORT_FIELD(what) IMPORT_FIELD_BY(what, "first")
/* Of meshes: several. */
#define IMPORT_FIELDS(what)                                                                     \
    {                                                                                           \
        "field", IMPORT_KEY_FIELD, "NAME", CLI_BASIC,                                           \
            "a " what " to take (default: the first; several --field: each, in their order)", 0 \
    }
#define IMPORT_BY_CORNERS                                                                        \
    {                                                                                            \
        "by-corners", IMPORT_KEY_BY_CORNERS, NULL, CLI_BASIC,                                    \
            "take cells of higher order as linear ones of their corners (default: refuse them, " \
            "but tets of ten nodes)",                                                            \
            0                                                                                    \
    }
#define IMPORT_CELLS_TO_POINTS                                                            \
    {                                                                                     \
        "cells-to-points", IMPORT_KEY_CELLS_TO_POINTS, NULL, CLI_BASIC,                   \
            "take fields of cells, averaged to the points (default: fields of points)", 0 \
    }
#define IMPORT_ZONES                                                                              \
    {                                                                                             \
        "zones", IMPORT_KEY_ZONES, NULL, CLI_BASIC,                                               \
            "write structured zones as a curvilinear stream (default: as hexahedra of a mesh)", 0 \
    }
#define IMPORT_TO                                                                                 \
    {"to",                                                                                        \
     IMPORT_KEY_TO,                                                                               \
     CURVILINEAR_PLACES,                                                                          \
     CLI_BASIC,                                                                                   \
     "write a curvilinear stream: its nodes lie where longitudes, latitudes and heights say, on " \
     "a "                                                                                         \
     "plane or on a globe",                                                                       \
     0},                                                                                          \
    {                                                                                             \
        "exaggerate", IMPORT_KEY_EXAGGERATE, "Z", CLI_BASIC, "with --to: factor on heights", 0    \
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
#define IMPORT_LAST                                                             \
    {"tiles", IMPORT_KEY_TILES, NULL, OPTION_HIDDEN, "for convert", 0},         \
        {"chunks", IMPORT_KEY_CHUNKS, NULL, OPTION_HIDDEN, "for convert", 0},   \
        {"guard", IMPORT_KEY_GUARD, "FILE", OPTION_HIDDEN, "for convert", 0}, { \
        NULL, 0, NULL, 0, NULL, 0                                               \
    }
/* For formats whose files are complete in themselves: the options are accepted, without effect. */
#define IMPORT_END       TRUST_OPTIONS_AS(OPTION_HIDDEN, 0), IMPORT_LAST
#define IMPORT_TRUST_END TRUST_OPTIONS_AS(0, 0), IMPORT_LAST

#endif
