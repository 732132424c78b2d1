#include "formats/input/lzf.h"

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

enum { LITERALS = 32, LONG = 7, SHORTEST = 2 };

/* An item: the bytes of the stream that it takes, the bytes that it gives, and how far before the
 * end its source lies; 0: its bytes are literal. */
typedef struct item {
    size_t taken, given, back;
} item;

/* Read an item. Returns false when the stream ends inside it. */
static bool next_item(const uint8_t *at, size_t left, item *i) {
    const size_t control = at[0], length = control >> 5;
    if (control < LITERALS) {
        *i = (item){.taken = control + 2, .given = control + 1};
        return i->taken <= left;
    }
    i->taken = length == LONG ? 3 : 2;
    if (i->taken > left)
        return false;
    i->given = length + SHORTEST + (length == LONG ? at[1] : 0);
    i->back = 1 + 256 * (control & 31) + at[i->taken - 1];
    return true;
}

const char *lzf_size(const void *packed, size_t size, size_t *unpacked) {
    const uint8_t *at = packed;
    item i;
    *unpacked = 0;
    for (size_t done = 0; done < size; done += i.taken) {
        if (!next_item(at + done, size - done, &i))
            return "LZF: it ends inside of an item";
        if (i.back > *unpacked)
            return "LZF: a reference to before the first byte";
        *unpacked += i.given;
    }
    return NULL;
}

/* Copy bytes that are out already. Where source and copy overlap, a pattern repeats. */
static void repeat(uint8_t *to, size_t back, size_t count) {
    const uint8_t *from = to - back;
    for (size_t i = 0; i < count; i++)
        to[i] = from[i];
}

void lzf_unpack(const void *packed, size_t size, void *to) {
    const uint8_t *at = packed, *const end = at + size;
    uint8_t *out = to;
    item i;
    for (; at < end && next_item(at, (size_t)(end - at), &i); at += i.taken) {
        if (i.back == 0)
            memcpy(out, at + 1, i.given);
        else
            repeat(out, i.back, i.given);
        out += i.given;
    }
}
