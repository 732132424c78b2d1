/* curvilinear_reader.h - how one format of curvilinear grids is recognised, opened, read and
 * closed: a row of curvilinear_input.c's table. */
#ifndef FORMATS_CURVILINEAR_CURVILINEAR_READER_H
#define FORMATS_CURVILINEAR_CURVILINEAR_READER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/world_frame.h"
#include "formats/curvilinear/curvilinear_hints.h"
#include "formats/input/byte_stream.h"

enum { CURVILINEAR_READER_PEEK = BYTE_STREAM_BUFFER, CURVILINEAR_NAME_MAX = 63 };

/* A reader's input. curvilinear_input.c keeps it as long as the grid. What open() sets must live as
 * long as its state. */
typedef struct curvilinear_opening {
    mem *m;
    byte_stream *data; /* at the start of a regular file; closed by curvilinear_input.c */
    curvilinear_hints hints;
    /* Set by open(): */
    uint32_t zones;
    const uint32_t (*nodes)[3];          /* of each zone; 2 or more along each axis */
    bool blanked;                        /* some nodes or cells may be no part of the grid */
    uint32_t fields;                     /* that there are */
    bool still;                          /* nodes are the same at all steps */
    char name[CURVILINEAR_NAME_MAX + 1]; /* the data set's; "": it has none */
    const char *format;                  /* a constant; NULL: the row's */
    char time_unit[WORLD_TIME_UNIT];     /* of the steps' times; "": unknown */
} curvilinear_opening;

/* Reading is as in curvilinear_source.h, of any plane at any time. */
typedef struct curvilinear_reader {
    const char *format; /* for messages: "PLOT3D" */
    bool names_files;   /* its files name others */
    bool library;       /* an importer reads it: parts may be missing */
    bool any_stream;    /* also pipes and packed files are read */
    /* Returns whether a file of so many bytes is of this format. path: its name, without the suffix
     * of packed files. start: its first CURVILINEAR_READER_PEEK bytes, or all there are. */
    bool (*known)(const char *path, const uint8_t *start, size_t size, uint64_t bytes);
    /* *state belongs to the reader; close() is called also when open() fails. */
    status (*open)(curvilinear_opening *o, void **state);
    void (*close)(void *state); /* NULL is fine */
    /* Returns the name of a field, below o->fields, and its number of components; the name is valid
     * until the next call. The first field is the default. */
    const char *(*field)(void *state, uint32_t field, uint32_t *components);
    /* Why a field that the file has cannot be asked for, as the end of a sentence; valid until the
     * next call. NULL: there is none of this name. NULL, also if the function is. */
    const char *(*refused)(void *state, const char *name);
    /* Only these fields are going to be read; NULL: the reader need not know. */
    status (*take)(void *state, const uint32_t *fields, uint32_t count);
    status (*places)(void *state, uint32_t zone, uint32_t first, uint32_t count, float (*p)[3]);
    /* component: 1, 2, ..; 0: the magnitude */
    status (*values)(void *state, uint32_t zone, uint32_t field, uint32_t component, uint32_t first,
                     uint32_t count, float *values);
    status (*blanks)(void *state, uint32_t zone, uint32_t first, uint32_t count, uint8_t *is_node);
    /* Time steps; NULL, both: its files never have several. steps(): how many there are, 1 or more;
     * *times: of each, NULL: not known. seek(): go to step o->hints.step, and set anew what open()
     * sets. */
    uint32_t (*steps)(const void *state, const double **times);
    status (*seek)(curvilinear_opening *o, void *state);
    /* Describes the conditions of a flow: Mach, angle of attack, Reynolds, time. NULL, also if the
     * function is: there are none. */
    const double *(*conditions)(const void *state);
} curvilinear_reader;

#endif
