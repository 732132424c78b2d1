/* piece_bytes.h - the elements of a piece, as files have them: what encodes the arrays of formats.
 */
#ifndef PREP_EXPORT_PIECE_BYTES_H
#define PREP_EXPORT_PIECE_BYTES_H

#include "prep/export/piece_format.h"

/* Of vertices: their coordinates (doubles, or floats where the file has these), then those followed
 * by the normal in floats and, where there are several isovalues, the isovalue as a double;
 * normals; isovalues; values of a field. */
char *piece_bytes_points(const piece_view *v, const piece_array *a, char *to);
char *piece_bytes_records(const piece_view *v, const piece_array *a, char *to);
char *piece_bytes_normals(const piece_view *v, const piece_array *a, char *to);
char *piece_bytes_isovalues(const piece_view *v, const piece_array *a, char *to);
char *piece_bytes_values(const piece_view *v, const piece_array *a, char *to);

/* Of cells: the count 3 in a byte and the corners in 32 bits (PLY); the facet's normal, its corners
 * and 16 zero bits (STL); corners in 64 bits; where the next cell's corners begin; VTK's number of
 * tets in a byte. */
char *piece_bytes_faces(const piece_view *v, const piece_array *a, char *to);
char *piece_bytes_facets(const piece_view *v, const piece_array *a, char *to);
char *piece_bytes_corners(const piece_view *v, const piece_array *a, char *to);
char *piece_bytes_offsets(const piece_view *v, const piece_array *a, char *to);
char *piece_bytes_tets(const piece_view *v, const piece_array *a, char *to);

#endif
