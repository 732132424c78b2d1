/* unpack_stream.h - the unpacked bytes of gzip, zlib, zstd, bzip2 or xz data, in order, through
 * fixed buffers.
 *
 * A file may hold several members, one behind the other; they are joined. Checksums are checked
 * where a member ends. What the libraries allocate is counted in the budget, too.
 */
#ifndef FORMATS_INPUT_UNPACK_STREAM_H
#define FORMATS_INPUT_UNPACK_STREAM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/input/byte_stream.h"

typedef struct packer packer;
typedef struct unpack_stream unpack_stream;

/* No deflate stream gives more bytes than this for each of its own, which bounds what a file can
 * hold before it is read. Likewise bzip2: a block of 46 MB takes at least 39 bytes. */
enum { UNPACK_ZLIB_RATIO = 1032, UNPACK_BZIP2_RATIO = 1 << 21 };

/* packer_zlib: gzip or zlib, as the data says. */
extern const packer packer_zlib, packer_bzip2;

/* packer_find() - find what a file was packed with by its first bytes; NULL: nothing. zlib has no
 * mark, and is not found. */
enum { PACKER_PEEK = 6 };
const packer *packer_find(const uint8_t *start, size_t size);

/* packer_is_suffix() - returns whether a path ends as packed files do. */
bool packer_is_suffix(const char *path);

/* unpack_stream_open() - unpack what comes next in `from`, which must outlive the stream. The
 * caller keeps `from`. */
CHECKED status unpack_stream_open(mem *m, const packer *p, byte_stream *from, unpack_stream **out);
void unpack_stream_close(unpack_stream *s); /* NULL is fine */

/* unpack_stream_read() - read size bytes; *got is smaller only at the end of the last member.
 * ST_CORRUPT when the data is damaged or ends inside a member. Bytes behind the last member stay in
 * `from`. */
CHECKED status unpack_stream_read(unpack_stream *s, void *buffer, size_t size, size_t *got);

#endif
