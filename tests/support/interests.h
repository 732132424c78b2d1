/* interests.h - interests as they were given, before anybody sorts or merges them, and what meets
 * them by definition. */
#ifndef TESTS_SUPPORT_INTERESTS_H
#define TESTS_SUPPORT_INTERESTS_H

#include "stream/interest.h"
#include "tests/support/fields.h"

typedef struct interests {
    int count;
    interest_interval raw[INTEREST_MAX];
    interest in; /* made of them */
} interests;

void interests_of_isovalues(interests *set, const double isovalues[], int count);
void interests_of_all(interests *set);

/* interests_random() - 1 to INTEREST_MAX isovalues and closed, half-open, open, one-value and
 * infinite intervals, with ends at, beside and between these values. */
void interests_random(interests *set, field_random *r, const double values[], int count);

/* interests_meet() - whether one of the raw intervals is met by the range min .. max. */
bool interests_meet(const interests *set, double min, double max);

/* interests_name() - as text; valid until the next call. */
const char *interests_name(const interests *set);

#endif
