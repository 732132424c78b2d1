#include "formats/base/printed_file.h"

#include "formats/base/file.h"

typedef struct sink {
    out_file *f;
    status st; /* of the first fault; all later bytes are refused */
} sink;

static ssize_t take(void *cookie, const char *data, size_t size) {
    sink *s = cookie;
    if (s->st == ST_OK)
        s->st = out_file_append(s->f, data, size);
    return s->st == ST_OK ? (ssize_t)size : 0;
}

/* Avoid open_memstream(): when memory runs out, glibc's cuts the text and reports no error. */
static status print_to(sink *s, void (*print)(const void *ctx, FILE *out), const void *ctx) {
    FILE *stream = fopencookie(s, "w", (cookie_io_functions_t){.write = take});
    if (!stream)
        return status_describe(ST_NOMEM, "no memory for the table");
    print(ctx, stream);
    const bool bad = ferror(stream) != 0;
    if (fclose(stream) == 0 && !bad)
        return s->st;
    return s->st != ST_OK ? s->st : status_describe(ST_NOMEM, "no memory for the table");
}

status printed_file_write(mem *m, const char *path, bool force,
                          void (*print)(const void *ctx, FILE *out), const void *ctx) {
    sink s = {NULL, ST_OK};
    status st = out_file_create(m, path, force, &s.f);
    if (st != ST_OK)
        return st;
    st = print_to(&s, print, ctx);
    if (st == ST_OK)
        return out_file_commit(s.f);
    out_file_discard(s.f);
    return st;
}
