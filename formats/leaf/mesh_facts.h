/* mesh_facts.h - what a treelet file of a mesh tells of itself: a row of leaf_tellers.c. */
#ifndef FORMATS_LEAF_MESH_FACTS_H
#define FORMATS_LEAF_MESH_FACTS_H

#include "formats/leaf/leaf_tell.h"

extern const leaf_teller mesh_facts;

#endif
