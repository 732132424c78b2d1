/* input_trust.h - what the user allows an input that would be refused otherwise. Zeros: nothing. */
#ifndef FORMATS_INPUT_INPUT_TRUST_H
#define FORMATS_INPUT_INPUT_TRUST_H

#include <stdbool.h>

typedef struct input_trust {
    bool follow_links;  /* to name files that lie anywhere: named_file.h */
    bool allow_missing; /* to lack parts that it should have: they are the fill value, even where
                           all of them are: absent.h */
} input_trust;

#endif
