/* triangle_facts.h - what `info` tells of a surface of triangles: a row of leaf_tellers.c. */
#ifndef FORMATS_LEAF_TRIANGLE_FACTS_H
#define FORMATS_LEAF_TRIANGLE_FACTS_H

#include "formats/leaf/leaf_tell.h"

extern const leaf_teller triangle_facts;

#endif
