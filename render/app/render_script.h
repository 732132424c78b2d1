/* render_script.h - read pictures described in JSON: the lines of render --script, the entries of
 * --camera-path.
 *
 * The keys of an object are render's flags without their dashes ('_' for '-' is allowed):
 *
 *   {"eye": [300, 0, 40], "shadows": true}
 *
 * A vector is an array of numbers, or the flag's text. A repeatable flag takes an array of values.
 * A flag without a value takes true or false; a flag with an optional value takes true, false or
 * the value. Other keys:
 *
 *   "camera"               an object with eye, look_at, up, fov, view: the same as these keys
 *                          outside
 *   "isovalues"            the same as "iso"
 *   "output", "depth_f64", "rgba_f64", "error_f64", "value_f64", "write_tf"  files to write
 *
 * A key replaces the command line's value for that flag; flags without a key keep theirs.
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

/* The files of a picture: the picture, raw planes in the order of image_raw, the transfer
 * function. */
typedef enum frame_file {
    FRAME_PICTURE,
    FRAME_RAW,
    FRAME_TF = FRAME_RAW + IMAGE_RAWS,
    FRAME_FILES
} frame_file;

/* One picture to draw. */
typedef struct script_frame {
    view_options view;
    char file[FRAME_FILES][SCRIPT_PATH_MAX];    /* "": not written */
    double suggested[LEAFCAST_SUGGESTIONS_MAX]; /* set by render_job_check(); the first is drawn */
    int suggestions;                            /* 0: the flags gave isovalues */
} script_frame;

/* script_apply() - apply an object's keys to *frame; flags without a key keep their value. ST_USAGE
 * names `what` ("line 3") and the key. An object "page" belongs to the viewer and is skipped. */
CHECKED status script_apply(script_frame *frame, json_t *object, const char *what);

/* script_flag() - apply one key, which must be a flag of the view, and replaces what was said of
 * it. script_load() - read a file's JSON, which is the caller's to json_decref(). ST_CORRUPT names
 * the line. */
CHECKED status script_flag(view_options *view, const char *key, const json_t *value,
                           const char *what);
CHECKED status script_load(const char *file, json_t **out);

/* script_text() - convert a number, a string, or an array of them (joined by commas) to a flag's
 * text. ST_USAGE names `what` and `key`. */
CHECKED status script_text(const json_t *value, const char *what, const char *key,
                           char text[SCRIPT_TEXT_MAX]);

/* script_parse() - parse the text and call script_apply(). */
CHECKED status script_parse(script_frame *frame, const char *text, size_t size, const char *what);

/* script_load_path() - read a camera path: a file with an array of objects. *path is the caller's
 * to json_decref(). */
CHECKED status script_load_path(const char *file, json_t **path);

/* script_load_state() - apply an object in a file to *view: a view that the viewer has saved.
 * ST_CORRUPT: not JSON; ST_USAGE as from script_apply(), and for keys that name files to write. */
CHECKED status script_load_state(const char *file, view_options *view);

/* script_foresee() - apply what an object says of field, step and time to *view, and nothing else
 * of it. Returns false if it is refused when it is drawn, as far as that is known by then.
 * script_foresee_line() - the same of a line. */
bool script_foresee(view_options *view, json_t *object);
bool script_foresee_line(view_options *view, const char *text, size_t size);

/* ---- lines, one by one as they arrive ---- */

typedef struct script_reader script_reader;

/* script_open() - open a script; "-" is standard input. */
CHECKED status script_open(mem *m, const char *path, script_reader **out);
void script_close(script_reader *r); /* NULL is allowed */

/* script_line() - get the next line that is not blank, without its end; it is valid until the next
 * call. At the end of the script returns ST_OK with *line NULL. Waits for input; returns ST_STOPPED
 * as soon as stop() returns true (a signal wakes it). */
CHECKED status script_line(script_reader *r, bool (*stop)(void *), void *ctx, const char **line,
                           size_t *size, long *number);

/* script_peek() - look for lines that script_line() will return, without waiting for any. at: 0
 * for the first one, then as it was left. They are valid as long as the last one of script_line().
 * Returns false if there is no further one yet, or not all of it. */
bool script_peek(const script_reader *r, size_t *at, const char **line, size_t *size);

#endif
