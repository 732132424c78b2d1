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

/* vtk_cursor_open() - open an array, which must outlive the cursor. count: how many numbers it must
 * have; VTK_CURSOR_ANY: as many as there are, which is unknown for bare arrays. ST_CORRUPT when the
 * file says another count, or has no room for it; ST_UNSUPPORTED for arrays of strings and bits. */
CHECKED status vtk_cursor_open(mem *m, const vtk_array *a, uint64_t count, vtk_cursor **out);
void vtk_cursor_close(vtk_cursor *c); /* NULL is fine */

/* vtk_cursor_doubles(), vtk_cursor_whole() - read the next count numbers. vtk_cursor_whole() needs
 * an array of whole numbers; negative ones become UINT64_MAX. ST_CORRUPT when there are fewer, or
 * when a word is no such number. */
CHECKED status vtk_cursor_doubles(vtk_cursor *c, size_t count, double *out);
CHECKED status vtk_cursor_whole(vtk_cursor *c, size_t count, uint64_t *out);

/* vtk_cursor_raw() - read the next count numbers as they are: in the array's own type, in native
 * byte order. Not for a cursor on which the other two were used. ST_CORRUPT likewise, and for text
 * that is no number of the type. */
CHECKED status vtk_cursor_raw(vtk_cursor *c, size_t count, void *out);

/* vtk_cursor_finish() - check that nothing is left. */
CHECKED status vtk_cursor_finish(vtk_cursor *c);

#endif
