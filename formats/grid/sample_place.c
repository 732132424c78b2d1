#include "formats/grid/sample_place.h"

#include <endian.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { BLOCK = 512 }; /* samples */

static const char chunks[] = "chunks";

const char *sample_place_print(const sample_place *p, char text[GRID_PLACE_MAX]) {
    if (p->refused || p->chunks) {
        snprintf(text, GRID_PLACE_MAX, "%s%s", p->refused ? SAMPLE_PLACE_REFUSED : chunks,
                 p->refused ? p->refused : "");
        return text;
    }
    int length = snprintf(text, GRID_PLACE_MAX, "%llu %s %s", (unsigned long long)p->offset,
                          sample_name(p->stored.type), p->big_endian ? "big" : "little");
    if (p->stored.slope != 0 || p->has_missing)
        length += snprintf(text + length, GRID_PLACE_MAX - (size_t)length, " %a %a",
                           p->stored.slope, p->stored.intercept);
    if (p->has_missing)
        snprintf(text + length, GRID_PLACE_MAX - (size_t)length, " %a", p->missing);
    return text;
}

bool sample_place_is_chunks(const char *text) {
    return strcmp(text, chunks) == 0;
}

/* Offset, type, byte order; slope and intercept; missing. */
enum { PLACE_WORDS = 3, SCALED_WORDS = 5, MISSING_WORDS = 6 };

bool sample_place_parse(const char *text, sample_place *out) {
    unsigned long long offset;
    char type[8], order[8], more;
    stored_samples *s = &out->stored;
    *out = (sample_place){0};
    const int words = sscanf(text, "%llu %7s %7s %la %la %la %c", &offset, type, order, &s->slope,
                             &s->intercept, &out->missing, &more);
    if ((words != PLACE_WORDS && words != SCALED_WORDS && words != MISSING_WORDS) ||
        !sample_parse(type, &s->type) || !isfinite(s->slope) || !isfinite(s->intercept) ||
        (strcmp(order, "big") != 0 && strcmp(order, "little") != 0))
        return false;
    out->has_missing = words == MISSING_WORDS;
    out->offset = offset;
    out->big_endian = order[0] == 'b';
    return true;
}

/* The type of the samples once missing data are marked. */
static sample_type type_marked(const sample_place *p) {
    const sample_type type = stored_samples_type(&p->stored);
    return p->has_missing && sample_is_integer(type) ? SAMPLE_F32 : type;
}

sample_type sample_place_type(const sample_place *p) {
    return sample_stored(type_marked(p));
}

/* Convert a block. Widening puts the samples at the end of their room. */
static bool take_block(const sample_place *p, void *in, void *out, size_t count) {
    const sample_type read = stored_samples_type(&p->stored), marked = type_marked(p);
    double room[BLOCK];
    char *at = (char *)room + count * (sample_size(marked) - sample_size(read));
    if (stored_samples_take(&p->stored, in, read, at, count) < count)
        return false;
    if (p->has_missing && sample_mark_missing(read, at, room, count, p->missing) < count)
        return false;
    (void)sample_to_stored(marked, room, out, count);
    return true;
}

bool sample_place_take(const sample_place *p, void *in, void *out, size_t count) {
    const stored_samples *s = &p->stored;
    const sample_type type = sample_place_type(p);
    const size_t from = stored_samples_bytes(s), to = sample_size(type);
    if (p->big_endian != (__BYTE_ORDER == __BIG_ENDIAN))
        sample_swap(s->type, in, count * (from / sample_size(s->type)));
    if (stored_samples_plain(s) && !p->has_missing && type == s->type) {
        memcpy(out, in, count * to);
        return true;
    }
    bool good = true;
    for (size_t done = 0, n; done < count && good; done += n) {
        n = count - done < BLOCK ? count - done : BLOCK;
        good = take_block(p, (char *)in + done * from, (char *)out + done * to, n);
    }
    return good;
}
