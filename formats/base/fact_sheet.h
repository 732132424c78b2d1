/* fact_sheet.h - what something tells of itself, in two forms at once: lines for people, and keys
 * with values for programs.
 *
 * Whoever has facts gives each one in both forms, one after the other, and never asks which form is
 * wanted. The lines and the values keep the order of the calls, each by themselves.
 */
#ifndef FORMATS_BASE_FACT_SHEET_H
#define FORMATS_BASE_FACT_SHEET_H

#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "formats/base/world_frame.h"

typedef struct fact_sheet {
    FILE *lines;    /* NULL: no lines are wanted */
    json_t *values; /* an object; NULL: no values are wanted */
} fact_sheet;

/* fact_sheet_line() - print a line that begins with a label; "": one that continues the line
 * before. fact_sheet_row() - print a line of a table, as it is, without its end. fact_sheet_count()
 * - give a number in both forms. */
void fact_sheet_line(const fact_sheet *to, const char *label, const char *fmt, ...)
    __attribute__((format(printf, 3, 4)));
void fact_sheet_row(const fact_sheet *to, const char *fmt, ...)
    __attribute__((format(printf, 2, 3)));
void fact_sheet_count(const fact_sheet *to, const char *label, const char *key, uint64_t count);

/* The following set a value. fact_sheet_real(): null where it is not finite. fact_sheet_json()
 * takes the reference. If memory runs out, values are missing; cli_json_write() notices. */
void fact_sheet_whole(const fact_sheet *to, const char *key, uint64_t value);
void fact_sheet_real(const fact_sheet *to, const char *key, double value);
void fact_sheet_text(const fact_sheet *to, const char *key, const char *value);
void fact_sheet_flag(const fact_sheet *to, const char *key, bool value);
void fact_sheet_wholes(const fact_sheet *to, const char *key, const uint32_t *values, int count);
void fact_sheet_reals(const fact_sheet *to, const char *key, const double *values, int count);
void fact_sheet_json(const fact_sheet *to, const char *key, json_t *value);

/* fact_sheet_frame() - set what the world's axes mean: "axes", "units", "time_unit". */
void fact_sheet_frame(const fact_sheet *to, const world_frame *frame);

#endif
