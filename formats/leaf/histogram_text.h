/* histogram_text.h - a histogram for people (bars) and for programs (JSON). */
#ifndef FORMATS_LEAF_HISTOGRAM_TEXT_H
#define FORMATS_LEAF_HISTOGRAM_TEXT_H

#include <jansson.h>
#include <stdio.h>

#include "formats/leaf/histogram.h"

/* histogram_print() - up to 28 lines of bars, as long as the cube roots of the counts, and a mark
 * where isovalues are suggested; what: "samples", "tets". Nothing for a histogram without bins. */
void histogram_print(FILE *to, const histogram *h, const char *what);

/* histogram_print_isovalues() - the suggested isovalues, best first, in one line; nothing where
 * there are none. Before it, in a line, a value that is left aside. */
void histogram_print_isovalues(FILE *to, const histogram *h);

/* histogram_json() - everything, as the man page of `info` lists it: total, drawn, cells, edges,
 * samples, active, gradient, area, suggested, aside. Without memory it is NULL or lacks something:
 * cli_json_write() finds that. */
json_t *histogram_json(const histogram *h);

#endif
