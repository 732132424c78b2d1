#include "render/view/view_planes.h"

#include <math.h>
#include <string.h>

#include "render/view/view_file.h"

void view_planes_release(mem *m, view_planes *p) {
    view_file_free_planes(m, &p->image);
    *p = (view_planes){0};
}

uint64_t view_planes_bytes(const view_planes *p) {
    const leafcast_image *i = &p->image;
    const uint64_t one = 3 * sizeof(float) + 1 + (i->a ? sizeof(float) : 0) +
                         (i->error ? sizeof(double) : 0) + (i->z ? sizeof(double) : 0) +
                         (i->id ? 3 * sizeof(float) + sizeof(int32_t) : 0) +
                         (i->value ? sizeof(double) : 0);
    return i->r ? one * p->width * p->height : 0;
}

/* Make a plane, if it is wanted. Zero it if parts of it will be shown. Otherwise a picture writes
 * all of it, and touching it here would take long. */
static void *make_plane(mem *m, const void *wanted, size_t count, size_t size, bool zeroed) {
    if (!wanted)
        return NULL;
    return zeroed ? mem_array(m, count, size) : mem_alloc(m, count * size);
}

status view_planes_make(mem *m, const leafcast_image *w, uint32_t width, uint32_t height,
                        view_planes *out) {
    const size_t count = (size_t)width * height;
    const bool zeroed = w->provisional;
    leafcast_image *i = &out->image;
    *out = (view_planes){.width = width, .height = height, .image = {.size = sizeof *i}};
    i->r = make_plane(m, w->r, count, sizeof *i->r, zeroed);
    i->g = make_plane(m, w->g, count, sizeof *i->g, zeroed);
    i->b = make_plane(m, w->b, count, sizeof *i->b, zeroed);
    i->a = make_plane(m, w->a, count, sizeof *i->a, zeroed);
    i->z = make_plane(m, w->z, count, sizeof *i->z, zeroed);
    i->error = make_plane(m, w->error, count, sizeof *i->error, zeroed);
    i->value = make_plane(m, w->value, count, sizeof *i->value, zeroed);
    i->id = make_plane(m, w->id, count, sizeof *i->id, zeroed);
    i->provisional = make_plane(m, w->provisional, count, sizeof *i->provisional, zeroed);
    bool failed = !i->r || !i->g || !i->b || !i->a != !w->a || !i->z != !w->z ||
                  !i->error != !w->error || !i->value != !w->value || !i->id != !w->id ||
                  !i->provisional != !w->provisional;
    for (int k = 0; k < 3; k++) {
        i->normal[k] = make_plane(m, w->normal[k], count, sizeof(float), zeroed);
        failed |= !i->normal[k] != !w->normal[k];
    }
    if (failed) {
        view_planes_release(m, out);
        return ST_NOMEM;
    }
    if (i->provisional)
        memset(i->provisional, 1, count);
    return ST_OK;
}

void view_planes_enlarge(const view_planes *from, view_planes *to) {
    float *const a[4] = {from->image.r, from->image.g, from->image.b, from->image.a};
    float *const b[4] = {to->image.r, to->image.g, to->image.b, to->image.a};
    for (uint32_t y = 0; y < to->height; y++) {
        const size_t above = (size_t)((uint64_t)y * from->height / to->height) * from->width;
        for (uint32_t x = 0; x < to->width; x++) {
            const size_t in = above + (size_t)((uint64_t)x * from->width / to->width);
            for (int c = 0; c < 4; c++)
                if (a[c] && b[c])
                    b[c][(size_t)y * to->width + x] = a[c][in];
        }
    }
}

void view_planes_blank(const view_planes *of) {
    const size_t count = (size_t)of->width * of->height;
    for (size_t i = 0; i < count; i++)
        of->image.r[i] = NAN;
}

double view_planes_share(const view_planes *of) {
    const size_t count = (size_t)of->width * of->height;
    size_t drawn = 0;
    for (size_t i = 0; i < count; i++)
        drawn += !isnan(of->image.r[i]);
    return (double)drawn / (double)count;
}

uint64_t view_planes_provisional(const view_planes *of) {
    const size_t count = (size_t)of->width * of->height;
    uint64_t n = 0;
    for (size_t i = 0; i < count; i++)
        n += of->image.provisional[i] != 0;
    return n;
}
