/* vtk_parts.h - files of VTK that name other files: pieces of a parallel mesh (.pvtu), blocks
 * (.vtm, .vtmb), and collections, whose files are parts and time steps (.pvd).
 *
 * Names are looked for beside the file, by the rule of named_file.h. All files must be there: a
 * missing last step must not show up after hours of work on the others.
 */
#ifndef FORMATS_VTK_VTK_PARTS_H
#define FORMATS_VTK_VTK_PARTS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/input/byte_stream.h"

typedef enum vtk_parts_kind {
    VTK_PARTS_NONE,
    VTK_PARTS_PIECES,    /* PUnstructuredGrid */
    VTK_PARTS_BLOCKS,    /* vtkMultiBlockDataSet */
    VTK_PARTS_COLLECTION /* Collection */
} vtk_parts_kind;

typedef struct vtk_part {
    char *path; /* owned */
    double time;
    size_t at; /* its place in the file */
} vtk_part;

/* Zeros: no parts. Parts are sorted by time; parts of one time stay in the file's order. */
typedef struct vtk_parts {
    vtk_parts_kind kind;
    vtk_part *items;
    size_t count, room;
    double *times; /* times of the steps, ascending */
    size_t *first; /* first part of each step; behind the last step, count */
    uint32_t steps;
} vtk_parts;

/* vtk_parts_find_kind() - find a file's kind by its first bytes, or by its name where these state
 * no type. */
vtk_parts_kind vtk_parts_find_kind(const char *path, const uint8_t *start, size_t size);

/* vtk_parts_begin_with() - returns whether the first file that it names has one of these suffixes,
 * each with a blank behind.
 * vtk_parts_are_grids() - the same of those of grids, as VTK uses them. Files of other suffixes are
 * meshes, or not read at all. */
bool vtk_parts_begin_with(const uint8_t *start, size_t size, const char *suffixes);
bool vtk_parts_are_grids(const uint8_t *start, size_t size);

/* vtk_parts_read() - read the file `path`; data stands at its start. Release *out in any case.
 * ST_CORRUPT where it names no file; ST_IO for a missing file; ST_UNSUPPORTED for a file that may
 * not be read. All name the file and the line. */
CHECKED status vtk_parts_read(mem *m, const char *path, byte_stream *data, bool follow_links,
                              vtk_parts *out);
void vtk_parts_release(vtk_parts *p, mem *m);

/* vtk_parts_list() - print the files of a step, for a message: "a.vtu", "b.vtu", .. */
enum { VTK_PARTS_TEXT = 400 };
const char *vtk_parts_list(const vtk_parts *p, uint32_t step, char text[VTK_PARTS_TEXT]);

/* vtk_parts_check_step() - ST_USAGE if `path` has no such step. */
CHECKED status vtk_parts_check_step(const vtk_parts *p, const char *path, uint32_t step);

#endif
