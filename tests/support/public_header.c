#include "tests/support/public_header.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <ctype.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/scratch.h"

/* Comments and lines of the preprocessor become blanks. */
static void blank_out(char *text) {
    bool comment = false, line = false;
    for (char *c = text; *c; c++) {
        if (!comment && c[0] == '/' && c[1] == '*')
            comment = true;
        if (!comment && *c == '#')
            line = true;
        const bool ends = comment && c[0] == '*' && c[1] == '/';
        if (*c == '\n')
            line = false;
        else if (comment || line)
            *c = ' ';
        if (ends) {
            comment = false;
            *++c = ' ';
        }
    }
}

static bool is_word(char c) {
    return isalnum((unsigned char)c) || c == '_';
}

/* The word that ends at `end`. */
static void word_before(const char *begin, const char *end, char out[PUBLIC_HEADER_NAME]) {
    while (end > begin && !is_word(end[-1]))
        end--;
    const char *from = end;
    while (from > begin && is_word(from[-1]))
        from--;
    snprintf(out, PUBLIC_HEADER_NAME, "%.*s", (int)(end - from), from);
}

static void add_member(public_header *h, const char *of, const char *begin, const char *end) {
    const char *bracket = memchr(begin, '[', (size_t)(end - begin));
    const char *pointer = strstr(begin, "(*"); /* a function, or an array that is pointed to */
    const char *name_end = bracket ? bracket : end;
    if (pointer && pointer < end)
        name_end = strchr(pointer, ')');
    assert_true(h->members < PUBLIC_HEADER_MAX);
    snprintf(h->of[h->members], PUBLIC_HEADER_NAME, "%s", of);
    word_before(begin, name_end, h->member[h->members]);
    assert_true(h->member[h->members][0] != '\0');
    h->members++;
}

/* `a, b[3]` of one declaration; commas between parentheses are a function's. */
static void add_declaration(public_header *h, const char *of, const char *begin, const char *end) {
    int depth = 0;
    for (const char *c = begin; c <= end; c++) {
        depth += *c == '(';
        depth -= *c == ')';
        if (c == end || (*c == ',' && depth == 0)) {
            add_member(h, of, begin, c);
            begin = c + 1;
        }
    }
}

static void add_structs(public_header *h, const char *text) {
    static const char begins[] = "typedef struct ";
    for (const char *at = strstr(text, begins); at; at = strstr(at, begins)) {
        at += strlen(begins);
        const char *brace = strpbrk(at, "{;");
        char of[PUBLIC_HEADER_NAME];
        word_before(at, brace, of);
        if (*brace == ';')
            continue; /* opaque */
        for (at = brace + 1; *(at += strspn(at, " \n")) != '}'; at++) {
            const char *end = strchr(at, ';');
            add_declaration(h, of, at, end);
            at = end;
        }
    }
}

static void add_functions(public_header *h, const char *text) {
    static const char mark[] = "LEAFCAST_API ";
    for (const char *at = strstr(text, mark); at; at = strstr(at, mark)) {
        at += strlen(mark);
        assert_true(h->functions < PUBLIC_HEADER_MAX);
        word_before(at, strchr(at, '('), h->function[h->functions++]);
    }
}

void public_header_read(public_header *h, const char *path) {
    char *text = scratch_read(path, NULL);
    blank_out(text);
    add_structs(h, text);
    add_functions(h, text);
    free(text);
}
