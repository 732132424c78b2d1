#include "render/app/render_script.h"

#include <errno.h>
#include <poll.h>
#include <string.h>
#include <unistd.h>

#include "formats/base/cli_options.h"
#include "formats/base/file.h"
#include "formats/base/json_text.h"
#include "formats/base/num.h"

enum { LINE_MAX_BYTES = 1 << 20, NEST_MAX = 4 };

/* ---- JSON to the text of a flag ---- */

static status wrong_kind(const char *what, const char *key, const char *wanted) {
    return status_describe(ST_USAGE, "%s: \"%s\" takes %s", what, key, wanted);
}

status script_text(const json_t *value, const char *what, const char *key,
                   char text[SCRIPT_TEXT_MAX]) {
    size_t count = json_is_array(value) ? json_array_size(value) : 1, n = 0;
    for (size_t i = 0; i < count; i++) {
        const json_t *item = json_is_array(value) ? json_array_get(value, i) : value;
        char number[NUM_TEXT_MAX];
        const char *part = json_is_string(item) ? json_string_value(item) : number;
        if (json_is_number(item))
            num_print(json_number_value(item), number);
        else if (!json_is_string(item))
            return wrong_kind(what, key, "numbers or text");
        const size_t length = strlen(part);
        if (n + length + 2 > SCRIPT_TEXT_MAX)
            return status_describe(ST_USAGE, "%s: \"%s\" is too long", what, key);
        if (i)
            text[n++] = ',';
        memcpy(text + n, part, length);
        n += length;
    }
    text[n] = 0;
    return ST_OK;
}

static status set_flag(view_options *view, int flag_key, const json_t *value, const char *what,
                       const char *key) {
    char text[SCRIPT_TEXT_MAX], why[STATUS_TEXT_MAX];
    status st = script_text(value, what, key, text);
    if (st)
        return st;
    st = view_options_set(view, flag_key, text);
    if (st == ST_OK)
        return ST_OK;
    snprintf(why, sizeof why, "%s", status_text());
    return status_describe(st, "%s: %s", what, why);
}

/* Returns whether an array holds several values of one flag: [1, 2, 3] is three isovalues but one
 * light. */
static bool is_list(const json_t *value, const char *name) {
    if (!json_is_array(value))
        return false;
    const json_t *first = json_array_get(value, 0);
    return json_is_array(first) || json_is_string(first) ||
           cli_options_listed("iso opacity reflect refract", name);
}

status script_flag(view_options *view, const char *name, const json_t *value, const char *what) {
    bool repeats = false;
    view_value takes = VIEW_VALUE_NEEDED;
    const int key = view_options_key(name, &repeats, &takes);
    if (!key)
        return status_describe(ST_USAGE, "%s: there is no \"%s\"", what, name);
    view_options_clear(view, key);
    if (takes == VIEW_VALUE_NONE && !json_is_boolean(value))
        return wrong_kind(what, name, "true or false");
    if (takes != VIEW_VALUE_NEEDED && json_is_boolean(value))
        return json_is_true(value) ? view_options_set(view, key, NULL) : ST_OK;
    if (!repeats || !is_list(value, name))
        return set_flag(view, key, value, what, name);
    status st = ST_OK;
    for (size_t i = 0; i < json_array_size(value) && st == ST_OK; i++)
        st = set_flag(view, key, json_array_get(value, i), what, name);
    return st;
}

static status apply_file(char *path, const json_t *value, const char *what, const char *key) {
    const char *text = json_string_value(value);
    if (!text || !*text || strlen(text) >= SCRIPT_PATH_MAX)
        return wrong_kind(what, key, "a file's name");
    memcpy(path, text, strlen(text) + 1);
    return ST_OK;
}

static const char *const FILE_KEYS[FRAME_FILES] = {[FRAME_PICTURE] = "output",
                                                   [FRAME_RAW + IMAGE_DEPTH] = "depth-f64",
                                                   [FRAME_RAW + IMAGE_RGBA] = "rgba-f64",
                                                   [FRAME_RAW + IMAGE_ERROR] = "error-f64",
                                                   [FRAME_RAW + IMAGE_VALUE] = "value-f64",
                                                   [FRAME_TF] = "write-tf"};

/* Returns which file a key names; FRAME_FILES: none. */
static int find_file(const char *key) {
    int which = 0;
    while (which < FRAME_FILES && !cli_options_same(key, FILE_KEYS[which]))
        which++;
    return which;
}

static status apply_object(script_frame *frame, json_t *object, const char *what, int depth) {
    if (!json_is_object(object) || depth == NEST_MAX)
        return status_describe(ST_USAGE, "%s: not a JSON object", what);
    const char *key;
    json_t *value;
    status st = ST_OK;
    void *at = json_object_iter(object);
    for (; at && st == ST_OK; at = json_object_iter_next(object, at)) {
        key = json_object_iter_key(at);
        value = json_object_iter_value(at);
        if (strcmp(key, "camera") == 0)
            st = apply_object(frame, value, what, depth + 1);
        else if (strcmp(key, "page") == 0)
            st = json_is_object(value) ? ST_OK : wrong_kind(what, key, "an object");
        else if (find_file(key) < FRAME_FILES)
            st = apply_file(frame->file[find_file(key)], value, what, key);
        else
            st =
                script_flag(&frame->view, strcmp(key, "isovalues") == 0 ? "iso" : key, value, what);
    }
    return st;
}

status script_apply(script_frame *frame, json_t *object, const char *what) {
    view_options_inherit(&frame->view);
    return apply_object(frame, object, what, 0);
}

status script_parse(script_frame *frame, const char *text, size_t size, const char *what) {
    json_error_t error;
    json_t *object = json_loadb(text, size, JSON_REJECT_DUPLICATES, &error);
    if (!object)
        return status_describe(json_text_status(&error, ST_USAGE), "%s: column %d: %s", what,
                               error.column, error.text);
    status st = script_apply(frame, object, what);
    json_decref(object);
    return st;
}

/* The keys that say which step is drawn, or which time. */
static bool is_moment(const char *key) {
    static const char *const KEYS[] = {"field", "step", "time", "interpolate"};
    bool is = false;
    for (size_t i = 0; i < sizeof KEYS / sizeof *KEYS; i++)
        is |= strcmp(key, KEYS[i]) == 0;
    return is;
}

bool script_foresee(view_options *view, json_t *object) {
    const char *key;
    json_t *value;
    bool fine = json_is_object(object);
    view_options_inherit(view);
    json_object_foreach(object, key, value) {
        if (is_moment(key))
            fine &= script_flag(view, key, value, "a line that comes") == ST_OK;
    }
    return fine;
}

bool script_foresee_line(view_options *view, const char *text, size_t size) {
    json_t *object = json_loadb(text, size, JSON_REJECT_DUPLICATES, NULL);
    const bool fine = script_foresee(view, object);
    json_decref(object);
    return fine;
}

status script_load(const char *path, json_t **out) {
    json_error_t error;
    mem m;
    file *f = NULL;
    mem_init(&m, 0);
    status st = file_open(&m, path, &f);
    if (st != ST_OK)
        return st;
    *out = json_loadfd(file_descriptor(f), JSON_REJECT_DUPLICATES, &error);
    file_close(f);
    if (!*out)
        return status_describe(json_text_status(&error, ST_CORRUPT), "%s: line %d: %s", path,
                               error.line, error.text);
    return ST_OK;
}

status script_load_path(const char *path, json_t **out) {
    json_t *array = NULL;
    const status st = script_load(path, &array);
    if (st != ST_OK)
        return st;
    if (!json_is_array(array) || json_array_size(array) == 0) {
        json_decref(array);
        return status_describe(ST_CORRUPT, "%s: not an array of views", path);
    }
    *out = array;
    return ST_OK;
}

status script_load_state(const char *path, view_options *view) {
    json_t *object = NULL;
    mem m;
    mem_init(&m, 0);
    status st = script_load(path, &object);
    script_frame *frame = st == ST_OK ? mem_zalloc(&m, sizeof *frame) : NULL;
    if (st == ST_OK && !frame)
        st = ST_NOMEM;
    if (st == ST_OK) {
        frame->view = *view;
        st = script_apply(frame, object, path);
        for (int i = 0; i < FRAME_FILES && st == ST_OK; i++)
            if (frame->file[i][0])
                st = status_describe(ST_USAGE, "%s: \"%s\" is no part of a view", path,
                                     FILE_KEYS[i]);
        time_options_inherit(&frame->view.time); /* flags may say another one */
        if (st == ST_OK)
            *view = frame->view;
    }
    mem_free(&m, frame);
    json_decref(object);
    return st;
}

/* ---- lines ---- */

struct script_reader {
    mem *m;
    const char *path;
    int fd;
    bool ended;
    long number;
    size_t from, to; /* bytes of the buffer that are read but not yet returned */
    char buffer[LINE_MAX_BYTES];
};

status script_open(mem *m, const char *path, script_reader **out) {
    const bool standard = strcmp(path, "-") == 0;
    int fd = STDIN_FILENO;
    status st = standard ? ST_OK : file_open_pipe(path, &fd);
    if (st != ST_OK)
        return st;
    script_reader *r = mem_alloc(m, sizeof *r);
    if (!r) {
        if (!standard)
            close(fd);
        return ST_NOMEM;
    }
    r->m = m;
    r->path = standard ? "standard input" : path;
    r->fd = fd;
    r->ended = false;
    r->number = 0;
    r->from = r->to = 0;
    *out = r;
    return ST_OK;
}

void script_close(script_reader *r) {
    if (!r)
        return;
    if (r->fd != STDIN_FILENO)
        close(r->fd);
    mem_free(r->m, r);
}

/* Move a partial line to the start of the buffer and read more bytes behind it. */
static status fill(script_reader *r, bool (*stop)(void *), void *ctx) {
    memmove(r->buffer, r->buffer + r->from, r->to - r->from);
    r->to -= r->from;
    r->from = 0;
    if (r->to == sizeof r->buffer)
        return status_describe(ST_USAGE, "%s: line %ld is longer than %d bytes", r->path,
                               r->number + 1, LINE_MAX_BYTES);
    for (;;) {
        if (stop && stop(ctx))
            return status_describe(ST_STOPPED, "stopped");
        /* poll() before read(): a signal ends poll(), but would restart read(). The time-out is for
         * a signal between stop() and poll(). */
        struct pollfd ready = {.fd = r->fd, .events = POLLIN};
        const int n = poll(&ready, 1, 200);
        if (n == 0 || (n < 0 && errno == EINTR))
            continue;
        const ssize_t got = read(r->fd, r->buffer + r->to, sizeof r->buffer - r->to);
        if (got < 0 && (errno == EINTR || errno == EAGAIN))
            continue;
        if (got < 0)
            return file_failed(errno, r->path, "cannot read");
        r->ended = got == 0;
        r->to += (size_t)got;
        return ST_OK;
    }
}

static bool blank(const char *text, size_t size) {
    for (size_t i = 0; i < size; i++)
        if (!strchr(" \t\r", text[i]))
            return false;
    return true;
}

status script_line(script_reader *r, bool (*stop)(void *), void *ctx, const char **line,
                   size_t *size, long *number) {
    for (;;) {
        const char *start = r->buffer + r->from;
        const char *end = memchr(start, '\n', r->to - r->from);
        if (!end && !r->ended) {
            status st = fill(r, stop, ctx);
            if (st)
                return st;
            continue;
        }
        const size_t n = end ? (size_t)(end - start) : r->to - r->from;
        if (!end && n == 0) {
            *line = NULL;
            return ST_OK;
        }
        r->from += n + (end != NULL);
        r->number++;
        if (blank(start, n))
            continue;
        *line = start;
        *size = n;
        *number = r->number;
        return ST_OK;
    }
}

bool script_peek(const script_reader *r, size_t *at, const char **line, size_t *size) {
    const size_t have = r->to - r->from;
    while (*at < have) {
        const char *start = r->buffer + r->from + *at;
        const char *end = memchr(start, '\n', have - *at);
        const bool whole = end || r->ended;
        if (!whole)
            return false;
        *line = start;
        *size = end ? (size_t)(end - start) : have - *at;
        *at += *size + (end != NULL);
        if (!blank(start, *size))
            return true;
    }
    return false;
}
