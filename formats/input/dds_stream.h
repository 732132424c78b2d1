/* dds_stream.h - the bytes behind a Differential Data Stream ("DDS v3d" and "DDS v3e"), as which
 * V^3 packs PVM volumes.
 *
 * The stream consists of bits, the highest of a byte first. It begins with 2 bits for the bytes of
 * a voxel less one, and 16 for the bytes of a row less one. Runs follow: 7 bits for the number of
 * values (0: the end), 3 bits for the width w of each in bits (0, or one less than w), then the
 * values, each plus 2^(w-1). A value is the difference to a prediction, modulo 256: the value
 * before; in later rows also how that changed in the row before. The bytes of voxels lie apart, all
 * first ones before all second ones: in v3d over the whole volume, in v3e over blocks of 2^24
 * voxels.
 */
#ifndef FORMATS_INPUT_DDS_STREAM_H
#define FORMATS_INPUT_DDS_STREAM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/input/byte_stream.h"

/* dds_stream_known() - returns whether a file begins as a DDS. */
bool dds_stream_known(const uint8_t *start, size_t size);

/* dds_stream_open() - open the unpacked bytes of a stream that stands at its first byte. The stream
 * is taken over, and closed in any case. Where the bytes of voxels lie apart, a block of them is
 * held: ST_NOMEM. */
CHECKED status dds_stream_open(mem *m, byte_stream *from, byte_stream **out);

#endif
