#include "formats/base/text.h"

#include <assert.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

/* The size in bytes of the UTF-8 character at `at`, a NUL-terminated text. 0: not a valid one (RFC
 * 3629: neither overlong, nor a surrogate, nor beyond U+10FFFF). */
static size_t character(const char *at, uint32_t *code) {
    static const uint32_t least[5] = {0, 0, 0x80, 0x800, 0x10000};
    const uint8_t first = (uint8_t)*at;
    const size_t size = first < 0x80   ? 1
                        : first < 0xc0 ? 0
                        : first < 0xe0 ? 2
                        : first < 0xf0 ? 3
                        : first < 0xf8 ? 4
                                       : 0;
    *code = size == 1 ? first : first & (0x7fu >> size);
    for (size_t i = 1; i < size; i++) {
        const uint8_t next = (uint8_t)at[i];
        if ((next & 0xc0) != 0x80)
            return 0;
        *code = *code << 6 | (next & 0x3fu);
    }
    const bool surrogate = *code >= 0xd800 && *code < 0xe000;
    return size == 0 || *code < least[size] || surrogate || *code > 0x10ffff ? 0 : size;
}

static bool is_control(uint32_t code) {
    return code < 0x20 || (code >= 0x7f && code < 0xa0);
}

/* Returns the next character of *from as text_name() keeps it, and its size. Moves *from behind
 * it. */
static const char *keep(const char **from, size_t *size) {
    uint32_t code = 0;
    const char *at = *from;
    *size = character(at, &code);
    *from += *size ? *size : 1;
    if (*size > 0 && !is_control(code))
        return at;
    *size = 3;
    return "\xef\xbf\xbd";
}

void text_name(char *to, size_t room, const char *from) {
    char kept[TEXT_NAME_MAX];
    size_t length = 0, size = 0;
    assert(room > 0 && room <= sizeof kept);
    while (*from) {
        const char *next = keep(&from, &size);
        if (length + size >= room)
            break;
        memcpy(kept + length, next, size);
        length += size;
    }
    memcpy(to, kept, length);
    to[length] = 0;
}

const char *text_stem(const char *path, size_t *length) {
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
    const char *dot = strrchr(name, '.');
    *length = dot && dot > name ? (size_t)(dot - name) : strlen(name);
    return name;
}

void text_file_name(char *to, size_t room, const char *path) {
    char front[TEXT_NAME_MAX];
    size_t length;
    const char *name = text_stem(path, &length);
    length = length < sizeof front ? length : sizeof front - 1;
    memcpy(front, name, length);
    front[length] = 0;
    text_name(to, room, front);
}

void text_add(char *to, size_t room, const char *fmt, ...) {
    const size_t length = strlen(to);
    va_list args;
    va_start(args, fmt);
    const int more = vsnprintf(to + length, room - length, fmt, args);
    va_end(args);
    assert(more >= 0 && (size_t)more < room - length);
    (void)more;
}

bool text_ends_in(const char *path, const char *suffix) {
    const size_t length = strlen(path), tail = strlen(suffix);
    return length >= tail && strcasecmp(path + length - tail, suffix) == 0;
}

bool text_same_name(const char *a, const char *b, size_t room) {
    char first[TEXT_NAME_MAX], second[TEXT_NAME_MAX];
    text_name(first, room, a);
    text_name(second, room, b);
    return strcmp(first, second) == 0;
}

/* Write the next character of *from as it may be printed, and move *from behind it. */
static void escape(const char **from, char out[8]) {
    static const char digits[] = "0123456789abcdef";
    uint32_t code = 0;
    const char *at = *from;
    const size_t size = character(at, &code);
    *from += size ? size : 1;
    if (size > 0 && !is_control(code)) {
        memcpy(out, at, size);
        out[size] = 0;
    } else if (*at == '\n' || *at == '\t') {
        memcpy(out, *at == '\n' ? "\\n" : "\\t", 3);
    } else {
        /* Print a control character of two bytes, U+0080 to U+009F, by its code. */
        const uint32_t byte = size > 1 ? code : (uint8_t)*at;
        memcpy(out, (const char[5]){'\\', 'x', digits[byte >> 4], digits[byte & 15]}, 5);
    }
}

char *text_printable(char *to, size_t room, const char *from) {
    size_t length = 0;
    while (*from) {
        char next[8];
        escape(&from, next);
        const size_t size = strlen(next);
        if (length + size >= room)
            break;
        memcpy(to + length, next, size);
        length += size;
    }
    if (room > 0)
        to[length] = 0;
    return to;
}
