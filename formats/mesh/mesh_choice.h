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

#include "formats/mesh/mesh_input.h"

enum { MESH_CHOICE_TEXT = 400 };

/* Names for a message: "a", "b", ..; each once, cut where there are too many. Start with all
 * zeros. */
typedef struct mesh_choice_names {
    size_t length;
    bool full; /* the text ends in ".." */
    char text[MESH_CHOICE_TEXT];
} mesh_choice_names;

void mesh_choice_add(mesh_choice_names *names, const char *name);

/* mesh_choice_missing() - no array was found that the hints ask for. ST_OK when they ask for none
 * and the file has none; else ST_USAGE: what arrays there are, and the option for those of the
 * cells. */
CHECKED status mesh_choice_missing(const char *file, const mesh_hints *hints,
                                   const mesh_choice_names *points, const mesh_choice_names *cells);

/* mesh_choice_component() - whether an array has the hints' component; else ST_USAGE. */
CHECKED status mesh_choice_component(const char *file, const mesh_hints *hints, const char *array,
                                     int components);

#endif
