/* vtk_array.h - the place of an array in a VTK file, and how its numbers are written.
 *
 * Files of both kinds, legacy (.vtk) and XML, are first scanned for their arrays;
 * vtk_cursor.h then reads the numbers, several arrays at once, each at its own place.
 */
#ifndef FORMATS_VTK_VTK_ARRAY_H
#define FORMATS_VTK_VTK_ARRAY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/sample.h"
#include "formats/base/status.h"

typedef enum vtk_type {
    VTK_ABSENT, /* there is no such array */
    VTK_I8,
    VTK_U8,
    VTK_I16,
    VTK_U16,
    VTK_I32,
    VTK_U32,
    VTK_I64,
    VTK_U64,
    VTK_F32,
    VTK_F64,
    VTK_BIT,   /* packed; only ever skipped */
    VTK_STRING /* only ever skipped */
} vtk_type;

typedef enum vtk_coding {
    VTK_TEXT,  /* decimal numbers, split by blanks; they end at a '<' */
    VTK_BARE,  /* bytes without a count: legacy */
    VTK_RAW,   /* bytes behind a head that counts them, or behind the table of packed blocks */
    VTK_BASE64 /* the same in base64, which ends at a '<' */
} vtk_coding;

/* How raw and base64 data are packed: in blocks, as a compressor of VTK writes them. */
typedef enum vtk_packing { VTK_PLAIN, VTK_ZLIB, VTK_LZ4, VTK_LZMA } vtk_packing;

typedef struct vtk_array {
    const char *path; /* the file's; not owned */
    char *name;       /* of a field; owned by its finder */
    const char *role; /* of any other array, for messages: "points", "cells", .. */
    vtk_type type;
    vtk_coding coding;
    bool big_endian;
    bool colour; /* COLOR_SCALARS of legacy files: of 0 .. 1 in text */
    bool normal; /* the points' or cells' attribute NORMALS */
    vtk_packing packing;
    bool head64;         /* raw and base64: the numbers of the head have 64 bits, else 32 */
    uint32_t components; /* numbers a tuple; 1 or more */
    uint64_t line;       /* XML: where its element starts; 0 for legacy files */
    uint64_t at;         /* the byte of the file where text, head or numbers start */
} vtk_array;

/* Lists of points, one for each cell. Without offsets, the length of each stands in front of it. */
typedef struct vtk_lists {
    uint64_t count; /* of lists */
    vtk_array offsets, ids;
    bool from_zero;    /* the offsets start with a 0, so there is one more of them than lists */
    uint64_t ids_size; /* length of ids; VTK_CURSOR_ANY: any length */
} vtk_lists;

/* vtk_array_width() - returns the bytes of one number; 0 for bits, strings and absent arrays. */
size_t vtk_array_width(vtk_type type);

/* vtk_array_samples() - returns the type of samples; 0 for types without numbers. */
sample_type vtk_array_samples(vtk_type type);

/* vtk_array_whole() - returns whether numbers of the type are whole. */
bool vtk_array_whole(vtk_type type);

/* vtk_array_check_file() - ST_UNSUPPORTED unless the path ("-": standard input) is a regular file:
 * arrays are read at several places at once. */
CHECKED status vtk_array_check_file(const char *path);

/* vtk_array_fault() - describe what is wrong with an array: "file: line 7: array "x": ..." (or
 * byte, for legacy files); returns st. */
status vtk_array_fault(const vtk_array *a, status st, const char *fmt, ...)
    __attribute__((format(printf, 3, 4)));

#endif
