/* render_script.h - pictures described in JSON: the lines of render --script, the entries of
 * --camera-path.
 *
 * An object's keys are render's flags without their dashes ('_' for '-' is fine):
 *
 *   {"eye": [300, 0, 40], "shadows": true}
 *
 * A vector is an array of numbers or the flag's text; a flag that may be repeated takes an array of
 * values; a flag without a value takes true or false, one whose value may be left out that or the
 * value. Besides:
 *
 *   "camera"               an object with eye, look_at, up, fov, view: as these keys outside
 *   "isovalues"            the same as "iso"
 *   "output", "depth_f64", "rgba_f64", "error_f64", "value_f64", "write_tf"  files to write
 *
 * A key replaces what the command line said for that flag; what is not said stays as it is there.
 */
#ifndef RENDER_APP_RENDER_SCRIPT_H
#define RENDER_APP_RENDER_SCRIPT_H

#include <jansson.h>
#include <stdio.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "render/app/image_out.h"
#include "render/app/view_options.h"

enum { SCRIPT_PATH_MAX = 4096, SCRIPT_TEXT_MAX = 1024 };

/* The files of a picture: itself, raw planes as image_raw numbers them, its transfer function. */
typedef enum frame_file {
    FRAME_PICTURE,
    FRAME_RAW,
    FRAME_TF = FRAME_RAW + IMAGE_RAWS,
    FRAME_FILES
} frame_file;

/* One picture to draw. */
typedef struct script_frame {
    view_options view;
    char file[FRAME_FILES][SCRIPT_PATH_MAX];    /* "": it is not written */
    double suggested[LEAFCAST_SUGGESTIONS_MAX]; /* by render_job_check(): the first is drawn; */
    int suggestions;                            /* 0: the isovalues were given */
} script_frame;

/* script_apply() - put what an object says into *frame, which holds what was there before. ST_USAGE
 * naming `what` ("line 3") and the key. An object "page" is the viewer's, and skipped. */
CHECKED status script_apply(script_frame *frame, json_t *object, const char *what);

/* script_text() - a flag's text: a number, a string, or an array of them joined by commas. ST_USAGE
 * naming `what` and `key`. */
CHECKED status script_text(const json_t *value, const char *what, const char *key,
                           char text[SCRIPT_TEXT_MAX]);

/* script_parse() - script_apply() from text. */
CHECKED status script_parse(script_frame *frame, const char *text, size_t size, const char *what);

/* script_load_path() - a camera path: a file with an array of objects. *path is the caller's to
 * json_decref(). */
CHECKED status script_load_path(const char *file, json_t **path);

/* script_load_state() - put what an object in a file says into *view: a view that the viewer has
 * saved. ST_CORRUPT: no JSON; ST_USAGE as script_apply(), also for files to write. */
CHECKED status script_load_state(const char *file, view_options *view);

/* ---- lines, as they come ---- */

typedef struct script_reader script_reader;

/* script_open() - "-" is standard input. */
CHECKED status script_open(mem *m, const char *path, script_reader **out);
void script_close(script_reader *r); /* NULL is fine */

/* script_line() - the next line that is not blank, without its end; valid until the next call.
 * ST_OK with *line NULL at the end of the script. Waits for what is not there yet; ST_STOPPED as
 * soon as stop() says so (a signal wakes it). */
CHECKED status script_line(script_reader *r, bool (*stop)(void *), void *ctx, const char **line,
                           size_t *size, long *number);

#endif
