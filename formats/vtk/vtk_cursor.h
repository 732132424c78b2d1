/* vtk_cursor.h - the numbers of one array of a VTK file, front to back, whatever their coding.
 *
 * Holds fixed buffers, never the array. Several cursors read several places of a file at once.
 */
#ifndef FORMATS_VTK_VTK_CURSOR_H
#define FORMATS_VTK_VTK_CURSOR_H

#include "formats/base/mem.h"
#include "formats/vtk/vtk_array.h"

typedef struct vtk_cursor vtk_cursor;

#define VTK_CURSOR_ANY UINT64_MAX

/* vtk_cursor_open() - an array that must outlive the cursor, and how many numbers it has to have;
 * VTK_CURSOR_ANY for as many as there are, which bare arrays cannot tell. ST_CORRUPT when the file
 * says that there are others, or has no room for them; ST_UNSUPPORTED for arrays of strings and
 * bits. */
CHECKED status vtk_cursor_open(mem *m, const vtk_array *a, uint64_t count, vtk_cursor **out);
void vtk_cursor_close(vtk_cursor *c); /* NULL is fine */

/* vtk_cursor_doubles(), vtk_cursor_whole() - the next count numbers. Whole ones that are negative
 * become UINT64_MAX; the array is of whole numbers. ST_CORRUPT when there are not so many, or when
 * they are no such numbers. */
CHECKED status vtk_cursor_doubles(vtk_cursor *c, size_t count, double *out);
CHECKED status vtk_cursor_whole(vtk_cursor *c, size_t count, uint64_t *out);

/* vtk_cursor_raw() - the next count numbers as they are: of the array's own type, in native byte
 * order. Not for a cursor that the others were used on. ST_CORRUPT as there, and for text that is
 * no number of the type. */
CHECKED status vtk_cursor_raw(vtk_cursor *c, size_t count, void *out);

/* vtk_cursor_finish() - check that nothing is left. */
CHECKED status vtk_cursor_finish(vtk_cursor *c);

#endif
