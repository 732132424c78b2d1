/* volume_facts.h - what is told of a grid that is an input: a row of input_facts.c.
 *
 * The samples are read once, as a stream, in blocks of up to 32 MiB, or a quarter of the budget if
 * that is less.
 */
#ifndef FORMATS_GRID_VOLUME_FACTS_H
#define FORMATS_GRID_VOLUME_FACTS_H

#include "formats/grid/grid.h"
#include "formats/input_facts_kind.h"

/* Facts of its own. */
typedef struct volume_facts {
    uint32_t dims[3];
    sample_type type, source; /* as read; as in the file */
    double to_world[12];
    bool rectilinear;
    absent_parts absent;
    char note[GRID_NOTE_MAX]; /* see struct grid */
} volume_facts;

/* volume_facts_of() - returns those of an input of this kind. */
const volume_facts *volume_facts_of(const input_facts *x);

extern const input_facts_kind volume_facts_kind;

#endif
