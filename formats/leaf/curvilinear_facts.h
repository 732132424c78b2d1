/* curvilinear_facts.h - what a curvilinear grid's treelet file tells of itself: a row for
 * leaf_tellers.c. */
#ifndef FORMATS_LEAF_CURVILINEAR_FACTS_H
#define FORMATS_LEAF_CURVILINEAR_FACTS_H

#include "formats/leaf/leaf_tell.h"

extern const leaf_teller curvilinear_facts;

#endif
