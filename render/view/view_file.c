#include "render/view/view_file.h"

#include <pthread.h>
#include <stdatomic.h>

#include "formats/base/pool.h"
#include "formats/base/thread.h"
#include "render/app/image_helper.h"
#include "render/app/picture_png.h"

struct view_file {
    mem *m;
    view_file_kind kind;
    leafcast_image planes;
    picture shown;
    void (*done)(void *ctx);
    void *ctx;
    pthread_t thread;
    atomic_bool stopped, is_done;
    atomic_size_t bytes; /* of the file so far */
    /* Belongs to the thread until it is done: */
    view_message *made;
    status result;
    status_note note;
};

static bool is_stopped(void *ctx) {
    const view_file *f = ctx;
    return atomic_load(&f->stopped);
}

static status put(void *ctx, const void *data, size_t size) {
    view_file *f = ctx;
    if (is_stopped(f))
        return status_describe(ST_STOPPED, "stopped");
    const status st = view_message_put(&f->made, data, size);
    atomic_store(&f->bytes, f->made->room);
    return st;
}

static status write_png(view_file *f, const byte_sink *to) {
    pool *alone = NULL;
    status st = pool_create(f->m, 1, &alone);
    if (st == ST_OK)
        st = picture_png_write(f->m, alone, &f->shown, to);
    pool_destroy(alone);
    return st;
}

static status write_exr(view_file *f, const byte_sink *to) {
    image_helper *helper = NULL;
    status st = image_helper_start(f->m, is_stopped, f, &helper);
    if (st == ST_OK)
        st = image_helper_write(helper, "exr", "the picture", &f->shown, to);
    image_helper_end(helper);
    return st;
}

void view_file_free_planes(mem *m, leafcast_image *i) {
    void *const all[] = {i->r,           i->g,         i->b,         i->a,         i->z,  i->error,
                         i->provisional, i->normal[0], i->normal[1], i->normal[2], i->id, i->value};
    for (size_t k = 0; k < sizeof all / sizeof *all; k++)
        mem_free(m, all[k]);
    *i = (leafcast_image){0};
}

static void *write_file(void *arg) {
    view_file *f = arg;
    const byte_sink to = {put, f};
    f->made = view_message_new(f->m, 64 << 10);
    f->result = !f->made                   ? ST_NOMEM
                : f->kind == VIEW_FILE_EXR ? write_exr(f, &to)
                                           : write_png(f, &to);
    status_note_take(&f->note, f->result);
    view_file_free_planes(f->m, &f->planes);
    atomic_store(&f->is_done, true);
    f->done(f->ctx);
    return NULL;
}

status view_file_begin(mem *m, view_file_kind kind, const picture *shown, void (*done)(void *ctx),
                       void *ctx, view_file **out) {
    status st = kind == VIEW_FILE_EXR ? image_helper_check() : ST_OK;
    view_file *f = st == ST_OK ? mem_zalloc(m, sizeof *f) : NULL;
    leafcast_image planes = *shown->image;
    if (!f) {
        view_file_free_planes(m, &planes);
        return st == ST_OK ? ST_NOMEM : st;
    }
    f->m = m;
    f->kind = kind;
    f->planes = planes;
    f->shown = *shown;
    f->shown.image = &f->planes;
    f->done = done;
    f->ctx = ctx;
    st = thread_start(&f->thread, write_file, f, "the thread that writes a picture");
    if (st == ST_OK) {
        *out = f;
        return ST_OK;
    }
    view_file_free_planes(m, &f->planes);
    mem_free(m, f);
    return st;
}

bool view_file_is_done(const view_file *f) {
    return atomic_load(&f->is_done);
}

size_t view_file_bytes(const view_file *f) {
    return atomic_load(&f->bytes);
}

status view_file_take(view_file *f, view_message **out) {
    pthread_join(f->thread, NULL);
    const status st = status_note_raise(&f->note);
    if (st == ST_OK) {
        *out = f->made;
        f->made = NULL;
    }
    view_message_free(f->made);
    mem_free(f->m, f);
    return st;
}

void view_file_end(view_file *f) {
    view_message *made = NULL;
    if (!f)
        return;
    atomic_store(&f->stopped, true);
    if (view_file_take(f, &made) == ST_OK)
        view_message_free(made);
}
