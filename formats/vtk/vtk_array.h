/* vtk_array.h - where an array of a VTK file lies, and how its numbers are written there.
 *
 * Both kinds of file, legacy (.vtk) and XML, are first scanned for their arrays;
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
    VTK_BIT,   /* packed; passed over only */
    VTK_STRING /* passed over only */
} vtk_type;

typedef enum vtk_coding {
    VTK_TEXT,  /* decimal numbers, split by blanks; they end at a '<' */
    VTK_BARE,  /* bytes, and nothing that says how many: legacy */
    VTK_RAW,   /* bytes behind a head that counts them, or behind the table of packed blocks */
    VTK_BASE64 /* the same in base64, which ends at a '<' */
} vtk_coding;

/* Raw and base64: in blocks, as a compressor of VTK's writes them. */
typedef enum vtk_packing { VTK_PLAIN, VTK_ZLIB, VTK_LZ4, VTK_LZMA } vtk_packing;

typedef struct vtk_array {
    const char *path; /* of the file; not owned */
    char *name;       /* of a field; owned by whoever found it */
    const char *role; /* of any other array, for messages: "points", "cells", .. */
    vtk_type type;
    vtk_coding coding;
    bool big_endian;
    vtk_packing packing;
    bool head64;         /* raw and base64: the numbers of the head have 64 bits, else 32 */
    uint32_t components; /* numbers a tuple; 1 or more */
    uint64_t line;       /* XML: where its element starts; 0 for legacy files */
    uint64_t at;         /* the byte of the file where text, head or numbers start */
} vtk_array;

/* vtk_array_width() - bytes of one number; 0 for types that have none. */
size_t vtk_array_width(vtk_type type);

/* vtk_array_samples() - the type as one of samples; 0 for types that have no numbers. */
sample_type vtk_array_samples(vtk_type type);

/* vtk_array_whole() - whether the type is one of whole numbers. */
bool vtk_array_whole(vtk_type type);

/* vtk_array_check_file() - ST_UNSUPPORTED when the path ("-": standard input) is none of a regular
 * file: arrays are read at several places at once. */
CHECKED status vtk_array_check_file(const char *path);

/* vtk_array_fault() - describe what is wrong with an array: "file: line 7: array "x": ..." (or
 * byte, for legacy files); returns st. */
status vtk_array_fault(const vtk_array *a, status st, const char *fmt, ...)
    __attribute__((format(printf, 3, 4)));

#endif
