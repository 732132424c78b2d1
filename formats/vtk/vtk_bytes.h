/* vtk_bytes.h - the bytes of an XML array behind its head: plain, in base64, in blocks of a
 * compressor, or both.
 *
 * Through fixed buffers, front to back; of LZ4 and LZMA there is a block in memory, packed and not.
 * The head says how many bytes there are; the table of the blocks is read beside them, so its
 * length costs nothing.
 */
#ifndef FORMATS_VTK_VTK_BYTES_H
#define FORMATS_VTK_VTK_BYTES_H

#include "formats/base/mem.h"
#include "formats/vtk/vtk_array.h"

typedef struct vtk_bytes vtk_bytes;

/* vtk_bytes_open() - of an array of coding VTK_RAW or VTK_BASE64, which must outlive it; reads the
 * head. ST_CORRUPT or ST_IO, naming file and place. */
CHECKED status vtk_bytes_open(mem *m, const vtk_array *a, vtk_bytes **out);
void vtk_bytes_close(vtk_bytes *b); /* NULL is fine */

/* vtk_bytes_size() - of the whole array, decompressed, as its head has it; the file has room for
 * it. */
uint64_t vtk_bytes_size(const vtk_bytes *b);

/* vtk_bytes_read() - the next size bytes; not more than there are. ST_CORRUPT when the file has
 * fewer, or they are damaged. */
CHECKED status vtk_bytes_read(vtk_bytes *b, void *buffer, size_t size);

#endif
