#include "formats/grid/absent.h"

#include <stdio.h>
#include <string.h>

typedef unsigned long long whole;

status absent_check(const absent_parts *a, const char *file, bool allow_missing) {
    if (allow_missing || a->count == 0 || a->count < a->of)
        return ST_OK;
    return status_describe(ST_CORRUPT,
                           "%s: none of its %llu %s is there: all samples would be the fill value; "
                           "--allow-missing takes them so",
                           file, (whole)a->of, a->parts);
}

void absent_add(absent_parts *sum, const absent_parts *more) {
    if (more->of && !sum->of)
        memcpy(sum->parts, more->parts, sizeof sum->parts);
    sum->count += more->count;
    sum->of += more->of;
}

const char *absent_print(const absent_parts *a, char text[ABSENT_TEXT]) {
    *text = 0;
    if (a->count)
        snprintf(text, ABSENT_TEXT, "%llu of %llu %s %s absent: their samples are the fill value",
                 (whole)a->count, (whole)a->of, a->parts, a->count == 1 ? "is" : "are");
    return text;
}

void absent_pair(const absent_parts *a, char text[ABSENT_TEXT]) {
    snprintf(text, ABSENT_TEXT, "%llu of %llu %s", (whole)a->count, (whole)a->of, a->parts);
}

void absent_parse(const char *text, absent_parts *out) {
    whole count, of;
    char parts[ABSENT_PARTS_MAX];
    if (sscanf(text, "%19llu of %19llu %15[a-z]", &count, &of, parts) != 3 || count > of)
        return;
    *out = (absent_parts){.count = count, .of = of};
    memcpy(out->parts, parts, sizeof parts);
}
