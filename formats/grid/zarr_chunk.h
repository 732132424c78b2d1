/* zarr_chunk.h - the unpacked bytes of one chunk of an array of Zarr, or of HDF5. */
#ifndef FORMATS_GRID_ZARR_CHUNK_H
#define FORMATS_GRID_ZARR_CHUNK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/file.h"
#include "formats/base/mem.h"
#include "formats/base/status.h"

typedef enum zarr_codec {
    ZARR_RAW = 1,
    ZARR_STREAM, /* zlib, gzip, zstd, bz2, lzma */
    ZARR_BLOSC,
    ZARR_LZ4,
    ZARR_LZF /* of HDF5 alone */
} zarr_codec;

/* zarr_codec_find() - find a codec by its "id"; 0 if it is unknown. */
zarr_codec zarr_codec_find(const char *id);

/* zarr_chunk_read() - read exactly size bytes, unpacked, from a chunk's file, and add the bytes of
 * the file to *read. Where there is no such file *there is false, and nothing is read. ST_CORRUPT
 * where the file holds fewer or more; ST_UNSUPPORTED where the library that unpacks it is missing.
 */
CHECKED status zarr_chunk_read(mem *m, zarr_codec codec, const char *path, void *to, size_t size,
                               bool *there, uint64_t *read);

/* Bytes of a file that are a chunk. name: for messages. */
typedef struct zarr_part {
    file *in;
    uint64_t offset;
    size_t bytes;
    const char *name;
} zarr_part;

/* zarr_chunk_read_part() - the same from part of a file. or_more: what is behind size bytes is not
 * looked at; only for ZARR_RAW and ZARR_STREAM. */
CHECKED status zarr_chunk_read_part(mem *m, zarr_codec codec, const zarr_part *part, void *to,
                                    size_t size, bool or_more);

#endif
