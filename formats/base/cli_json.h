/* cli_json.h - results and errors of the verbs as JSON: one way to write them for all. */
#ifndef FORMATS_BASE_CLI_JSON_H
#define FORMATS_BASE_CLI_JSON_H

#include <jansson.h>
#include <stdbool.h>
#include <stdio.h>

#include "formats/base/status.h"
#include "formats/base/world_frame.h"

/* cli_json_watch() - from now on cli_json_write() knows where memory did not suffice, so that those
 * who make a document need not look. For main programs, before the first document. */
void cli_json_watch(void);

/* cli_json_write() - a document, indented by two blanks, or a line of it; and a newline. Takes the
 * reference. ST_NOMEM where an allocation of jansson's failed since the last call: the document is
 * NULL then, or lacks something, and nothing is written. ST_FAILED where document is NULL
 * otherwise, which is how jansson refuses text that is no UTF-8. What did not reach the stream is
 * fflush()'s to find. */
CHECKED status cli_json_write(FILE *out, json_t *document, bool line);

/* cli_json_error() - {"error": {"status": NAME, "exit": CODE, "message": TEXT}}; the text as
 * text_printable() has it. */
json_t *cli_json_error(status st, int code, const char *message);

/* cli_json_real() - a number, or null where it is not finite: JSON has no other word for it. */
json_t *cli_json_real(double value);

/* cli_json_frame() - what the world's axes mean, into an object: "axes", "units", "time_unit". */
void cli_json_frame(json_t *object, const world_frame *frame);

#endif
