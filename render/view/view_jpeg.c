#include "render/view/view_jpeg.h"

#include <turbojpeg.h>

enum { QUALITY = 85 };

struct view_jpeg {
    mem *m;
    tjhandle handle;
    byte_table table;
    unsigned char *pixels, *bytes;
    size_t pixels_room, bytes_room;
};

status view_jpeg_open(mem *m, view_jpeg **out) {
    view_jpeg *j = mem_zalloc(m, sizeof *j);
    if (!j)
        return ST_NOMEM;
    j->m = m;
    j->handle = tjInitCompress();
    if (!j->handle) {
        mem_free(m, j);
        return status_describe(ST_NOMEM, "no memory for a JPEG compressor");
    }
    picture_bytes_init(&j->table);
    *out = j;
    return ST_OK;
}

void view_jpeg_close(view_jpeg *j) {
    if (!j)
        return;
    tjDestroy(j->handle);
    mem_free(j->m, j->pixels);
    mem_free(j->m, j->bytes);
    mem_free(j->m, j);
}

static bool make_room(mem *m, unsigned char **block, size_t *room, size_t size) {
    if (*room >= size)
        return true;
    mem_free(m, *block);
    *block = mem_alloc(m, size);
    *room = *block ? size : 0;
    return *block != NULL;
}

status view_jpeg_write(view_jpeg *j, const picture *p, view_message **to) {
    const size_t count = (size_t)p->width * p->height;
    const unsigned long most = tjBufSize((int)p->width, (int)p->height, TJSAMP_420);
    unsigned long size = most;
    if (most == (unsigned long)-1)
        return status_describe(ST_UNSUPPORTED, "%u x %u is too large for JPEG", p->width,
                               p->height);
    if (!make_room(j->m, &j->pixels, &j->pixels_room, 3 * count) ||
        !make_room(j->m, &j->bytes, &j->bytes_room, most))
        return ST_NOMEM;
    picture_bytes_rgb(&j->table, p->image, 0, count, j->pixels);
    if (tjCompress2(j->handle, j->pixels, (int)p->width, 0, (int)p->height, TJPF_RGB, &j->bytes,
                    &size, TJSAMP_420, QUALITY, TJFLAG_NOREALLOC | TJFLAG_FASTDCT) != 0)
        return status_describe(ST_FAILED, "JPEG: %s", tjGetErrorStr2(j->handle));
    return view_message_put(to, j->bytes, size);
}
