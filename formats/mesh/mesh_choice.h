/* mesh_choice.h - the array that the hints ask for and a mesh file does not have: what all readers
 * do and say then.
 *
 * A mesh without any array is one of zeros. One that has some of the cells alone is refused rather
 * than averaged unasked: that takes --cells-to-points.
 */
#ifndef FORMATS_MESH_MESH_CHOICE_H
#define FORMATS_MESH_MESH_CHOICE_H

#include <stdbool.h>
#include <stddef.h>

#include "formats/base/name_list.h"
#include "formats/mesh/mesh_sink.h"

/* mesh_choice_missing() - no array was found that the hints ask for. ST_OK when they ask for none
 * and the file has none; else ST_USAGE: what arrays there are, and the option for those of the
 * cells. */
CHECKED status mesh_choice_missing(const char *file, const mesh_hints *hints,
                                   const name_list *points, const name_list *cells);

/* mesh_choice_component() - whether an array has the hints' component; else ST_USAGE. */
CHECKED status mesh_choice_component(const char *file, const mesh_hints *hints, const char *array,
                                     int components);

#endif
