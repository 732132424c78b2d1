/* gmsh_file.h - the sections of a Gmsh file, and its numbers one by one, from text and binary files
 * alike.
 *
 * Versions 2, 2.1, 2.2 and 4.1. Sections that are not needed here are skipped up to their $End.
 */
#ifndef FORMATS_MESH_GMSH_FILE_H
#define FORMATS_MESH_GMSH_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/input/byte_stream.h"
#include "formats/input/text_tokens.h"
#include "formats/mesh/mesh_sink.h"

enum { GMSH_COMPONENTS_MAX = 9 };

typedef struct gmsh_section {
    uint64_t at, line; /* just behind the section's first line; at = 0: it is absent */
} gmsh_section;

typedef enum gmsh_owner { GMSH_NODES, GMSH_ELEMENT_NODES, GMSH_ELEMENTS } gmsh_owner;

/* $NodeData, $ElementNodeData or $ElementData. */
typedef struct gmsh_array {
    gmsh_section rows; /* starts behind the tags */
    gmsh_owner owner;
    char name[MESH_NAME_MAX + 1]; /* cut to MESH_NAME_MAX bytes */
    int components;
    uint64_t count; /* number of rows */
    double time;    /* its first real tag; NaN: it has none */
} gmsh_array;

typedef struct gmsh_file {
    mem *m;
    const char *path;     /* not owned */
    int version;          /* 2 or 4 */
    bool binary, foreign; /* foreign: in the other byte order */
    int size_width;       /* bytes of a size_t in a binary file of version 4 */
    gmsh_section nodes, elements;
    gmsh_array *arrays; /* in the file's order */
    size_t count, room;
} gmsh_file;

/* gmsh_file_scan() - scan the whole stream, from its first byte, and fill f. m and s must outlive
 * f. Release f in any case. */
CHECKED status gmsh_file_scan(gmsh_file *f, mem *m, byte_stream *s);
void gmsh_file_release(gmsh_file *f);

/* A reading position in a section. */
typedef struct gmsh_cursor {
    const gmsh_file *f;
    text_tokens t;
} gmsh_cursor;

/* gmsh_cursor_open() - go to a section's first number. Close in any case. */
CHECKED status gmsh_cursor_open(const gmsh_file *f, const gmsh_section *section, gmsh_cursor *c);
void gmsh_cursor_close(gmsh_cursor *c);

/* Read the next number: an int, a size_t or a double. A negative int or size_t comes as a very
 * large one. `what` names the expected number in messages.
 * gmsh_cursor_line() - read a number that is text in any file, alone on its line. */
CHECKED status gmsh_cursor_int(gmsh_cursor *c, const char *what, uint64_t *out);
CHECKED status gmsh_cursor_size(gmsh_cursor *c, const char *what, uint64_t *out);
CHECKED status gmsh_cursor_double(gmsh_cursor *c, const char *what, double *out);
CHECKED status gmsh_cursor_line(gmsh_cursor *c, const char *what, uint64_t *out);

/* gmsh_cursor_end() - check that the section ends here, behind its last number, with `end`
 * ("$EndNodes"). */
CHECKED status gmsh_cursor_end(gmsh_cursor *c, const char *end);

/* gmsh_cursor_fault() - describe a fault, naming the file and the place in it. Returns st:
 * ST_CORRUPT or ST_UNSUPPORTED. */
status gmsh_cursor_fault(const gmsh_cursor *c, status st, const char *fmt, ...)
    __attribute__((format(printf, 3, 4)));

#endif
