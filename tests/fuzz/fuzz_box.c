/* fuzz_box.c - hostile codes of boxes: as they are, or made of fields and what streams hold, with
 * frames that are sound. Coder and independent reader agree, and nothing is written around the
 * boxes. The first byte draws type and shape, the second the way. Seeds: codes of
 * test_box_damage.c.
 */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/box_judge.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { DRAWN = 2, HEADER = 16 };

static const box_shape shapes[] = {
    {1, {{13, 9, 8}}},
    {3, {{7, 7, 3}, {16, 3, 2}, {1, 5, 9}}},
    {1, {{70, 2, 2}}},
    {2, {{1, 1, 1}, {8, 1, 1}}},
};

static unsigned char *make(const box_lab *b, const uint8_t *data, size_t size, bool fits,
                           size_t *bytes) {
    box_made made = {.data = data + HEADER, .data_bytes = size - HEADER, .fits = fits};
    made.code.method = 1;
    made.code.map = data[1] % 33;
    made.code.prediction = data[2] % 17;
    made.code.width = data[3] % 6;
    memcpy(&made.code.base, data + 4, 12);
    if (fits) {
        made.code.coded = (uint32_t)b->samples;
        made.code.base = made.code.map ? made.code.base : 0;
        made.code.background = made.code.prediction & BOX_BACKGROUND ? data[8] : 0;
    }
    return box_judge_make(b, &made, bytes);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    mem m;
    box_lab b;
    bool good;
    if (size < DRAWN + HEADER + 1)
        return 0;
    mem_init(&m, 0);
    const int how = data[1] % 4;
    box_lab_make(&b, (sample_type)(SAMPLE_U8 + data[0] % 5), &shapes[data[0] / 5 % 4],
                 (box_lie)(data[1] / 4 % BOX_LIES));
    size_t bytes = size - DRAWN;
    unsigned char *made = how < 2 ? NULL : make(&b, data + DRAWN, bytes, how == 2, &bytes);
    const char *wrong = box_judge(&m, &b, made ? made : data + DRAWN, bytes, &good);
    if (wrong || mem_used(&m)) {
        fprintf(stderr, "fuzz_box: %s\n", wrong ? wrong : "memory left");
        abort();
    }
    free(made);
    box_lab_release(&b);
    return 0;
}
