/* vtk_parts.h - files of VTK that name other files: pieces of a parallel mesh (.pvtu), blocks
 * (.vtm, .vtmb), and collections, whose files are parts and time steps (.pvd).
 *
 * Names are looked for beside the file, as named_file.h has it. All of them must be there, so that
 * the last step of many is not missed when hours have gone into the others.
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

/* Zeros: none. The parts are sorted by their times; of one time, they are in the file's order. */
typedef struct vtk_parts {
    vtk_parts_kind kind;
    vtk_part *items;
    size_t count, room;
    double *times; /* of the steps, ascending */
    size_t *first; /* of each step the first part; behind the last, count */
    uint32_t steps;
} vtk_parts;

/* vtk_parts_find_kind() - of a file, by its first bytes; by its name where these say no type. */
vtk_parts_kind vtk_parts_find_kind(const char *path, const uint8_t *start, size_t size);

/* vtk_parts_are_grids() - whether the first file that it names is one of a grid, by its suffix, as
 * VTK tells them: the others are meshes, or nothing that is read. */
bool vtk_parts_are_grids(const uint8_t *start, size_t size);

/* vtk_parts_read() - data: at the start of the file `path`. Release *out in any case. ST_CORRUPT
 * where it names no file; ST_IO for one that is not there; ST_UNSUPPORTED where one may not be
 * read; all name the file and the line. */
CHECKED status vtk_parts_read(mem *m, const char *path, byte_stream *data, bool follow_links,
                              vtk_parts *out);
void vtk_parts_release(vtk_parts *p, mem *m);

/* vtk_parts_list() - the files of a step, for a message: "a.vtu", "b.vtu", .. */
enum { VTK_PARTS_TEXT = 400 };
const char *vtk_parts_list(const vtk_parts *p, uint32_t step, char text[VTK_PARTS_TEXT]);

/* vtk_parts_check_step() - ST_USAGE where `path` has no such step. */
CHECKED status vtk_parts_check_step(const vtk_parts *p, const char *path, uint32_t step);

#endif
