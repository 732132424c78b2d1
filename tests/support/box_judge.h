/* box_judge.h - codes of boxes as they should not be, and who says so: the coder, on each ISA, and
 * the independent reader agree on every code, and no byte around the boxes changes.
 */
#ifndef TESTS_SUPPORT_BOX_JUDGE_H
#define TESTS_SUPPORT_BOX_JUDGE_H

#include "tests/support/box_lab.h"

/* A code to be made. Streams are as long as the fields say. */
typedef struct box_made {
    box_code code;
    const unsigned char *data; /* what streams are of, again and again; 1 byte or more */
    size_t data_bytes;
    bool fits; /* make the map a possible one, and code.coded what it says */
} box_made;

/* box_judge_make() - the bytes of a code; malloc'ed. coded: up to 2^16. */
unsigned char *box_judge_make(const box_lab *b, box_made *made, size_t *bytes);

/* box_judge() - decode. Returns NULL, or on what they do not agree. *good: whether it is a code. */
const char *box_judge(mem *m, box_lab *b, const unsigned char *code, size_t bytes, bool *good);

#endif
