/* tile_stream.h - sends slices with their maps of busy tiles (slice_tiles.h) through a pipe, from
 * an importer to the process that started it. Quiet tiles are not sent.
 *
 *   offset  size  of the stream
 *        0     8  magic "LFTILES\n"
 *        8     8  the quiet value, a sample of the grid's type, and zeros
 *       16     .  a header of NRRD, as nrrd_write_header() writes it
 *        .     .  slice after slice: its map, then the samples of its busy tiles, as
 *                 slice_tiles_gather() puts them
 *
 * All but the header is in the machine's byte order, since the stream never leaves the machine.
 */
#ifndef FORMATS_GRID_TILE_STREAM_H
#define FORMATS_GRID_TILE_STREAM_H

#include "formats/base/out_stream.h"
#include "formats/grid/slice_source.h"
#include "formats/grid/volume_layout.h"

/* tile_stream_begin() - write all that stands before the slices.
 * tile_stream_slice() - write the next slice; packed: room for a slice. */
CHECKED status tile_stream_begin(out_stream *out, const grid *g, const void *quiet);
CHECKED status tile_stream_slice(out_stream *out, const grid *g, const void *slice,
                                 const uint8_t *busy, void *packed);

/* tile_stream_known() - finds out whether l->data is a tile stream. If so, takes the quiet value
 * from it, so that the NRRD header comes next; quiet: out. */
CHECKED status tile_stream_known(volume_layout *l, bool *known, uint8_t quiet[SLICE_SAMPLE_MAX]);

/* tile_stream_open() - open the slices; l->data is at the first one. As layout_slices_open(). */
CHECKED status tile_stream_open(volume_layout *l, const uint8_t quiet[SLICE_SAMPLE_MAX],
                                slice_source *out);

#endif
