#include "prep/import/hdf5/hdf5_text.h"

#include <stdlib.h>
#include <string.h>

#include "formats/base/text.h"

/* ---- errors ---- */

typedef struct said {
    char *to;
    size_t room;
    bool memory;
} said;

/* Take the first error: it is the innermost one. */
static herr_t keep_first_error(unsigned n, const H5E_error2_t *error, void *ctx) {
    said *s = ctx;
    if (n == 0 && error->desc)
        text_name(s->to, s->room, error->desc);
    if (error->maj_num == H5E_RESOURCE)
        s->memory = true;
    return 0;
}

static bool words(char *to, size_t room) {
    said s = {to, room, false};
    text_name(to, room, "no reason given");
    H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_first_error, &s);
    H5Eclear2(H5E_DEFAULT);
    return s.memory;
}

void hdf5_words(char *to, size_t room) {
    words(to, room);
}

status hdf5_failed(const char *file, const char *what) {
    char text[400];
    const bool memory = words(text, sizeof text);
    return status_describe(memory ? ST_NOMEM : ST_CORRUPT, "%s: %s: libhdf5: %s", file, what, text);
}

/* ---- attributes ---- */

static hid_t open_attribute(hid_t object, const char *name) {
    return H5Aexists(object, name) > 0 ? H5Aopen(object, name, H5P_DEFAULT) : H5I_INVALID_HID;
}

static hssize_t points(hid_t attribute) {
    hid_t space = H5Aget_space(attribute);
    hssize_t n = space < 0 ? 0 : H5Sget_simple_extent_npoints(space);
    H5Sclose(space);
    return n;
}

int hdf5_numbers(hid_t object, const char *name, double *out, int most) {
    hid_t a = open_attribute(object, name);
    if (a < 0)
        return 0;
    hid_t type = H5Aget_type(a);
    const H5T_class_t kind = H5Tget_class(type);
    hssize_t n = points(a);
    if ((kind != H5T_INTEGER && kind != H5T_FLOAT) || n < 1 || n > most ||
        H5Aread(a, H5T_NATIVE_DOUBLE, out) < 0)
        n = 0;
    H5Tclose(type);
    H5Aclose(a);
    return (int)n;
}

bool hdf5_has_more(hid_t object, const char *name, int most) {
    hid_t a = open_attribute(object, name);
    const bool more = a >= 0 && points(a) > most;
    if (a >= 0)
        H5Aclose(a);
    return more;
}

/* Read the i-th of several texts of one length, whatever pads them. */
static bool fixed_string(hid_t a, hid_t type, size_t i, char *to, size_t room) {
    const size_t size = H5Tget_size(type), count = (size_t)points(a);
    char *all = size > 0 && size < 65536 && count < 64 ? malloc(size * count + 1) : NULL;
    const bool read = all && H5Aread(a, type, all) >= 0;
    if (read) {
        all[(i + 1) * size] = 0;
        text_name(to, room, all + i * size);
    }
    free(all);
    return read;
}

static bool variable_string(hid_t a, hid_t type, size_t i, char *to, size_t room) {
    char *all[64] = {NULL};
    hid_t space = H5Aget_space(a);
    hid_t memory = H5Tcopy(H5T_C_S1);
    H5Tset_size(memory, H5T_VARIABLE);
    H5Tset_cset(memory, H5Tget_cset(type));
    const bool read = points(a) <= 64 && H5Aread(a, memory, all) >= 0;
    const bool there = read && all[i];
    if (there)
        text_name(to, room, all[i]);
    if (read)
        H5Dvlen_reclaim(memory, space, H5P_DEFAULT, all);
    H5Tclose(memory);
    H5Sclose(space);
    return there;
}

bool hdf5_string(hid_t object, const char *name, size_t i, char *to, size_t room) {
    hid_t a = open_attribute(object, name);
    if (a < 0)
        return false;
    hid_t type = H5Aget_type(a);
    bool read = false;
    if (H5Tget_class(type) == H5T_STRING && points(a) > (hssize_t)i)
        read = H5Tis_variable_str(type) > 0 ? variable_string(a, type, i, to, room)
                                            : fixed_string(a, type, i, to, room);
    H5Tclose(type);
    H5Aclose(a);
    return read;
}
