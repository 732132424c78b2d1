/* mesh_input_facts.h - what is told of a mesh that is an input: a row of input_facts.c.
 *
 * It is read once. Its points and values are kept (16 bytes per point), its tets are not.
 */
#ifndef FORMATS_MESH_MESH_INPUT_FACTS_H
#define FORMATS_MESH_MESH_INPUT_FACTS_H

#include "formats/input_facts_kind.h"

/* Facts of its own; all but the field only if the values were read. */
typedef struct mesh_input_facts {
    mesh_report report;
    float bounds[6]; /* lo, hi */
} mesh_input_facts;

/* mesh_input_facts_of() - returns those of an input of this kind. */
const mesh_input_facts *mesh_input_facts_of(const input_facts *x);

extern const input_facts_kind mesh_input_facts_kind;

#endif
