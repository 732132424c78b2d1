/* piece_bytes.h - encoders of a piece's elements, for the arrays of file formats.
 */
#ifndef PREP_EXPORT_PIECE_BYTES_H
#define PREP_EXPORT_PIECE_BYTES_H

#include "prep/export/piece_format.h"

/* Per vertex. points: coordinates, as doubles or floats (info->floats). records: coordinates, the
 * normal in floats and, with several isovalues, the isovalue as a double. given: coordinates and
 * the values of all fields, colours as bytes, with the normal before them if it has any. normals;
 * isovalues; values of a field. */
char *piece_bytes_points(const piece_view *v, const piece_array *a, char *to);
char *piece_bytes_records(const piece_view *v, const piece_array *a, char *to);
char *piece_bytes_given(const piece_view *v, const piece_array *a, char *to);
char *piece_bytes_normals(const piece_view *v, const piece_array *a, char *to);
char *piece_bytes_isovalues(const piece_view *v, const piece_array *a, char *to);
char *piece_bytes_values(const piece_view *v, const piece_array *a, char *to);

/* piece_bytes_is_colour() - whether a field holds colours (triangle_geometry.h). */
bool piece_bytes_is_colour(const piece_info *info, uint32_t field);

/* Per cell. faces: the count 3 in a byte, then corners in 32 bits (PLY). facets: normal, corners
 * and 16 zero bits (STL). offsets: where the next cell's corners begin. shapes: VTK's number of the
 * shape in a byte. Per corner. corners: in 64 bits. */
char *piece_bytes_faces(const piece_view *v, const piece_array *a, char *to);
char *piece_bytes_facets(const piece_view *v, const piece_array *a, char *to);
char *piece_bytes_corners(const piece_view *v, const piece_array *a, char *to);
char *piece_bytes_offsets(const piece_view *v, const piece_array *a, char *to);
char *piece_bytes_shapes(const piece_view *v, const piece_array *a, char *to);

#endif
