/* dds_stream.h - the bytes behind a Differential Data Stream, in which V^3 packs PVM volumes: "DDS
 * v3d" and "DDS v3e".
 *
 * Bits, the highest of a byte first: 2 for the bytes of a voxel less one, 16 for the bytes of a row
 * less one, then runs: 7 bits for how many values (0: the end), 3 for the bits w of each (0, or one
 * more than they say), then the values, each less 2^(w-1), as differences to a prediction: of the
 * value before, and in later rows by how that changed in the row before; modulo 256. The bytes of
 * voxels lie apart, all first ones before all second ones: in v3d over all, in v3e over blocks of
 * 2^24 voxels.
 */
#ifndef FORMATS_INPUT_DDS_STREAM_H
#define FORMATS_INPUT_DDS_STREAM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/input/byte_stream.h"

/* dds_stream_known() - whether a file begins as one. */
bool dds_stream_known(const uint8_t *start, size_t size);

/* dds_stream_open() - the unpacked bytes of a stream that stands at its first byte; it is taken
 * over, and closed in any case. Where the bytes of voxels lie apart, a block of them is held:
 * ST_NOMEM. */
CHECKED status dds_stream_open(mem *m, byte_stream *from, byte_stream **out);

#endif
