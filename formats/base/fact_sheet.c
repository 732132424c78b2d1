#include "formats/base/fact_sheet.h"

#include <stdarg.h>

#include "formats/base/cli_json.h"

void fact_sheet_line(const fact_sheet *to, const char *label, const char *fmt, ...) {
    va_list args;
    if (!to->lines)
        return;
    fprintf(to->lines, "%-11s ", label);
    va_start(args, fmt);
    vfprintf(to->lines, fmt, args);
    va_end(args);
    fputc('\n', to->lines);
}

void fact_sheet_row(const fact_sheet *to, const char *fmt, ...) {
    va_list args;
    if (!to->lines)
        return;
    va_start(args, fmt);
    vfprintf(to->lines, fmt, args);
    va_end(args);
    fputc('\n', to->lines);
}

void fact_sheet_count(const fact_sheet *to, const char *label, const char *key, uint64_t count) {
    fact_sheet_line(to, label, "%llu", (unsigned long long)count);
    fact_sheet_whole(to, key, count);
}

void fact_sheet_json(const fact_sheet *to, const char *key, json_t *value) {
    if (to->values)
        json_object_set_new(to->values, key, value);
    else
        json_decref(value);
}

void fact_sheet_whole(const fact_sheet *to, const char *key, uint64_t value) {
    if (to->values)
        fact_sheet_json(to, key, json_integer((json_int_t)value));
}

void fact_sheet_real(const fact_sheet *to, const char *key, double value) {
    if (to->values)
        fact_sheet_json(to, key, cli_json_real(value));
}

void fact_sheet_text(const fact_sheet *to, const char *key, const char *value) {
    if (to->values)
        fact_sheet_json(to, key, json_string(value));
}

void fact_sheet_flag(const fact_sheet *to, const char *key, bool value) {
    if (to->values)
        fact_sheet_json(to, key, json_boolean(value));
}

void fact_sheet_wholes(const fact_sheet *to, const char *key, const uint32_t *values, int count) {
    if (!to->values)
        return;
    json_t *list = json_array();
    for (int i = 0; i < count; i++)
        json_array_append_new(list, json_integer(values[i]));
    fact_sheet_json(to, key, list);
}

void fact_sheet_reals(const fact_sheet *to, const char *key, const double *values, int count) {
    if (!to->values)
        return;
    json_t *list = json_array();
    for (int i = 0; i < count; i++)
        json_array_append_new(list, cli_json_real(values[i]));
    fact_sheet_json(to, key, list);
}

void fact_sheet_frame(const fact_sheet *to, const world_frame *frame) {
    if (to->values)
        cli_json_frame(to->values, frame);
}
