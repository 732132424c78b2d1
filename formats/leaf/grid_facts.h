/* grid_facts.h - what a treelet file of a grid tells of itself: a row of leaf_tellers.c. */
#ifndef FORMATS_LEAF_GRID_FACTS_H
#define FORMATS_LEAF_GRID_FACTS_H

#include "formats/leaf/leaf_tell.h"

extern const leaf_teller grid_facts;
extern const leaf_teller heights_facts; /* of a height field, a grid of one layer of cells */

#endif
