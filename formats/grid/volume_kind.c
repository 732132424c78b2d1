#include "formats/grid/volume_kind.h"

#include <string.h>

#include "formats/grid/volume.h"

static status open_stream(mem *m, byte_stream *s, const input_hints *hints, void **own) {
    volume *v = NULL;
    const status st = volume_open_stream(m, s, hints ? &hints->grid : NULL, &v);
    *own = v;
    return st;
}

static status open_folder(mem *m, const char *path, const input_hints *hints, void **own) {
    volume *v = NULL;
    const status st = volume_open(m, path, hints ? &hints->grid : NULL, &v);
    *own = v;
    return st;
}

static void close_volume(void *own) {
    volume_close(own);
}

static const char *format(const void *own) {
    return volume_format(own);
}

static unsigned traits(const void *own) {
    const bool raw = strcmp(volume_format(own), VOLUME_RAW_SAMPLES) == 0;
    return INPUT_LATTICE | INPUT_SERIES | INPUT_FILES | INPUT_PARTS |
           (raw                      ? INPUT_RAW
            : volume_has_fields(own) ? INPUT_CHOICES | INPUT_STEPS
                                     : 0U);
}

const input_kind volume_kind = {.name = "grid",
                                .is_folder = volume_is_folder,
                                .open = open_stream,
                                .open_folder = open_folder,
                                .close = close_volume,
                                .format = format,
                                .traits = traits};
