/* input_trust.h - what the user allows an input to do that is refused otherwise. Zeros: nothing. */
#ifndef FORMATS_INPUT_INPUT_TRUST_H
#define FORMATS_INPUT_INPUT_TRUST_H

#include <stdbool.h>

typedef struct input_trust {
    bool follow_links;  /* it may name files that lie anywhere: named_file.h */
    bool allow_missing; /* it may lack parts that it should have, even all of them; they are the
                           fill value: absent.h */
} input_trust;

#endif
