/* zarr_chunk.h - the unpacked bytes of one chunk of a Zarr array. */
#ifndef FORMATS_GRID_ZARR_CHUNK_H
#define FORMATS_GRID_ZARR_CHUNK_H

#include <stdbool.h>
#include <stddef.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"

typedef enum zarr_codec {
    ZARR_RAW = 1,
    ZARR_STREAM, /* zlib, gzip, zstd, bz2, lzma */
    ZARR_BLOSC,
    ZARR_LZ4
} zarr_codec;

/* zarr_codec_find() - by its "id"; 0 for one that is not known. */
zarr_codec zarr_codec_find(const char *id);

/* zarr_chunk_read() - exactly size bytes of a chunk's file. *there is false, and nothing read,
 * where there is no such file. ST_CORRUPT where it holds fewer or more; ST_UNSUPPORTED where the
 * library that unpacks it is not there. */
CHECKED status zarr_chunk_read(mem *m, zarr_codec codec, const char *path, void *to, size_t size,
                               bool *there);

#endif
