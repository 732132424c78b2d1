/* vtk_writer.h - VTK files written for the tests, in every coding, by code that shares none with
 * the readers.
 */
#ifndef TESTS_SUPPORT_VTK_WRITER_H
#define TESTS_SUPPORT_VTK_WRITER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

typedef enum vtk_writer_packing {
    VTK_WRITER_ZLIB,
    VTK_WRITER_LZ4,
    VTK_WRITER_LZMA
} vtk_writer_packing;

/* How an XML file is written. */
typedef struct vtk_xml_style {
    bool text;     /* else bytes: in base64, unless appended and raw */
    bool appended; /* else inline */
    bool raw;      /* appended: without base64 */
    bool big_endian, head64;
    bool split_head; /* base64: head and numbers encoded one by one, as some writers do */
    size_t block;    /* bytes of a compressed block; 0: not compressed */
    vtk_writer_packing packing;
    const char *real;  /* type of positions and fields; NULL: Float64 */
    const char *whole; /* of ids, offsets and "n"; NULL: Int32 */
    int pieces;        /* 0: 1; the mesh again and again, 10 further along x, values 100 higher */
} vtk_xml_style;

/* Text that grows. */
typedef struct vtk_writer_text {
    char *data;
    size_t size;
    FILE *out;
} vtk_writer_text;

typedef struct vtk_writer {
    const vtk_xml_style *style;
    FILE *out; /* the file */
    vtk_writer_text file, appended;
} vtk_writer;

/* vtk_writer_begin() - a file up to its VTKFile tag; vtk_writer_end() - what is left of it, as a
 * file of the scratch folder; its path. Both without XML: vtk_writer_open(), vtk_writer_close(). */
void vtk_writer_begin(vtk_writer *w, const char *type, const vtk_xml_style *style);
const char *vtk_writer_end(vtk_writer *w, const char *name);
void vtk_writer_open(vtk_writer *w);
const char *vtk_writer_close(vtk_writer *w, const char *name);

/* vtk_writer_array() - a DataArray of count numbers. */
void vtk_writer_array(vtk_writer *w, const char *name, const char *type, int components,
                      size_t count, const double *numbers);

/* vtk_writer_numbers() - numbers of a legacy file, of a type as XML calls it. */
void vtk_writer_numbers(FILE *out, bool text, const char *type, size_t count,
                        const double *numbers);

#endif
