/* naive_places.h - where the payloads of a grid lie, and what has none of its own, from sections 4,
 * 10 and 14 of formats/FORMAT.md alone. */
#ifndef TESTS_SUPPORT_NAIVE_PLACES_H
#define TESTS_SUPPORT_NAIVE_PLACES_H

#include "tests/support/naive_leaf.h"

/* naive_places_read() - find all payloads by the directory, and check that they fill the file.
 * False: leaf->why says what is wrong. */
bool naive_places_read(naive_leaf *leaf);

#endif
