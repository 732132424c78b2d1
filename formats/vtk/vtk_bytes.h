/* vtk_bytes.h - the bytes of an XML array behind its head: plain, in base64, in blocks of a
 * compressor, or both.
 *
 * They are read through fixed buffers, front to back. For LZ4 and LZMA one block is in memory,
 * packed and unpacked. The head gives the number of bytes. The table of the blocks is read along
 * with them, so its length costs nothing.
 */
#ifndef FORMATS_VTK_VTK_BYTES_H
#define FORMATS_VTK_VTK_BYTES_H

#include "formats/base/mem.h"
#include "formats/vtk/vtk_array.h"

typedef struct vtk_bytes vtk_bytes;

/* vtk_bytes_open() - open an array of coding VTK_RAW or VTK_BASE64, which must outlive *out, and
 * read its head. ST_CORRUPT or ST_IO, naming file and place. */
CHECKED status vtk_bytes_open(mem *m, const vtk_array *a, vtk_bytes **out);
void vtk_bytes_close(vtk_bytes *b); /* NULL is fine */

/* vtk_bytes_size() - returns the unpacked bytes of the whole array by its head. The file has room
 * for them. */
uint64_t vtk_bytes_size(const vtk_bytes *b);

/* vtk_bytes_read() - read the next size bytes; never more than there are. ST_CORRUPT when the file
 * has fewer, or they are damaged. */
CHECKED status vtk_bytes_read(vtk_bytes *b, void *buffer, size_t size);

#endif
