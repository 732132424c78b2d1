/* mesh_reader.h - how one format is recognised, opened, read and closed: a row of mesh_input.c's
 * table. */
#ifndef FORMATS_MESH_MESH_READER_H
#define FORMATS_MESH_MESH_READER_H

#include "formats/input/byte_stream.h"
#include "formats/mesh/mesh_feed.h"
#include "formats/mesh/mesh_sink.h"

enum { MESH_READER_PEEK = 4096 };

/* A reader's input. mesh_input.c keeps it as long as the mesh. */
typedef struct mesh_source {
    mem *m;
    const char *path;  /* "-": standard input */
    byte_stream *data; /* at the start of the file; closed by mesh_input.c */
    mesh_hints hints;
    char name[MESH_NAME_MAX + 1]; /* the data set's; empty unless open() finds one */
    const char *format;           /* set by open() if it is not the reader's */
} mesh_source;

typedef struct mesh_reader {
    const char *format; /* for messages: "TetGen" */
    /* Returns whether the suffix or the file's first bytes are this format's. start: up to
     * MESH_READER_PEEK bytes, none of a pipe with a name. */
    bool (*known)(const char *path, const uint8_t *start, size_t size);
    /* Read the header, as far as possible. *state belongs to the reader; close() is called also
     * when open() fails. */
    status (*open)(mesh_source *source, void **state);
    status (*read)(void *state, mesh_feed *feed); /* once */
    void (*close)(void *state);                   /* NULL is fine */
    /* mesh_input_take() on an open mesh: choose the fields that read() hands over. May be called
     * again. A single name may be NULL, as mesh_hints.field may. */
    status (*take)(void *state, const char *const *names, uint32_t count);
    /* mesh_input_fields() of an open mesh */
    void (*fields)(const void *state, mesh_field_taker *take, void *ctx);
    /* mesh_input_steps() and their times. NULL: the format has one step, and open() may ignore the
     * hints' step. */
    uint32_t (*steps)(const void *state, const double **times);
    const char *(*file)(const void *state); /* mesh_input_file(); NULL: the source's path */
    /* mesh_input_counts(). NULL: the header does not say. */
    void (*counts)(const void *state, uint64_t *points, uint64_t *cells);
} mesh_reader;

/* A table of readers. The first that knows a file reads it. */
typedef struct mesh_readers {
    const mesh_reader *const *items;
    size_t count;
    const char *expected; /* where none of them knows it, as the end of a sentence */
} mesh_readers;

#endif
