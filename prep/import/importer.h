/* importer.h - what the verbs import-X share: their options, and the NRRD that they write.
 *
 * An importer is a folder prep/import/X: import_X_main.c, whose row says how a format is opened and
 * listed, and the shim around the format's library, which gives a slice_source. Only that verb is
 * linked with the library; `convert' and `info' run it and read its NRRD through a pipe.
 */
#ifndef PREP_IMPORT_IMPORTER_H
#define PREP_IMPORT_IMPORTER_H

#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/grid/slice_source.h"
#include "formats/input/input_trust.h"

/* What the command line asks for. */
typedef struct import_request {
    const char *verb; /* "import-vdb", for messages */
    char **paths;     /* files, or a folder */
    int path_count;
    const char *field;  /* as its file calls it; NULL: the first that can be read */
    uint32_t component; /* of several numbers a sample: 1, 2, ..; 0: see volume_hints.h */
    uint32_t step;      /* of several time steps, from 0 on */
    input_trust trust;
} import_request;

/* One of the things that a file has; for --list. */
typedef struct import_item {
    const char *name;      /* as --field takes it */
    const char *type;      /* as the format calls it: "float, half" */
    uint64_t shape[4];     /* x, y, z samples, then time steps; 0: there is no such axis */
    const char *refuse;    /* why it cannot be read; NULL: it can */
    bool taken;            /* it is the one that open() would take */
    const double *times;   /* of all steps; NULL: untold */
    const char *time_unit; /* NULL: untold */
    uint32_t components;   /* numbers a sample; 0: 1 */
    uint32_t component;    /* of several, which one open() would read, from 1; 0: all, */
    bool colours;          /* as their luminance, or else as their magnitude */
} import_item;

typedef struct import_list {
    status (*take)(void *ctx, const import_item *item);
    void *ctx;
} import_list;

typedef struct importer {
    const char *verb;   /* "import-vdb" */
    const char *format; /* "OpenVDB" */
    const char *inputs; /* for the usage: "F.vdb" */
    int inputs_max;     /* 0: one */
    const char *doc;    /* as cli_verb's */
    bool beside;        /* its files may name others, in their own folder */
    /* Options of its own, and what takes them; see cli_verb. NULL: none. */
    const struct argp_option *options;
    status (*set_option)(int key, const char *text);
    /* Both: ST_CORRUPT, ST_UNSUPPORTED, ST_IO, ST_NOMEM; no exception of C++ leaves them. */
    status (*open)(mem *m, const import_request *q, slice_source *out);
    status (*list)(mem *m, const import_request *q, const import_list *to);
} importer;

/* importer_main() - all of main(): NRRD to -o, which by default is standard output; its exit code.
 * The library runs behind a fence (file_door.h), within limits (import_limits.h), and a crash of it
 * ends the program with a word (crash.h). The budget is 2 GiB where --memory says no other. */
int importer_main(const importer *x, int argc, char **argv);

#endif
