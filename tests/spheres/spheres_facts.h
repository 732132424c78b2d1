/* spheres_facts.h - what a treelet file of spheres tells of itself. */
#ifndef TESTS_SPHERES_SPHERES_FACTS_H
#define TESTS_SPHERES_SPHERES_FACTS_H

#include "formats/leaf/leaf_tell.h"

extern const leaf_teller spheres_facts;

#endif
