#include "formats/grid/volume_layout.h"

#include <math.h>

#include "formats/base/num.h"
#include "formats/input/named_file.h"
#include "formats/input/unpack_stream.h"

void volume_layout_release(volume_layout *l) {
    byte_stream_close(l->data);
    mem_free(l->m, l->path);
    l->data = NULL;
    l->path = NULL;
    grid_release(&l->g, l->m);
}

status volume_layout_open(volume_layout *l, const char *header, const char *name, bool follow_links,
                          status (*open)(mem *m, const char *path, byte_stream **out)) {
    char *path = NULL;
    byte_stream *data = NULL;
    status st = named_file_find(l->m, header, name, follow_links, &path);
    if (st != ST_OK)
        return st;
    st = open(l->m, path, &data);
    mem_free(l->m, path);
    if (st != ST_OK)
        return st;
    byte_stream_close(l->data);
    l->data = data;
    return ST_OK;
}

const packer *volume_layout_packer(const volume_layout *l) {
    return l->encoding == VOLUME_DEFLATE ? &packer_zlib
           : l->encoding == VOLUME_BZIP2 ? &packer_bzip2
                                         : NULL;
}

static uint64_t times(uint64_t a, uint64_t b) {
    uint64_t product;
    return __builtin_mul_overflow(a, b, &product) ? UINT64_MAX : product;
}

uint64_t volume_layout_step_bytes(const volume_layout *l) {
    return times(grid_samples(&l->g), stored_samples_bytes(&l->stored));
}

/* Returns the bytes of all steps. */
static uint64_t all_bytes(const volume_layout *l) {
    return times(volume_layout_step_bytes(l), l->steps ? l->steps : 1);
}

status volume_layout_settle(volume_layout *l, const volume_hints *hints) {
    const uint32_t steps = l->steps ? l->steps : 1;
    const char *name = byte_stream_name(l->data);
    if (hints->step >= steps)
        return status_describe(ST_USAGE, "%s: no step %u: there %s %u, counted from 0", name,
                               hints->step, steps == 1 ? "is" : "are", steps);
    l->step = hints->step;
    l->all_steps = hints->all_steps && !l->ordered;
    return stored_samples_choose(&l->stored, name, hints, &l->g);
}

static status skip_lines(volume_layout *l, uint64_t lines) {
    text_line line = {.m = l->m};
    status st = ST_OK;
    for (bool got = true; st == ST_OK && lines > 0; lines--) {
        st = byte_stream_line(l->data, &line, &got);
        if (st == ST_OK && !got)
            st = status_describe(ST_CORRUPT, "%s: ends %llu lines before the samples",
                                 byte_stream_name(l->data), (unsigned long long)lines);
    }
    byte_stream_line_release(&line);
    return st;
}

/* Skip to where the samples start if they end `behind` bytes before the file does. */
static status skip_to_end(volume_layout *l, uint64_t behind) {
    const char *name = byte_stream_name(l->data);
    uint64_t left = byte_stream_left(l->data);
    if (l->encoding != VOLUME_RAW || left == UINT64_MAX)
        return status_describe(ST_UNSUPPORTED,
                               "%s: samples counted from the end need the raw encoding and a file",
                               name);
    if (behind > left || all_bytes(l) > left - behind)
        return status_describe(ST_CORRUPT, "%s: ends before the samples: %llu bytes, expected %llu",
                               name, (unsigned long long)left, (unsigned long long)all_bytes(l));
    return byte_stream_skip(l->data, left - behind - all_bytes(l));
}

status volume_layout_skip(volume_layout *l, uint64_t lines, int64_t bytes) {
    /* Check sizes first: products of unchecked sizes overflow. */
    status st = grid_check(&l->g, byte_stream_name(l->data));
    if (st == ST_OK)
        st = skip_lines(l, lines);
    if (st != ST_OK)
        return st;
    if (bytes < 0)
        return skip_to_end(l, (uint64_t)(-1 - bytes));
    if (!volume_layout_packer(l))
        return byte_stream_skip(l->data, (uint64_t)bytes);
    l->skip_decoded = (uint64_t)bytes;
    return ST_OK;
}

status volume_layout_check(const volume_layout *l) {
    const char *name = byte_stream_name(l->data);
    status st = grid_check(&l->g, name);
    if (st != ST_OK)
        return st;
    uint64_t left = byte_stream_left(l->data);
    uint64_t least = all_bytes(l);
    if (l->encoding == VOLUME_DEFLATE)
        least /= UNPACK_ZLIB_RATIO;
    else if (l->encoding == VOLUME_BZIP2)
        least /= UNPACK_BZIP2_RATIO;
    else if (l->encoding == VOLUME_TEXT)
        least = times(2, all_bytes(l) / sample_size(l->stored.type)) - 1;
    if (left < least)
        return status_describe(ST_CORRUPT,
                               "%s: ends at byte %llu, expected at least %llu bytes of samples "
                               "from byte %llu",
                               name, (unsigned long long)(byte_stream_position(l->data) + left),
                               (unsigned long long)least,
                               (unsigned long long)byte_stream_position(l->data));
    return ST_OK;
}

void volume_layout_place(volume_layout *l, double direction[3][3], const double spacing[3],
                         const double origin[3]) {
    for (int row = 0; row < 3; row++) {
        for (int a = 0; a < 3; a++)
            l->g.to_world[row][a] = direction[a][row] * spacing[a];
        l->g.to_world[row][3] = origin[row];
    }
}
