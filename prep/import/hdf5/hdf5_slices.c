#include "prep/import/hdf5/hdf5_slices.h"

#include <limits.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/file.h"
#include "formats/base/text.h"
#include "formats/grid/sample_place.h"
#include "prep/import/hdf5/hdf5_chunks.h"
#include "prep/import/hdf5/hdf5_field.h"
#include "prep/import/hdf5/hdf5_lzf.h"
#include "prep/import/hdf5/hdf5_minc.h"
#include "prep/import/hdf5/hdf5_roles.h"
#include "prep/import/hdf5/hdf5_storage.h"
#include "prep/import/hdf5/hdf5_text.h"
#include "prep/import/import_hint.h"
#include "prep/import/packed_slices.h"

typedef struct hdf5_slices {
    mem *m;
    file *guard; /* the same file, opened so that the guard knows it as an input */
    hid_t file;
    hdf5_field field;
    char path[HDF5_PATH]; /* of the data set */
    uint32_t step, channel;
    packed_slices slices;
    bool tell_chunks; /* where they are */
    chunk_array chunks;
    chunk_entry *table;
} hdf5_slices;

/* ---- the file ---- */

static status open_library(const char *path, hid_t *out) {
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    if (!hdf5_lzf_register())
        return hdf5_failed(path, "a filter for LZF");
    hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    H5Pset_file_locking(access, false, true);
    const htri_t known = H5Fis_hdf5(path);
    *out = known > 0 ? H5Fopen(path, H5F_ACC_RDONLY, access) : H5I_INVALID_HID;
    H5Pclose(access);
    if (known == 0)
        return status_describe(
            ST_CORRUPT, "%s: no HDF5 file: expected its signature at byte 0, 512, 1024, ..", path);
    return *out < 0 ? hdf5_failed(path, "opening") : ST_OK;
}

static status open_file(hdf5_slices *s, const char *path) {
    status st = file_open(s->m, path, &s->guard);
    return st == ST_OK ? open_library(path, &s->file) : st;
}

static void close_slices(void *ctx) {
    hdf5_slices *s = ctx;
    hdf5_field_release(&s->field);
    if (s->file > 0)
        H5Fclose(s->file);
    file_close(s->guard);
    packed_slices_end(&s->slices);
    mem_free(s->m, s->table);
    mem_free(s->m, s);
}

static status create(mem *m, const import_request *q, hdf5_slices **out) {
    hdf5_slices *s = mem_zalloc(m, sizeof *s);
    if (!s)
        return ST_NOMEM;
    s->m = m;
    s->tell_chunks = q->chunks;
    s->file = s->field.set = s->field.memory = H5I_INVALID_HID;
    status st = hdf5_storage_begin(m, &q->trust);
    if (st == ST_OK)
        st = open_file(s, q->paths[0]);
    if (st != ST_OK) {
        close_slices(s);
        return st;
    }
    *out = s;
    return ST_OK;
}

/* ---- walking through the data sets ---- */

/* How well a data set suits; the most important field first. */
typedef struct merit {
    bool suits, has_asked; /* has_asked: it has the step and component asked for */
    bool of_points;
    uint64_t samples;
    int plain; /* breaks ties: sets without steps or components win, unless these are asked for */
} merit;

typedef struct walk {
    hid_t file;
    const char *axes;
    const import_request *q;
    const hdf5_roles *roles;
    const import_list *to;  /* NULL: search, do not list */
    merit best;             /* of the best set so far */
    char map[HDF5_PATH];    /* the first map that changes in time; "": there is none */
    char path[HDF5_PATH];   /* of the best set; when listing: of the set that would be taken, or
                               "" */
    char denied[HDF5_TEXT]; /* why the first denied set is denied */
    status st;
} walk;

/* The shape for --list. For a set that cannot be read: its dimensions, the fastest first. */
static void list_shape(const hdf5_field *f, uint64_t shape[4]) {
    static const int order[4] = {HDF5_X, HDF5_Y, HDF5_Z, HDF5_T};
    for (int i = 0; i < 4; i++)
        if (f->refuse[0])
            shape[i] = i < f->rank ? f->dims[f->rank - 1 - i] : 0;
        else
            shape[i] = i == 3 && f->at[HDF5_T] < 0 ? 0 : hdf5_field_count(f, order[i]);
}

static hsize_t components_of(const hdf5_field *f) {
    return f->at[HDF5_C] >= 0 ? hdf5_field_count(f, HDF5_C) : f->packed.components;
}

static void take_listed(walk *w, const char *path, hdf5_field *f) {
    import_item item = {.name = path, .type = f->type};
    if (!f->refuse[0] && f->at[HDF5_C] >= 0)
        text_add(f->type, sizeof f->type, ", %llu components",
                 (unsigned long long)hdf5_field_count(f, HDF5_C));
    list_shape(f, item.shape);
    item.refuse = f->refuse[0] ? f->refuse : NULL;
    item.taken = strcmp(path, w->path) == 0;
    if (!f->refuse[0]) {
        packed_samples p = f->packed;
        p.components = (uint32_t)components_of(f);
        item.components = p.components;
        item.component = w->q->component;
        item.colours = packed_is_colour(&p);
    }
    w->st = w->to->take(w->to->ctx, &item);
}

static merit merit_of(const walk *w, const char *path, const hdf5_field *f) {
    const import_request *q = w->q;
    const hsize_t steps = hdf5_field_count(f, HDF5_T);
    const hsize_t components = components_of(f);
    merit x = {.samples = 1};
    if (f->refuse[0] || f->scale || hdf5_roles_describes(w->roles, path))
        return x;
    for (int a = HDF5_X; a <= HDF5_Z; a++) {
        if (hdf5_field_count(f, a) < 2)
            return x;
        x.samples *= hdf5_field_count(f, a);
    }
    x.suits = true;
    x.has_asked = steps > q->step && components >= q->component;
    x.of_points = strncmp(path, "/VTKHDF/C", 9) != 0;
    x.plain = 2 * ((steps > 1) == (q->step > 0)) + ((components > 1) == (q->component > 0));
    return x;
}

static bool is_better(const merit *a, const merit *b) {
    if (a->suits != b->suits)
        return a->suits;
    if (a->has_asked != b->has_asked)
        return a->has_asked;
    if (a->of_points != b->of_points)
        return a->of_points;
    return a->samples != b->samples ? a->samples > b->samples : a->plain > b->plain;
}

static void take_suiting(walk *w, const char *path, const hdf5_field *f) {
    const merit x = merit_of(w, path, f);
    if (f->map && !w->map[0])
        snprintf(w->map, sizeof w->map, "%s", path);
    if (!is_better(&x, &w->best) || strlen(path) >= sizeof w->path)
        return;
    w->best = x;
    snprintf(w->path, sizeof w->path, "%s", path);
}

static status visit(void *ctx, const char *path) {
    walk *w = ctx;
    hdf5_field f;
    if (!hdf5_field_open(w->file, w->q->paths[0], path, w->axes, &f)) {
        hdf5_words(f.refuse, sizeof f.refuse);
        snprintf(f.type, sizeof f.type, "unknown");
    }
    if (f.denied && !w->denied[0])
        memcpy(w->denied, f.refuse, sizeof w->denied);
    if (w->to)
        take_listed(w, path, &f);
    else
        take_suiting(w, path, &f);
    hdf5_field_release(&f);
    return w->st;
}

static status walk_all(walk *w, const char *path) {
    return hdf5_walk(w->file, path, visit, w);
}

/* ---- choosing ---- */

static status nothing_found(const walk *w, const char *path) {
    char hint[IMPORT_HINT_MAX];
    if (w->denied[0])
        return status_describe(ST_UNSUPPORTED, "%s", w->denied);
    if (w->map[0])
        return status_describe(ST_UNSUPPORTED,
                               "%s: no data set of numbers along x, y and z: %s is a map that "
                               "changes in time; import-hdf5 --axes zyx takes its times as slices "
                               "along z",
                               path, w->map);
    return status_describe(ST_UNSUPPORTED,
                           "%s: no data set of numbers along x, y and z; `%s' tells what there is",
                           path, import_hint_list(w->q, hint));
}

static status search(hdf5_slices *s, const import_request *q, const char *axes) {
    hdf5_roles roles;
    walk w = {.file = s->file, .axes = axes, .q = q, .roles = &roles};
    status st = hdf5_roles_find(s->m, s->file, q->paths[0], &roles);
    if (st == ST_OK)
        st = walk_all(&w, q->paths[0]);
    hdf5_roles_release(&roles);
    if (st == ST_OK && !w.best.suits)
        st = nothing_found(&w, q->paths[0]);
    memcpy(s->path, w.path, sizeof s->path);
    return st;
}

/* Open the data set of this name, or the VTKHDF array of this name. */
static status find(hdf5_slices *s, const import_request *q, const char *axes) {
    static const char *const inside[] = {"/", "", "/VTKHDF/PointData/", "/VTKHDF/CellData/"};
    for (int i = q->field[0] == '/'; i < 4; i++) {
        if (strlen(q->field) + 32 > sizeof s->path)
            break;
        snprintf(s->path, sizeof s->path, "%s%s", inside[i], q->field);
        if (hdf5_field_open(s->file, q->paths[0], s->path, axes, &s->field))
            return ST_OK;
        status st = hdf5_storage_denied();
        if (st != ST_OK)
            return st;
    }
    H5Eclear2(H5E_DEFAULT);
    char hint[IMPORT_HINT_MAX];
    return status_describe(ST_USAGE, "%s: no data set \"%s\"; `%s' tells what there is",
                           q->paths[0], q->field, import_hint_list(q, hint));
}

static status choose(hdf5_slices *s, const import_request *q, const char *axes) {
    status st = q->field ? find(s, q, axes) : search(s, q, axes);
    if (st == ST_OK && !q->field &&
        !hdf5_field_open(s->file, q->paths[0], s->path, axes, &s->field))
        st = hdf5_failed(q->paths[0], s->path);
    if (st == ST_OK && s->field.denied)
        return status_describe(ST_UNSUPPORTED, "%s", s->field.refuse);
    if (st == ST_OK && s->field.refuse[0])
        st = status_describe(ST_UNSUPPORTED, "%s: data set %s cannot be read: %s", q->paths[0],
                             s->path, s->field.refuse);
    return st;
}

/* ---- the list ---- */

/* Search first: at most one of the sets listed would be taken. */
static status list_all(hdf5_slices *s, const import_request *q, const char *axes,
                       const import_list *to) {
    walk w = {.file = s->file, .axes = axes, .q = q, .to = to};
    if ((q->field ? find(s, q, axes) : search(s, q, axes)) == ST_OK)
        memcpy(w.path, s->path, sizeof w.path);
    return walk_all(&w, q->paths[0]);
}

status hdf5_slices_list(mem *m, const import_request *q, const char *axes, const import_list *to) {
    hdf5_slices *s = NULL;
    status st = create(m, q, &s);
    if (st != ST_OK)
        return st;
    st = list_all(s, q, axes, to);
    close_slices(s);
    return st;
}

/* ---- steps and components ---- */

static status choose_step(hdf5_slices *s, const import_request *q) {
    const hsize_t steps = hdf5_field_count(&s->field, HDF5_T);
    s->step = q->step;
    if (q->step < steps)
        return ST_OK;
    return status_describe(ST_USAGE, "%s: %s: --step %u: it has %llu, counted from 0", q->paths[0],
                           s->path, q->step, (unsigned long long)steps);
}

/* Components are an axis, or inside of the elements. Of an axis behind x, all are read for their
 * magnitude. An axis in front of the others holds channels, and the first is taken. */
static status choose_component(hdf5_slices *s, const import_request *q) {
    hdf5_field *f = &s->field;
    const bool axis = f->at[HDF5_C] >= 0, last = f->at[HDF5_C] == f->rank - 1;
    const hsize_t count = axis ? hdf5_field_count(f, HDF5_C) : f->packed.components;
    if (axis && f->packed.components > 1)
        return status_describe(ST_UNSUPPORTED,
                               "%s: %s has components along an axis and inside of its elements",
                               q->paths[0], s->path);
    if (q->component > count)
        return status_describe(ST_USAGE, "%s: %s: --component %u: it has %llu", q->paths[0],
                               s->path, q->component, (unsigned long long)count);
    if (!axis) {
        f->packed.component = count > 1 ? q->component : 0;
    } else if (q->component || !last) {
        s->channel = q->component ? q->component - 1 : 0;
    } else if (count > PACKED_COMPONENTS) {
        return status_describe(ST_USAGE, "%s: %s has %llu components: give --component",
                               q->paths[0], s->path, (unsigned long long)count);
    } else {
        f->packed.components = (uint32_t)count;
    }
    return ST_OK;
}

/* ---- slabs ---- */

/* The slab's part of the data set: start and size in each dimension.
 */
static void cut_slab(const hdf5_slices *s, uint32_t first, uint32_t count, hsize_t *start,
                     hsize_t *size) {
    const int *at = s->field.at;
    for (int i = 0; i < s->field.rank; i++) {
        start[i] = 0;
        size[i] = s->field.dims[i];
    }
    start[at[HDF5_Z]] = first;
    size[at[HDF5_Z]] = count;
    if (at[HDF5_T] >= 0) {
        start[at[HDF5_T]] = s->step;
        size[at[HDF5_T]] = 1;
    }
    if (at[HDF5_C] >= 0 && s->field.packed.components == 1) {
        start[at[HDF5_C]] = s->channel;
        size[at[HDF5_C]] = 1;
    }
}

/* Memory has the same shape as the file's part. With another, the library would go through the
 * elements one by one. */
static bool read_slab(const hdf5_slices *s, const hsize_t *start, const hsize_t *size,
                      void *stored) {
    hid_t file_space = H5Dget_space(s->field.set);
    hid_t memory = H5Screate_simple(s->field.rank, size, NULL);
    const bool read =
        H5Sselect_hyperslab(file_space, H5S_SELECT_SET, start, NULL, size, NULL) >= 0 &&
        H5Dread(s->field.set, s->field.memory, memory, file_space, H5P_DEFAULT, stored) >= 0;
    /* Keep the error stack: each call clears what the one before put there. */
    hid_t said = H5Eget_current_stack();
    H5Sclose(memory);
    H5Sclose(file_space);
    H5Eset_current_stack(said);
    return read;
}

static status load_slab(void *ctx, uint32_t first, uint32_t count, void *stored) {
    hdf5_slices *s = ctx;
    hsize_t start[H5S_MAX_RANK], size[H5S_MAX_RANK];
    cut_slab(s, first, count, start, size);
    if (read_slab(s, start, size, stored))
        return ST_OK;
    char what[HDF5_PATH + 64];
    snprintf(what, sizeof what, "%s, slices %u to %u (counted from 0)", s->path, first,
             first + count - 1);
    return hdf5_failed(file_path(s->guard), what);
}

static status read_slices(void *ctx, uint32_t first, uint32_t count, void *slices) {
    hdf5_slices *s = ctx;
    return packed_slices_read(&s->slices, first, count, slices);
}

/* ---- in place ---- */

/* The types of HDF5 whose bytes are numbers of a sample type, in either order. */
static bool is_plain(hid_t type, sample_type of, bool *big) {
    const struct {
        sample_type type;
        hid_t little, big;
    } plain[] = {
        {SAMPLE_U8, H5T_STD_U8LE, H5T_STD_U8BE},      {SAMPLE_I8, H5T_STD_I8LE, H5T_STD_I8BE},
        {SAMPLE_U16, H5T_STD_U16LE, H5T_STD_U16BE},   {SAMPLE_I16, H5T_STD_I16LE, H5T_STD_I16BE},
        {SAMPLE_U32, H5T_STD_U32LE, H5T_STD_U32BE},   {SAMPLE_I32, H5T_STD_I32LE, H5T_STD_I32BE},
        {SAMPLE_F32, H5T_IEEE_F32LE, H5T_IEEE_F32BE}, {SAMPLE_F64, H5T_IEEE_F64LE, H5T_IEEE_F64BE}};
    for (size_t i = 0; i < sizeof plain / sizeof *plain; i++) {
        if (plain[i].type != of)
            continue;
        *big = H5Tequal(type, plain[i].big) > 0;
        return *big || H5Tequal(type, plain[i].little) > 0;
    }
    return false;
}

/* Whether the data set is one piece of the file, x fastest, then y, z and steps. */
static bool lies_in_order(const hdf5_field *f) {
    const int steps = f->at[HDF5_T] >= 0;
    hid_t plist = H5Dget_create_plist(f->set);
    const bool whole = H5Pget_layout(plist) == H5D_CONTIGUOUS && H5Pget_external_count(plist) == 0;
    H5Pclose(plist);
    return whole && f->rank == 3 + steps && f->at[HDF5_X] == f->rank - 1 &&
           f->at[HDF5_Y] == f->rank - 2 && f->at[HDF5_Z] == f->rank - 3;
}

/* Whether a stored number becomes a sample, or part of one, as it is. *big: its byte order. */
static bool are_plain(const hdf5_slices *s, bool *big) {
    const packed_samples *p = &s->field.packed;
    hid_t type = H5Dget_type(s->field.set);
    const bool plain = p->wide == PACKED_NARROW && !p->fills && !p->has_range && p->scale == 1.0 &&
                       p->offset == 0.0 && !s->slices.scales && is_plain(type, p->type, big);
    H5Tclose(type);
    return plain;
}

/* Whether the data set is of the file that was opened: links lead to others. */
static bool is_own(const hdf5_slices *s) {
    char of_set[PATH_MAX] = "", of_file[PATH_MAX] = "";
    return H5Fget_name(s->field.set, of_set, sizeof of_set) > 0 &&
           H5Fget_name(s->file, of_file, sizeof of_file) > 0 && strcmp(of_set, of_file) == 0;
}

/* The chunks that the grid meets. */
static void find_range(const hdf5_slices *s, const sample_place *at, chunk_range *out) {
    const stored_samples *n = &at->stored;
    const uint32_t number = n->component ? n->component - 1 : 0;
    uint32_t first[ORDER_AXES] = {0}, end[ORDER_AXES];
    chunk_shape shape;
    for (int a = 0; a < 3; a++)
        end[a] = (uint32_t)hdf5_field_count(&s->field, HDF5_X + a);
    first[ORDER_COMPONENT] = number;
    end[ORDER_COMPONENT] = n->component || !n->components ? number + 1 : n->components;
    first[ORDER_STEP] = s->step;
    end[ORDER_STEP] = s->step + 1;
    (void)chunk_array_measure(&s->chunks, &shape);
    (void)chunk_array_range(&shape, first, end, out);
}

/* Chunks of numbers. */
static void find_chunks(hdf5_slices *s, bool big, sample_place *out) {
    const hdf5_field *f = &s->field;
    const bool axis = f->at[HDF5_C] >= 0, all = axis && f->packed.components > 1;
    packed_samples joined = f->packed;
    chunk_range range;
    *out = (sample_place){.big_endian = big,
                          .stored = {.type = f->packed.type, .components = 1},
                          .chunks = &s->chunks,
                          .step = s->step};
    if (axis)
        out->stored.components = (uint32_t)hdf5_field_count(f, HDF5_C);
    out->stored.component = axis && !all ? s->channel + 1 : 0;
    out->stored.colours = all && packed_is_colour(&joined);
    out->refused = !is_own(s) ? "it is a data set of another file"
                   : !axis && joined.components > 1
                       ? "elements of several numbers"
                       : hdf5_chunks_describe(f, f->packed.type, big, &s->chunks);
    if (out->refused || !s->tell_chunks)
        return;
    find_range(s, out, &range);
    if (hdf5_chunks_find(s->m, f, file_path(s->guard), &s->chunks, &range, &s->table) != ST_OK)
        out->refused = "the library does not tell where they are";
    out->table = s->table;
    out->table_count = 1;
    for (int r = 0; r < ORDER_AXES; r++)
        out->table_count *= range.count[r];
}

/* Numbers that become samples as they are, in one piece of the file, or in chunks. */
static bool find_place(void *ctx, sample_place *out) {
    hdf5_slices *s = ctx;
    const hdf5_field *f = &s->field;
    const packed_samples *p = &f->packed;
    bool big = false;
    if (!are_plain(s, &big)) {
        out->refused = "numbers whose type, scale or fill value HDF5 undoes";
        return f->chunk[0] > 0;
    }
    if (f->chunk[0]) {
        find_chunks(s, big, out);
        return true;
    }
    const haddr_t at = H5Dget_offset(f->set);
    if (p->components > 1 || packed_type(p) != p->type || at == HADDR_UNDEF || !lies_in_order(f))
        return false;
    uint64_t step = sample_size(p->type);
    for (int a = 0; a < 3; a++)
        step *= hdf5_field_count(f, HDF5_X + a);
    *out = (sample_place){
        .offset = at + s->step * step, .big_endian = big, .stored = {.type = p->type}};
    return true;
}

/* ---- opening ---- */

static status make_grid(hdf5_slices *s, grid *g) {
    const char *path = file_path(s->guard);
    uint32_t dims[3];
    for (int a = 0; a < 3; a++) {
        const hsize_t n = hdf5_field_count(&s->field, HDF5_X + a);
        dims[a] = n < UINT32_MAX ? (uint32_t)n : UINT32_MAX;
    }
    grid_init(g, dims, packed_type(&s->field.packed));
    text_name(g->name, sizeof g->name, s->path + 1);
    g->absent = s->field.absent;
    status st = grid_check(g, path);
    return st == ST_OK ? hdf5_field_place(s->file, path, s->path, &s->field, g) : st;
}

static status begin_slices(hdf5_slices *s, const grid *g) {
    s->slices = (packed_slices){.m = s->m,
                                .file = file_path(s->guard),
                                .field = s->path,
                                .packed = s->field.packed,
                                .chunk_depth = s->field.chunk[s->field.at[HDF5_Z]],
                                .chunk_bytes = s->field.chunk_bytes,
                                .load = load_slab,
                                .ctx = s};
    memcpy(s->slices.dims, g->dims, sizeof g->dims);
    const hdf5_field *f = &s->field;
    status st = f->minc && f->packed.has_range
                    ? hdf5_minc_scales(s->m, s->file, file_path(s->guard), s->path, f, s->step,
                                       &s->slices.scales)
                    : ST_OK;
    return st == ST_OK ? packed_slices_begin(&s->slices) : st;
}

status hdf5_slices_open(mem *m, const import_request *q, const char *axes, slice_source *out) {
    hdf5_slices *s = NULL;
    grid g;
    status st = create(m, q, &s);
    if (st != ST_OK)
        return st;
    st = choose(s, q, axes);
    if (st == ST_OK)
        st = choose_step(s, q);
    if (st == ST_OK)
        st = choose_component(s, q);
    if (st == ST_OK)
        st = absent_check(&s->field.absent, q->paths[0], q->trust.allow_missing);
    if (st == ST_OK)
        st = make_grid(s, &g);
    if (st == ST_OK)
        st = begin_slices(s, &g);
    if (st != ST_OK) {
        close_slices(s);
        return st;
    }
    *out = (slice_source){.format = s->field.minc ? "MINC 2" : "HDF5",
                          .name = file_path(s->guard),
                          .m = m,
                          .g = g,
                          .read = read_slices,
                          .place = find_place,
                          .place_ctx = s,
                          .close = close_slices,
                          .ctx = s};
    return ST_OK;
}
