/* cli_json.h - results and errors of the verbs as JSON, written in one way for all. */
#ifndef FORMATS_BASE_CLI_JSON_H
#define FORMATS_BASE_CLI_JSON_H

#include <jansson.h>
#include <stdbool.h>
#include <stdio.h>

#include "formats/base/status.h"
#include "formats/base/world_frame.h"

/* cli_json_watch() - from now on cli_json_write() notices failed allocations, so that code that
 * builds a document need not check each. For main programs, before the first document. */
void cli_json_watch(void);

/* cli_json_write() - write a document indented by two blanks, or as one line, and a newline. Takes
 * the reference. Returns ST_NOMEM where an allocation of jansson's failed since the last call: then
 * the document is NULL or incomplete, and nothing is written. Returns ST_FAILED for any other NULL
 * document: jansson gives NULL for text that is not UTF-8. Errors of the stream itself are left to
 * fflush(). */
CHECKED status cli_json_write(FILE *out, json_t *document, bool line);

/* cli_json_error() - {"error": {"status": NAME, "exit": CODE, "message": TEXT}}; the text is
 * escaped by text_printable(). */
json_t *cli_json_error(status st, int code, const char *message);

/* cli_json_real() - a number, or null where it is not finite, which JSON cannot write. */
json_t *cli_json_real(double value);

/* cli_json_reals() - a list of such numbers. cli_json_count() - a number of things. */
json_t *cli_json_reals(const double *x, int count);
json_t *cli_json_count(uint64_t n);

/* cli_json_frame() - add what the world's axes mean to an object: "axes", "units", "time_unit". */
void cli_json_frame(json_t *object, const world_frame *frame);

#endif
