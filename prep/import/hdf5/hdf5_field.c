#include "prep/import/hdf5/hdf5_field.h"

#include <jansson.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/text.h"
#include "prep/import/hdf5/hdf5_lzf.h"
#include "prep/import/hdf5/hdf5_minc.h"
#include "prep/import/hdf5/hdf5_roles.h"
#include "prep/import/hdf5/hdf5_storage.h"
#include "prep/import/hdf5/hdf5_text.h"

/* ---- the type of an element ---- */

typedef struct number {
    sample_type type;
    packed_wide wide;
} number;

/* Choose f32 or f64 by the bits of the float's parts. bfloat16 and half become f32, exactly. */
static bool float_number(hid_t type, number *n) {
    size_t sign, exponent, exponent_bits, mantissa, mantissa_bits;
    if (H5Tget_fields(type, &sign, &exponent, &exponent_bits, &mantissa, &mantissa_bits) < 0)
        return false;
    n->type = mantissa_bits <= 23 && exponent_bits <= 8 ? SAMPLE_F32 : SAMPLE_F64;
    return mantissa_bits <= 52 && exponent_bits <= 11;
}

static bool integer_number(hid_t type, number *n) {
    static const sample_type whole[2][3] = {{SAMPLE_U8, SAMPLE_U16, SAMPLE_U32},
                                            {SAMPLE_I8, SAMPLE_I16, SAMPLE_I32}};
    const size_t size = H5Tget_size(type);
    const bool is_signed = H5Tget_sign(type) == H5T_SGN_2;
    if (size > 4) {
        n->type = SAMPLE_F64;
        n->wide = is_signed ? PACKED_I64 : PACKED_U64;
        return size <= 8;
    }
    n->type = whole[is_signed][size <= 1 ? 0 : size <= 2 ? 1 : 2];
    return true;
}

static bool number_of(hid_t type, number *n) {
    *n = (number){.wide = PACKED_NARROW};
    switch (H5Tget_class(type)) {
    case H5T_FLOAT: return float_number(type, n);
    case H5T_INTEGER: return integer_number(type, n);
    case H5T_ENUM: {
        hid_t base = H5Tget_super(type);
        const bool known = integer_number(base, n);
        H5Tclose(base);
        return known;
    }
    default: return false;
    }
}

static hid_t native(number n) {
    if (n.wide)
        return n.wide == PACKED_I64 ? H5T_NATIVE_INT64 : H5T_NATIVE_UINT64;
    switch (n.type) {
    case SAMPLE_U8: return H5T_NATIVE_UINT8;
    case SAMPLE_I8: return H5T_NATIVE_INT8;
    case SAMPLE_U16: return H5T_NATIVE_UINT16;
    case SAMPLE_I16: return H5T_NATIVE_INT16;
    case SAMPLE_U32: return H5T_NATIVE_UINT32;
    case SAMPLE_I32: return H5T_NATIVE_INT32;
    case SAMPLE_F32: return H5T_NATIVE_FLOAT;
    case SAMPLE_F64: return H5T_NATIVE_DOUBLE;
    default: return H5I_INVALID_HID;
    }
}

/* Accept compounds whose numbers are all alike, such as {r, i} of complex numbers. */
static bool compound_type(hid_t type, number *n, hdf5_field *f) {
    const int count = H5Tget_nmembers(type);
    if (count < 1 || count > PACKED_COMPONENTS)
        return false;
    for (int i = 0; i < count; i++) {
        number one;
        hid_t member = H5Tget_member_type(type, (unsigned)i);
        const bool same =
            number_of(member, &one) && (i == 0 || (one.type == n->type && one.wide == n->wide));
        H5Tclose(member);
        if (!same)
            return false;
        *n = one;
    }
    const size_t size = sample_size(n->type);
    f->memory = H5Tcreate(H5T_COMPOUND, size * (size_t)count);
    for (int i = 0; i < count; i++) {
        char *name = H5Tget_member_name(type, (unsigned)i);
        H5Tinsert(f->memory, name ? name : "", size * (size_t)i, native(*n));
        H5free_memory(name);
    }
    f->packed.components = (uint32_t)count;
    return true;
}

static bool array_type(hid_t type, number *n, hdf5_field *f) {
    hsize_t dims[H5S_MAX_RANK], count = 1;
    hid_t base = H5Tget_super(type);
    const int rank = H5Tget_array_dims2(type, dims);
    for (int i = 0; i < rank && count <= PACKED_COMPONENTS; i++)
        count *= dims[i];
    const bool known = number_of(base, n) && count >= 1 && count <= PACKED_COMPONENTS;
    H5Tclose(base);
    if (!known)
        return false;
    f->memory = H5Tarray_create2(native(*n), (unsigned)rank, dims);
    f->packed.components = (uint32_t)count;
    return true;
}

static bool plain_type(hid_t type, number *n, hdf5_field *f) {
    if (!number_of(type, n))
        return false;
    f->memory = H5Tcopy(native(*n));
    return true;
}

static const char *class_name(hid_t type) {
    switch (H5Tget_class(type)) {
    case H5T_INTEGER: return "integers of more than 64 bits";
    case H5T_FLOAT: return "floats of more than 64 bits";
    case H5T_STRING: return "texts";
    case H5T_COMPOUND: return "records whose members differ";
    case H5T_ARRAY: return "long arrays, or arrays of what is no number";
    case H5T_TIME: return "times";
    case H5T_BITFIELD: return "bit fields";
    case H5T_OPAQUE: return "opaque bytes";
    case H5T_REFERENCE: return "references";
    case H5T_VLEN: return "lists";
    default: return "elements of an unknown kind";
    }
}

static void find_type(hid_t type, hdf5_field *f) {
    number n = {.wide = PACKED_NARROW};
    const H5T_class_t kind = H5Tget_class(type);
    packed_init(&f->packed, SAMPLE_F64, PACKED_NARROW);
    const bool known = kind == H5T_COMPOUND ? compound_type(type, &n, f)
                       : kind == H5T_ARRAY  ? array_type(type, &n, f)
                                            : plain_type(type, &n, f);
    if (!known) {
        snprintf(f->type, sizeof f->type, "%s", class_name(type));
        snprintf(f->refuse, sizeof f->refuse, "%s are not read", class_name(type));
        return;
    }
    const uint32_t components = f->packed.components;
    packed_init(&f->packed, n.type, n.wide);
    f->packed.components = components;
    const char *name = n.wide == PACKED_I64   ? "i64"
                       : n.wide == PACKED_U64 ? "u64"
                                              : sample_name(n.type);
    snprintf(f->type, sizeof f->type, "%s", name);
    if (components > 1)
        text_add(f->type, sizeof f->type, " x %u", components);
}

/* ---- the order of the axes ---- */

static const char letters[] = "xyztc";

/* Parse the attribute of vigra and ilastik: {"axes": [{"key": "z", ..}, ..]}. */
static bool tagged_axes(hid_t set, char *to, size_t room) {
    char text[4096];
    if (!hdf5_string(set, "axistags", 0, text, TEXT_NAME_MAX))
        return false;
    json_t *tags = json_loads(text, 0, NULL), *tag;
    size_t i;
    to[0] = 0;
    json_array_foreach(json_object_get(tags, "axes"), i, tag) {
        const char *key = json_string_value(json_object_get(tag, "key"));
        if (strlen(to) + 2 < room)
            text_add(to, room, "%c", key && strlen(key) == 1 ? key[0] : '?');
    }
    json_decref(tags);
    return to[0] != 0;
}

static bool labelled_axes(const hdf5_field *f, char *to, size_t room) {
    to[0] = 0;
    for (int i = 0; i < f->rank && strlen(to) + 2 < room; i++) {
        char label[8];
        if (!hdf5_string(f->set, "DIMENSION_LABELS", (size_t)i, label, sizeof label) ||
            strlen(label) != 1)
            return false;
        text_add(to, room, "%c", label[0]);
    }
    return to[0] != 0;
}

static const char *usual_axes(const hdf5_field *f, bool vtk) {
    const bool short_last = f->rank > 0 && f->dims[f->rank - 1] <= 4;
    switch (f->rank) {
    case 3: return "zyx";
    case 4: return short_last || vtk ? "zyxc" : "tzyx";
    case 5: return short_last || vtk ? "tzyxc" : "tczyx";
    default: return "";
    }
}

/* Set the axes. Each letter may come once; x, y and z must be there, x fastest. */
static bool set_axes(hdf5_field *f, const char *order) {
    for (int a = 0; a < HDF5_AXES; a++)
        f->at[a] = -1;
    if (strlen(order) != (size_t)f->rank)
        return false;
    for (int i = 0; i < f->rank; i++) {
        const char *letter = strchr(letters, order[i]);
        if (!letter || f->at[letter - letters] >= 0)
            return false;
        f->at[letter - letters] = i;
    }
    const int *at = f->at;
    return at[HDF5_Z] >= 0 && at[HDF5_Z] < at[HDF5_Y] && at[HDF5_Y] < at[HDF5_X];
}

static bool has_steps(hid_t file) {
    return H5Lexists(file, "/VTKHDF/Steps", H5P_DEFAULT) > 0;
}

/* Axes by the scales of the dimensions. NULL: the scales tell nothing, or refuse is set. */
static const char *timed_axes(hdf5_field *f) {
    const int time = hdf5_time_dimension(f->set);
    if (time < 0 || f->rank < 3)
        return NULL;
    f->map = f->rank == 3;
    if (f->map)
        snprintf(f->refuse, sizeof f->refuse,
                 "dimension %d counts times: a map that changes is no volume; --axes zyx takes its "
                 "times as slices along z",
                 time);
    else if (time > 0)
        snprintf(f->refuse, sizeof f->refuse,
                 "dimension %d counts times, which come first, but --axes says what it is", time);
    return time == 0 && f->rank == 4 ? "tzyx" : NULL;
}

static void find_axes(hid_t file, const char *axes, bool vtk, hdf5_field *f) {
    char own[16];
    if (vtk)
        axes = has_steps(file) && f->rank == 4 ? "tzyx" : usual_axes(f, true);
    else if (!axes && (tagged_axes(f->set, own, sizeof own) || labelled_axes(f, own, sizeof own)))
        axes = own;
    else if (!axes)
        axes = timed_axes(f);
    if (f->refuse[0])
        return;
    if (set_axes(f, axes ? axes : usual_axes(f, false)))
        return;
    if (axes && strlen(axes) == (size_t)f->rank)
        snprintf(
            f->refuse, sizeof f->refuse,
            "its axes are %s: expected x, y, z, perhaps t and c, each once, z before y before x",
            axes);
    else
        snprintf(f->refuse, sizeof f->refuse, "%d dimension%s%s%s", f->rank,
                 f->rank == 1 ? "" : "s", axes ? ", not as --axes has it: " : "",
                 axes          ? axes
                 : f->rank > 5 ? "; at most 5 are read"
                               : "");
}

/* ---- storage ---- */

static const char *filter_name(H5Z_filter_t id) {
    static const struct {
        H5Z_filter_t id;
        const char *name;
    } known[] = {{H5Z_FILTER_DEFLATE, "deflate"},
                 {H5Z_FILTER_SHUFFLE, "shuffle"},
                 {H5Z_FILTER_FLETCHER32, "fletcher32"},
                 {H5Z_FILTER_SZIP, "szip"},
                 {H5Z_FILTER_NBIT, "nbit"},
                 {H5Z_FILTER_SCALEOFFSET, "scaleoffset"},
                 {307, "bzip2"},
                 {HDF5_LZF, "lzf"},
                 {32001, "blosc"},
                 {32004, "lz4"},
                 {32008, "bitshuffle"},
                 {32013, "zfp"},
                 {32015, "zstd"},
                 {32017, "sz"},
                 {32026, "blosc2"}};
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++)
        if (known[i].id == id)
            return known[i].name;
    return "a filter";
}

/* Write to `to` why libhdf5 cannot undo a filter here. Returns false if it can. */
static bool filter_refuses(hid_t plist, unsigned at, H5Z_filter_t id, const hdf5_field *f, char *to,
                           size_t room) {
    if (H5Zfilter_avail(id) <= 0) {
        snprintf(to, room,
                 "compressed by %s (filter %d), of which libhdf5 finds no plugin here; "
                 "HDF5_PLUGIN_PATH says where they are",
                 filter_name(id), (int)id);
        return true;
    }
    const char *why = id == HDF5_LZF ? hdf5_lzf_check(plist, at, f->chunk_bytes) : NULL;
    snprintf(to, room, "%s", why ? why : "");
    return why != NULL;
}

static void find_filters(hid_t plist, hdf5_field *f) {
    enum { NAMED = 5 };
    char why[HDF5_TEXT];
    for (int i = 0; i < H5Pget_nfilters(plist); i++) {
        unsigned flags, setup;
        size_t none = 0;
        H5Z_filter_t id = H5Pget_filter2(plist, (unsigned)i, &flags, &none, NULL, 0, NULL, &setup);
        if (i < NAMED)
            text_add(f->type, sizeof f->type, "%s%s", i ? " " : ", ", filter_name(id));
        if (filter_refuses(plist, (unsigned)i, id, f, why, sizeof why) && !f->refuse[0])
            memcpy(f->refuse, why, sizeof f->refuse);
    }
}

static void find_storage(hid_t type, hdf5_field *f) {
    hid_t plist = H5Dget_create_plist(f->set);
    if (H5Pget_layout(plist) == H5D_CHUNKED && H5Pget_chunk(plist, f->rank, f->chunk) == f->rank) {
        f->chunk_bytes = H5Tget_size(type);
        text_add(f->type, sizeof f->type, ", chunks ");
        for (int i = 0; i < f->rank && i < HDF5_AXES; i++) {
            text_add(f->type, sizeof f->type, i ? "x%llu" : "%llu",
                     (unsigned long long)f->chunk[i]);
            f->chunk_bytes *= f->chunk[i];
        }
    }
    find_filters(plist, f);
    H5Pclose(plist);
}

/* Read how numbers are packed, by the attributes of netCDF and others. */
static void find_packing(hdf5_field *f) {
    static const char *const fills[] = {"_FillValue", "missing_value"};
    double v[4 * PACKED_FILLS];
    bool all = true;
    if (hdf5_numbers(f->set, "scale_factor", v, 1))
        f->packed.scale = v[0];
    if (hdf5_numbers(f->set, "add_offset", v, 1))
        f->packed.offset = v[0];
    for (int k = 0; k < 2; k++) {
        const int n = hdf5_numbers(f->set, fills[k], v, 4 * PACKED_FILLS);
        all = all && !hdf5_has_more(f->set, fills[k], 4 * PACKED_FILLS);
        for (int i = 0; i < n; i++)
            all = packed_fill(&f->packed, v[i]) && all;
    }
    if (!all && !f->refuse[0])
        snprintf(f->refuse, sizeof f->refuse, "more than %d values for missing data", PACKED_FILLS);
}

/* ---- all of it ---- */

static void find_shape(hid_t file, const char *path, const char *axes, hdf5_field *f) {
    hid_t space = H5Dget_space(f->set);
    f->rank = H5Sget_simple_extent_ndims(space);
    if (f->rank < 0 || H5Sget_simple_extent_dims(space, f->dims, NULL) < 0)
        f->rank = 0;
    H5Sclose(space);
    char why[HDF5_TEXT] = "";
    const bool vtk = hdf5_vtk_array(file, path, why, sizeof why);
    find_axes(file, axes, vtk, f);
    if (why[0])
        memcpy(f->refuse, why, sizeof f->refuse);
}

/* Do not even ask for the size of a data set that may not be read: that would open its sources. */
static void find_missing(const char *name, const char *path, hdf5_field *f) {
    status st = hdf5_storage_check(f->set, name, path, &f->absent);
    if (st == ST_OK)
        return;
    f->denied = true;
    snprintf(f->refuse, sizeof f->refuse, "%s", status_text());
}

bool hdf5_field_open(hid_t file, const char *name, const char *path, const char *axes,
                     hdf5_field *f) {
    memset(f, 0, sizeof *f);
    f->memory = H5I_INVALID_HID;
    hid_t uncached = hdf5_storage_access();
    /* Slabs are read in whole chunks, so each chunk is decompressed once, and none is cached. */
    H5Pset_chunk_cache(uncached, 1, 0, H5D_CHUNK_CACHE_W0_DEFAULT);
    f->set = H5Dopen2(file, path, uncached);
    H5Pclose(uncached);
    if (f->set < 0)
        return false;
    hid_t type = H5Dget_type(f->set);
    find_type(type, f);
    if (!f->refuse[0])
        find_missing(name, path, f);
    if (!f->refuse[0])
        find_shape(file, path, axes, f);
    find_storage(type, f);
    hdf5_minc_find(path, f);
    if (!f->refuse[0] && !f->minc)
        find_packing(f);
    f->scale = hdf5_is_scale(f->set);
    H5Tclose(type);
    return true;
}

void hdf5_field_release(hdf5_field *f) {
    if (f->memory >= 0)
        H5Tclose(f->memory);
    if (f->set >= 0)
        H5Dclose(f->set);
    f->memory = f->set = H5I_INVALID_HID;
}

hsize_t hdf5_field_count(const hdf5_field *f, int axis) {
    return f->at[axis] < 0 ? 1 : f->dims[f->at[axis]];
}
