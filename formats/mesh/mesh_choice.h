/* mesh_choice.h - what all readers do and say when a mesh file lacks the array that the hints ask
 * for.
 *
 * A mesh without any array gets values of 0. A mesh that has arrays of the cells alone is refused
 * rather than averaged unasked: averaging takes --cells-to-points.
 */
#ifndef FORMATS_MESH_MESH_CHOICE_H
#define FORMATS_MESH_MESH_CHOICE_H

#include <stdbool.h>
#include <stddef.h>

#include "formats/base/name_list.h"
#include "formats/mesh/mesh_sink.h"

/* mesh_choice_missing() - call when no array fits the hints. Returns ST_OK when they ask for none
 * and the file has none; else ST_USAGE, naming the arrays there are and the option for the cells'
 * arrays. */
CHECKED status mesh_choice_missing(const char *file, const mesh_hints *hints,
                                   const name_list *points, const name_list *cells);

/* mesh_choice_component() - returns ST_OK if an array has the hints' component, else ST_USAGE. */
CHECKED status mesh_choice_component(const char *file, const mesh_hints *hints, const char *array,
                                     int components);

#endif
