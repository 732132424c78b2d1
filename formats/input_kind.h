/* input_kind.h - the kinds of inputs that can be converted: a row each.
 *
 * A row opens an input and says what it is like. What verbs do with inputs of a kind they have in
 * rows of their own, which name the row here that they belong to. A new kind adds its row, and a
 * line in input_open.c.
 */
#ifndef FORMATS_INPUT_KIND_H
#define FORMATS_INPUT_KIND_H

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/curvilinear/curvilinear_hints.h"
#include "formats/grid/volume_hints.h"
#include "formats/input/byte_stream.h"
#include "formats/mesh/mesh_sink.h"

/* What an input is like, as bits. An option that needs one of them changes nothing of inputs that
 * have none of them. */
typedef enum input_trait {
    INPUT_RAW = 1,      /* samples whose sizes come from outside */
    INPUT_LATTICE = 2,  /* its nodes form rows, columns and slices */
    INPUT_CELLS = 4,    /* it lists its cells */
    INPUT_CHOICES = 8,  /* its format may have several fields and components */
    INPUT_STEPS = 16,   /* its format may have several time steps */
    INPUT_SERIES = 32,  /* several of its steps can be taken at once */
    INPUT_FILES = 64,   /* it may lead to other files */
    INPUT_PARTS = 128,  /* it may lack parts, and tells so */
    INPUT_MEANS = 256,  /* its format may have values of cells, too, and whole cells by itself */
    INPUT_PLACED = 512, /* its nodes were placed as `--to' says */
    INPUT_ONE_LEVEL = 1024, /* no levels of detail are made of it but by --coarse */
    INPUT_TRAIT_END = 2048  /* verbs may add their own from here on */
} input_trait;

/* What inputs of a trait are called: cli_check_uses()'s names. */
#define INPUT_TRAIT_NAMES                                                                          \
    [INPUT_RAW] = "raw samples", [INPUT_LATTICE] = "grids", [INPUT_CELLS] = "meshes",              \
    [INPUT_CHOICES] = "formats that have several", [INPUT_STEPS] = "formats of several steps",     \
    [INPUT_SERIES] = "grids and meshes of several steps",                                          \
    [INPUT_FILES] = "grids, collections of VTK, and meshes that a library reads",                  \
    [INPUT_PARTS] = "grids, and meshes that a library reads", [INPUT_PLACED] = "netCDF with --to", \
    [INPUT_ONE_LEVEL] = "meshes and curvilinear grids"

/* What the user says of an input, for the readers of each kind. */
typedef struct input_hints {
    volume_hints grid;
    mesh_hints mesh;
    curvilinear_hints curvilinear;
} input_hints;

typedef struct input_kind {
    const char *name; /* "grid" */
    /* recognises(): whether a stream holds one, without taking anything from it. NULL: this row
     * takes what no other does. is_asked(): whether the hints say that any stream is one; NULL:
     * they never do. is_folder(): whether it reads this folder; NULL: it reads none. */
    status (*recognises)(byte_stream *s, bool *known);
    bool (*is_asked)(const input_hints *hints);
    /* Where the last row can open what is recognised here, it is one of those: that nodes which may
     * lie anywhere make a regular grid is only seen in all of them. */
    bool last_first;
    bool (*is_folder)(const char *path);
    /* Where an earlier row recognises a stream, too: whether it is this row's, after a closer look.
     * NULL: never. */
    status (*takes_over)(mem *m, byte_stream *s, const input_hints *hints, bool *takes);
    /* open(): open a stream, which is taken over and closed in any case. open_folder(): goes with
     * is_folder(). close(): NULL is fine. */
    status (*open)(mem *m, byte_stream *s, const input_hints *hints, void **own);
    status (*open_folder)(mem *m, const char *path, const input_hints *hints, void **own);
    void (*close)(void *own);
    const char *(*format)(const void *own); /* "NRRD"; constant */
    unsigned (*traits)(const void *own);    /* of input_trait */
} input_kind;

#endif
