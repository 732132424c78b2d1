#include "formats/base/cli_json.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/fault.h"
#include "formats/base/text.h"

/* Whether an allocation failed since the last document was written. An array or object may then
 * lack an entry, and the code that appended it did not check. */
static atomic_bool starved;

static void *allocate(size_t size) {
    void *block = fault_hit(FAULT_ALLOC) ? NULL : malloc(size);
    if (!block)
        starved = true;
    return block;
}

void cli_json_watch(void) {
    json_set_alloc_funcs(allocate, free);
}

status cli_json_write(FILE *out, json_t *document, bool line) {
    const size_t layout = line ? JSON_COMPACT : JSON_INDENT(2);
    char *text = document ? json_dumps(document, layout | JSON_REAL_PRECISION(17)) : NULL;
    status st = ST_OK;
    json_decref(document);
    const bool no_memory = atomic_exchange(&starved, false);
    if (text && !no_memory) {
        fputs(text, out);
        fputc('\n', out);
    } else {
        st = no_memory ? status_describe(ST_NOMEM, "no memory to write the results as JSON")
                       : status_describe(ST_FAILED, "the results cannot be written as JSON");
    }
    free(text);
    return st;
}

static const char *name_of(status st) {
    static const char *const names[] = {
        [ST_OK] = "ok",           [ST_AGAIN] = "again",      [ST_USAGE] = "usage",
        [ST_CORRUPT] = "corrupt", [ST_NOMEM] = "no memory",  [ST_UNSUPPORTED] = "unsupported",
        [ST_IO] = "io",           [ST_NOSPACE] = "no space", [ST_EXISTS] = "exists",
        [ST_STOPPED] = "stopped", [ST_FAILED] = "failed"};
    return names[st];
}

json_t *cli_json_error(status st, int code, const char *message) {
    char text[4 * STATUS_TEXT_MAX];
    return json_pack("{s:{s:s, s:i, s:s}}", "error", "status", name_of(st), "exit", code, "message",
                     text_printable(text, sizeof text, message));
}

json_t *cli_json_real(double value) {
    return isfinite(value) ? json_real(value) : json_null();
}

json_t *cli_json_reals(const double *x, int count) {
    json_t *list = json_array();
    for (int i = 0; i < count; i++)
        json_array_append_new(list, cli_json_real(x[i]));
    return list;
}

json_t *cli_json_count(uint64_t n) {
    return json_integer((json_int_t)n);
}

void cli_json_frame(json_t *object, const world_frame *frame) {
    json_t *units = json_array();
    for (int a = 0; a < 3; a++)
        json_array_append_new(units, json_string(frame->unit[a]));
    json_object_set_new(object, "axes", json_string(world_axes_name(frame->axes)));
    json_object_set_new(object, "units", units);
    json_object_set_new(object, "time_unit", json_string(frame->time_unit));
}
