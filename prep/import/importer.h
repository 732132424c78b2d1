/* importer.h - common part of the verbs import-X: their options, and the NRRD, the mesh stream or
 * the curvilinear stream that they write.
 *
 * An importer is a folder prep/import/X. Its import_X_main.c has a row that tells how to open and
 * list a format. Its shim around the format's library gives a slice_source, or an import_mesh. Only
 * that verb is linked with the library. `convert' and `info' run it and read what it writes through
 * a pipe.
 */
#ifndef PREP_IMPORT_IMPORTER_H
#define PREP_IMPORT_IMPORTER_H

#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/grid/slice_source.h"
#include "formats/input/input_trust.h"
#include "prep/import/import_mesh.h"

/* A request of the command line. */
typedef struct import_request {
    const char *verb; /* "import-vdb", for messages */
    char **paths;     /* files, or a folder */
    int path_count;
    const char *field;   /* as its file spells it; NULL: the first that can be read */
    const char **fields; /* of a mesh, which may have several; `field` is the last one */
    uint32_t field_count;
    bool by_corners;      /* take a mesh's cells of higher order as linear ones */
    bool cells_to_points; /* take a mesh's values at cells, averaged to the points */
    bool zones;           /* take a mesh whose cells are implied by zones as a curvilinear grid */
    const char *to;       /* IMPORT_TO: "cartesian" or "sphere"; NULL: not asked */
    double exaggerate;    /* factor on heights there; above 0 */
    uint32_t component;   /* if a sample has several numbers: 1, 2, ..; 0: see volume_hints.h */
    uint32_t step;        /* if there are several time steps: from 0 on */
    input_trust trust;
    bool chunks; /* the source is to tell where its chunks are, and not to be read */
} import_request;

/* An entry of --list: one of the file's fields. */
typedef struct import_item {
    const char *name;      /* as for --field */
    const char *type;      /* in the format's words: "float, half" */
    uint64_t shape[4];     /* samples along x, y, z, then time steps; 0: no such axis */
    const char *refuse;    /* why it cannot be read; NULL: it can */
    bool taken;            /* open() would take this one */
    bool of_cells;         /* a mesh's: its values are at cells, not at points */
    const double *times;   /* of all steps; NULL: unknown */
    const char *time_unit; /* NULL: unknown */
    uint32_t components;   /* numbers per sample; 0: 1 */
    uint32_t component;    /* the one that open() would read, from 1; 0: all, */
    bool colours;          /* as luminance if true, else as magnitude */
} import_item;

typedef struct import_list {
    status (*take)(void *ctx, const import_item *item);
    /* What all fields of a mesh share: the data set's name, or ""; the times, or NULL. NULL:
     * unasked. */
    status (*about)(void *ctx, const char *name, uint64_t steps, const double *times);
    /* The zones, if it is a curvilinear grid; NULL: unasked. */
    status (*grid)(void *ctx, const import_mesh *x);
    void *ctx;
} import_list;

typedef struct importer {
    const char *verb;   /* "import-vdb" */
    const char *format; /* "OpenVDB" */
    const char *inputs; /* for the usage text: "F.vdb" */
    int inputs_max;     /* most inputs; 0: one */
    const char *doc;    /* as cli_verb's */
    bool beside;        /* its files may name others in their folder */
    /* The importer's own options, and their handler; see cli_verb. NULL: none. */
    const struct argp_option *options;
    status (*set_option)(int key, const char *text);
    /* All may return ST_CORRUPT, ST_UNSUPPORTED, ST_IO, ST_NOMEM. They let no C++ exception
     * out. */
    status (*open)(mem *m, const import_request *q, slice_source *out);
    /* Instead, or where q->to is set: *out is closed in any case. */
    status (*open_mesh)(mem *m, const import_request *q, import_mesh *out);
    status (*list)(mem *m, const import_request *q, const import_list *to);
} importer;

/* importer_main() - the whole main(): writes NRRD to -o, by default standard output, and returns
 * the exit code. The library runs behind a fence (file_door.h) and within limits (import_limits.h).
 * If it crashes, the program ends with a message (crash.h). The default budget is 2 GiB. */
int importer_main(const importer *x, int argc, char **argv);

#endif
