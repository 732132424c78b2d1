/* mesh_reader.h - a row of mesh_input.c's table: how a format is recognised, opened, read and
 * closed.
 */
#ifndef FORMATS_MESH_MESH_READER_H
#define FORMATS_MESH_MESH_READER_H

#include "formats/input/byte_stream.h"
#include "formats/mesh/mesh_feed.h"
#include "formats/mesh/mesh_sink.h"

enum { MESH_READER_PEEK = 4096 };

/* What a reader gets. mesh_input.c keeps it as long as the mesh. */
typedef struct mesh_source {
    mem *m;
    const char *path;  /* "-": standard input */
    byte_stream *data; /* at the start of the file; closed by mesh_input.c */
    mesh_hints hints;
    char name[MESH_NAME_MAX + 1]; /* of the data set; empty unless open() finds one */
} mesh_source;

typedef struct mesh_reader {
    const char *format; /* for messages: "TetGen" */
    /* Its suffix or the file's first bytes (up to MESH_READER_PEEK, none of a pipe with a name) say
     * so. */
    bool (*known)(const char *path, const uint8_t *start, size_t size);
    /* The header, up to where that is possible; *state belongs to the reader, and is closed too
     * when open() fails. */
    status (*open)(mesh_source *source, void **state);
    status (*read)(void *state, mesh_feed *feed); /* once */
    void (*close)(void *state);                   /* NULL is fine */
    /* mesh_input_take(), of one that is open: the fields that read() hands over, again perhaps. A
     * name may be NULL where there is one: that of the hints, or none. */
    status (*take)(void *state, const char *const *names, uint32_t count);
    /* mesh_input_fields(), of one that is open */
    void (*fields)(const void *state, mesh_field_taker *take, void *ctx);
    /* mesh_input_steps(), and their times. NULL: there is one, and open() need not look at the
     * hints' step. */
    uint32_t (*steps)(const void *state, const double **times);
    const char *(*file)(const void *state); /* mesh_input_file(); NULL: the source's */
} mesh_reader;

#endif
