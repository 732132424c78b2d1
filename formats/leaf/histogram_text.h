/* histogram_text.h - a histogram for people (bars) and for programs (JSON). */
#ifndef FORMATS_LEAF_HISTOGRAM_TEXT_H
#define FORMATS_LEAF_HISTOGRAM_TEXT_H

#include <jansson.h>
#include <stdio.h>

#include "formats/leaf/histogram.h"

/* histogram_print() - print up to 28 lines of bars, as long as the cube roots of the counts, with a
 * mark at suggested isovalues. what: "samples", "tets". Prints nothing for a histogram without
 * bins. isovalues: whether any are suggested, here and below. */
void histogram_print(FILE *to, const histogram *h, const char *what, bool isovalues);

/* histogram_print_isovalues() - print the suggested isovalues in a line, best first; nothing where
 * there are none. If there is a marker, a line before it names that value. */
void histogram_print_isovalues(FILE *to, const histogram *h, bool isovalues);

/* histogram_json() - all of a histogram, as the man page of `info` lists it: total, drawn, cells,
 * edges, samples, active, gradient, area, suggested, aside. If memory runs out, the result is NULL
 * or incomplete; cli_json_write() notices. */
json_t *histogram_json(const histogram *h, bool isovalues);

#endif
