/* mixed_facts.h - what a mixed mesh's treelet file tells of itself: a row for leaf_tellers.c. */
#ifndef FORMATS_LEAF_MIXED_FACTS_H
#define FORMATS_LEAF_MIXED_FACTS_H

#include "formats/leaf/leaf_tell.h"

extern const leaf_teller mixed_facts;

#endif
