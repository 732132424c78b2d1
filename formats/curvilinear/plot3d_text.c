#include "formats/curvilinear/plot3d_text.h"

#include <string.h>

#include "formats/base/text.h"
#include "formats/input/text_number.h"

enum { BUFFER = 1 << 16, WORD_MAX = 64, STRIDE = 1024 };

/* Bytes of a file, as far as they are here. */
typedef struct window {
    const uint8_t *bytes;
    uint64_t from; /* the byte of the file where they begin */
    size_t size, at;
} window;

/* A word: how often it counts, and its number. */
typedef struct word {
    uint64_t place; /* byte of the file */
    uint64_t times;
    char text[WORD_MAX]; /* "": the file ends */
} word;

/* Where a number stands: its word, and how many numbers of that word are before it. */
typedef struct mark {
    uint64_t place, before;
} mark;

struct plot3d_text {
    mem *m;
    file *f;
    uint8_t *buffer;
    window w;
    uint64_t count;
    mark *marks; /* of number 0, STRIDE, 2 STRIDE, .. */
    size_t mark_count, mark_room;
    word word;     /* the last one */
    uint64_t left; /* numbers of it that are not read yet */
    uint64_t next; /* the number that comes next */
};

/* ---- words ---- */

static bool is_gap(uint8_t c) {
    return c == ' ' || c == ',' || (c >= '\t' && c <= '\r');
}

/* Add bytes to a word of so many bytes, up to the next gap or the window's end. False: the word is
 * too long. */
static bool take_bytes(window *w, word *to, size_t *length) {
    for (; w->at < w->size; w->at++) {
        const uint8_t c = w->bytes[w->at];
        if (is_gap(c) && *length > 0)
            return true;
        if (is_gap(c))
            continue;
        if (*length == 0)
            to->place = w->from + w->at;
        if (*length + 1 == WORD_MAX)
            return false;
        to->text[(*length)++] = (char)c;
    }
    return true;
}

/* Take off what stands before an asterisk. A word without one counts once. */
static void take_times(word *w) {
    char *star = strchr(w->text, '*');
    w->times = 1;
    if (!star)
        return;
    *star = 0;
    if (text_number_whole(w->text, &w->times) && w->times > 0 && w->times < UINT64_MAX) {
        memmove(w->text, star + 1, strlen(star + 1) + 1);
        return;
    }
    *star = '*'; /* it is no number, as reading it will tell */
    w->times = 1;
}

/* The line of a byte of the file, from 1: for messages. */
static uint64_t line_of(file *f, uint64_t place) {
    uint8_t bytes[4096];
    uint64_t line = 1;
    for (uint64_t at = 0; at < place; at += sizeof bytes) {
        const size_t size = place - at < sizeof bytes ? (size_t)(place - at) : (size_t)sizeof bytes;
        if (file_read_at(f, at, bytes, size) != ST_OK)
            break;
        for (size_t i = 0; i < size; i++)
            line += bytes[i] == '\n';
    }
    return line;
}

static status refuse_word(const plot3d_text *t) {
    char shown[4 * WORD_MAX];
    return status_describe(ST_CORRUPT, "%s: line %llu: \"%.40s\", expected a number",
                           file_path(t->f), (unsigned long long)line_of(t->f, t->word.place),
                           text_printable(shown, sizeof shown, t->word.text));
}

/* Read on. Nothing is read at the file's end. */
static status fill(plot3d_text *t) {
    window *w = &t->w;
    const uint64_t end = w->from + w->size, left = file_size(t->f) - end;
    const size_t size = left < BUFFER ? (size_t)left : (size_t)BUFFER;
    *w = (window){.bytes = t->buffer, .from = end, .size = size};
    return size ? file_read_at(t->f, end, t->buffer, size) : ST_OK;
}

static status next_word(plot3d_text *t) {
    size_t length = 0;
    bool more = true;
    status st = ST_OK;
    while (st == ST_OK && more) {
        if (t->w.at == t->w.size)
            st = fill(t);
        more = st == ST_OK && t->w.size > 0;
        const bool fits = !more || take_bytes(&t->w, &t->word, &length);
        t->word.text[length] = 0;
        if (!fits)
            return refuse_word(t);
        more = more && t->w.at == t->w.size;
    }
    take_times(&t->word);
    t->left = length ? t->word.times : 0;
    return st;
}

/* ---- numbers ---- */

/* Read a real number as Fortran writes it: 1.5D+3, or 1.5-103 where the exponent has three digits.
 */
static bool read_number(const char *text, double *out) {
    char copy[WORD_MAX + 1];
    size_t n = 0;
    bool exponent = false;
    for (text += *text == '+'; *text; text++) {
        const bool sign = *text == '-' || *text == '+', letter = strchr("dDeE", *text);
        if (sign && n > 0 && !exponent)
            copy[n++] = 'e';
        exponent = exponent || letter || (sign && n > 0);
        copy[n++] = *text == 'd' || *text == 'D' ? 'e' : *text;
        if (n >= WORD_MAX)
            return false;
    }
    copy[n] = 0;
    return text_number_double(copy, out);
}

/* Go to the end of the file; keep marks. */
static status count_numbers(plot3d_text *t) {
    status st = next_word(t);
    for (; st == ST_OK && t->left > 0; st = next_word(t)) {
        const uint64_t first = t->count;
        if (__builtin_add_overflow(first, t->left, &t->count))
            return refuse_word(t);
        for (uint64_t n; (n = (uint64_t)t->mark_count * STRIDE) < t->count; t->mark_count++) {
            st = mem_grow(t->m, &t->marks, sizeof *t->marks, t->mark_count, 64, &t->mark_room);
            if (st != ST_OK)
                return st;
            t->marks[t->mark_count] = (mark){t->word.place, n - first};
        }
    }
    return st;
}

/* Go to a number that was counted. */
static status seek_number(plot3d_text *t, uint64_t number) {
    const mark *m = &t->marks[number / STRIDE];
    status st = ST_OK;
    if (number < t->next || number - t->next >= STRIDE) {
        t->w = (window){.from = m->place};
        st = next_word(t);
        t->next = number - number % STRIDE;
        t->left = t->left > m->before ? t->left - m->before : 0;
    }
    while (st == ST_OK && t->next < number) {
        const uint64_t skip = number - t->next < t->left ? number - t->next : t->left;
        t->left -= skip;
        t->next += skip;
        if (t->left == 0 && t->next < number) {
            st = next_word(t);
            if (st == ST_OK && t->left == 0)
                break; /* it is shorter than it was, as reading will tell */
        }
    }
    return st;
}

status plot3d_text_read(plot3d_text *t, uint64_t first, size_t count, double *out) {
    status st = first == t->next ? ST_OK : seek_number(t, first);
    for (size_t done = 0; st == ST_OK && done < count;) {
        double value;
        if (t->left == 0)
            st = next_word(t);
        if (st != ST_OK)
            break;
        if (t->left == 0)
            return status_describe(
                ST_CORRUPT, "%s: ends at byte %llu, expected %llu numbers as before",
                file_path(t->f), (unsigned long long)file_size(t->f), (unsigned long long)t->count);
        if (!read_number(t->word.text, &value))
            return refuse_word(t);
        for (; t->left > 0 && done < count; t->left--)
            out[done++] = value;
    }
    t->next = st == ST_OK ? first + count : UINT64_MAX;
    return st;
}

/* ---- the first numbers ---- */

/* Put a word's number as often as it counts; false: it is none of them, or there is no more room.
 */
static bool put_wholes(const word *w, size_t most, uint8_t *out, size_t *count) {
    uint64_t value;
    if (!text_number_whole(w->text, &value) || value > INT32_MAX)
        return false;
    for (uint64_t i = 0; i < w->times && *count < most; i++, (*count)++)
        for (int k = 0; k < 4; k++)
            out[4 * *count + (size_t)k] = (uint8_t)(value >> (24 - 8 * k));
    return *count < most;
}

status plot3d_text_wholes(plot3d_text *t, size_t most, uint8_t *out, size_t *count) {
    *count = 0;
    t->w = (window){0};
    t->next = UINT64_MAX;
    status st = next_word(t);
    while (st == ST_OK && t->left > 0 && put_wholes(&t->word, most, out, count))
        st = next_word(t);
    return st;
}

size_t plot3d_text_wholes_at(const uint8_t *start, size_t size, size_t most, uint8_t *out) {
    window w = {.bytes = start, .size = size};
    size_t count = 0;
    for (bool more = true; more;) {
        word next = {0};
        size_t length = 0;
        more = take_bytes(&w, &next, &length) && w.at < size;
        next.text[length < WORD_MAX ? length : 0] = 0;
        take_times(&next);
        more = more && put_wholes(&next, most, out, &count);
    }
    return count;
}

bool plot3d_text_known(const uint8_t *start, size_t size) {
    static const char others[] = "+-.*eEdDnNaAiIfFtTyY";
    const size_t looked = size < 512 ? size : 512;
    bool digits = false;
    for (size_t i = 0; i < looked; i++) {
        const bool digit = start[i] >= '0' && start[i] <= '9';
        digits = digits || digit;
        if (!digit && !is_gap(start[i]) && !memchr(others, start[i], sizeof others - 1))
            return false;
    }
    return digits;
}

/* ---- opening ---- */

status plot3d_text_open(mem *m, file *f, plot3d_text **out) {
    plot3d_text *t = *out = mem_zalloc(m, sizeof *t);
    if (!t)
        return ST_NOMEM;
    t->m = m;
    t->f = f;
    t->buffer = mem_alloc(m, BUFFER);
    const status st = t->buffer ? count_numbers(t) : ST_NOMEM;
    t->next = UINT64_MAX;
    return st;
}

void plot3d_text_close(plot3d_text *t) {
    if (!t)
        return;
    mem_free(t->m, t->buffer);
    mem_free(t->m, t->marks);
    mem_free(t->m, t);
}

uint64_t plot3d_text_count(const plot3d_text *t) {
    return t->count;
}
