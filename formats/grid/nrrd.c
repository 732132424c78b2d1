#include "formats/grid/nrrd.h"
#include "formats/grid/volume_files.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "formats/base/num.h"
#include "formats/base/text.h"
#include "formats/input/header_fields.h"

/* A header that is being interpreted. Per-axis values are in the file's order until squeeze() has
 * picked the three axes. */
typedef struct nrrd {
    header_fields fields;
    volume_layout *l;
    int axes;  /* 3 or 4 in the file; a fourth, first or last, is not the volume's */
    int first; /* the volume's axes are first .. first + 2 */
} nrrd;

static const char *const known_fields[] = {
    "dimension",
    "type",
    "block size",
    "encoding",
    "endian",
    "content",
    "old min",
    "old max",
    "min",
    "max",
    "data file",
    "line skip",
    "byte skip",
    "number",
    "sample units",
    "sizes",
    "spacings",
    "thicknesses",
    "axis mins",
    "axis maxs",
    "centers",
    "centerings",
    "labels",
    "units",
    "kinds",
    "space",
    "space dimension",
    "space units",
    "space origin",
    "space directions",
    "measurement frame",
};

static bool known(const char *path, const uint8_t *start, size_t size) {
    (void)path;
    return size >= 4 && memcmp(start, "NRRD", 4) == 0;
}

static const header_field *get(const nrrd *n, const char *key) {
    return header_fields_find(&n->fields, key);
}

static status need(const nrrd *n, const char *key, const header_field **out) {
    *out = get(n, key);
    return *out ? ST_OK : header_fields_missing(&n->fields, key);
}

static status check_magic(byte_stream *s) {
    const uint8_t *data;
    size_t size;
    status st = byte_stream_peek(s, 10, &data, &size);
    if (st != ST_OK)
        return st;
    if (size < 9 || memcmp(data, "NRRD000", 7) != 0 || data[7] < '1' || data[7] > '9' ||
        (data[8] != '\n' && data[8] != '\r'))
        return status_describe(ST_CORRUPT, "%s: line 1: expected NRRD0001 to NRRD0005",
                               byte_stream_name(s));
    if (data[7] > '5')
        return status_describe(ST_UNSUPPORTED, "%s: line 1: NRRD version %c; 1 to 5 are supported",
                               byte_stream_name(s), data[7]);
    byte_stream_take(s, data[8] == '\r' && size > 9 && data[9] == '\n' ? 10 : 9);
    return ST_OK;
}

/* Refuse unknown fields, as the format demands: a misspelt one would silently give another picture.
 */
static status check_known(const nrrd *n) {
    for (size_t i = 0; i < n->fields.count; i++) {
        const header_field *f = &n->fields.items[i];
        bool known = f->pair;
        for (size_t k = 0; !known && k < sizeof known_fields / sizeof known_fields[0]; k++)
            known = header_fields_same(f->key, known_fields[k]);
        if (!known)
            return header_fields_fault(&n->fields, f, ST_CORRUPT, "no such NRRD field");
    }
    return ST_OK;
}

/* ---- sizes and type ---- */

/* Returns word number `axis` of a per-axis field, "" if there is none. */
static const char *word_of_axis(const header_field *f, int axis) {
    const char *at = f ? f->value : "";
    for (; axis > 0; axis--) {
        at += strcspn(at, " \t");
        at += strspn(at, " \t");
    }
    return at;
}

static bool is_word(const char *at, const char *word) {
    const size_t length = strlen(word);
    return strncasecmp(at, word, length) == 0 && (!at[length] || strchr(" \t", at[length]));
}

static bool is_any_word(const char *at, const char *const *words) {
    while (*words && !is_word(at, *words))
        words++;
    return *words != NULL;
}

/* Returns whether an axis holds the numbers of a sample, by its kind. */
static bool has_numbers(const nrrd *n, int axis) {
    static const char *const others[] = {"", "none", "???", "domain", "space", "time", NULL};
    return !is_any_word(word_of_axis(get(n, "kinds"), axis), others);
}

static void set_numbers(const nrrd *n, int axis, uint32_t size) {
    static const uint8_t last[] = {ORDER_X, ORDER_Y, ORDER_Z, ORDER_COMPONENT, ORDER_STEP};
    static const char *const colours[] = {"RGB-color", "RGBA-color", "3-color", "4-color", NULL};
    volume_layout *l = n->l;
    l->stored.components = size;
    l->stored.colours = is_any_word(word_of_axis(get(n, "kinds"), axis), colours);
    l->ordered = axis == 3 && size > 1;
    memcpy(l->order, last, sizeof last);
}

/* Interpret the axis beside the volume's three: numbers of a sample, first or last, or time steps.
 */
static bool take_fourth_axis(nrrd *n, const uint32_t all[4]) {
    const bool last = !has_numbers(n, 0) && all[0] != 1;
    n->first = !last;
    if (last && is_word(word_of_axis(get(n, "kinds"), 3), "time"))
        n->l->steps = all[3];
    else if (last && all[3] != 1 && !has_numbers(n, 3))
        return false;
    else
        set_numbers(n, last ? 3 : 0, all[last ? 3 : 0]);
    return true;
}

static status read_sizes(nrrd *n) {
    const header_field *dimension, *sizes;
    int64_t axes = 0;
    status st = need(n, "dimension", &dimension);
    if (st == ST_OK)
        st = header_fields_int(&n->fields, dimension, 1, HEADER_FIELDS_AXES, &axes);
    if (st == ST_OK)
        st = need(n, "sizes", &sizes);
    uint32_t all[HEADER_FIELDS_AXES];
    if (st == ST_OK)
        st = header_fields_sizes(&n->fields, sizes, (int)axes, all);
    if (st != ST_OK)
        return st;
    n->axes = (int)axes;
    if (axes == 2)
        all[2] = 1;
    if (axes != 2 && axes != 3 && !(axes == 4 && take_fourth_axis(n, all)))
        return header_fields_fault(&n->fields, sizes, ST_UNSUPPORTED,
                                   "\"%s\": a volume has three axes, or a fourth, first or last, "
                                   "of which \"kinds\" tells what it is: vector, RGB-color, time",
                                   sizes->value);
    memcpy(n->l->g.dims, all + n->first, sizeof n->l->g.dims);
    return ST_OK;
}

static status read_content(nrrd *n) {
    const header_field *f = get(n, "content");
    if (f)
        snprintf(n->l->g.name, sizeof n->l->g.name, "%s", f->value);
    return ST_OK;
}

static status read_type(nrrd *n) {
    const header_field *type;
    status st = need(n, "type", &type);
    if (st == ST_OK && !sample_parse(type->value, &n->l->stored.type))
        st = header_fields_fault(&n->fields, type, ST_UNSUPPORTED,
                                 "\"%s\": supported are 8 to 64 bit integers, float and double",
                                 type->value);
    return st;
}

/* ---- encoding and byte order ---- */

static bool is_one_of(const char *value, const char *const *names) {
    for (; *names; names++)
        if (strcasecmp(value, *names) == 0)
            return true;
    return false;
}

static status read_encoding(nrrd *n) {
    static const char *const gzip[] = {"gzip", "gz", NULL};
    static const char *const bzip2[] = {"bzip2", "bz2", NULL};
    static const char *const text[] = {"text", "txt", "ascii", NULL};
    const header_field *f;
    status st = need(n, "encoding", &f);
    if (st != ST_OK)
        return st;
    if (strcasecmp(f->value, "raw") == 0)
        n->l->encoding = VOLUME_RAW;
    else if (is_one_of(f->value, gzip))
        n->l->encoding = VOLUME_DEFLATE;
    else if (is_one_of(f->value, bzip2))
        n->l->encoding = VOLUME_BZIP2;
    else if (is_one_of(f->value, text))
        n->l->encoding = VOLUME_TEXT;
    else
        return header_fields_fault(&n->fields, f, ST_UNSUPPORTED,
                                   "\"%s\": supported are raw, gzip, bzip2 and text", f->value);
    return ST_OK;
}

static status read_endian(nrrd *n) {
    const header_field *f = get(n, "endian");
    bool matters = sample_size(n->l->stored.type) > 1 && n->l->encoding != VOLUME_TEXT;
    if (!f)
        return matters ? header_fields_missing(&n->fields, "endian") : ST_OK;
    n->l->big_endian = strcasecmp(f->value, "big") == 0;
    if (matters && !n->l->big_endian && strcasecmp(f->value, "little") != 0)
        return header_fields_fault(&n->fields, f, ST_CORRUPT, "\"%s\": expected little or big",
                                   f->value);
    return ST_OK;
}

/* ---- where the nodes lie ---- */

/* Read a per-axis field of numbers for the volume's three axes; NaN where it is absent or says nan.
 */
static status read_axis_numbers(const nrrd *n, const char *key, double out[3]) {
    const header_field *f = get(n, key);
    double all[4] = {NAN, NAN, NAN, NAN};
    status st = f ? header_fields_numbers(&n->fields, f, n->axes, all) : ST_OK;
    memcpy(out, all + n->first, 3 * sizeof *out);
    return st;
}

/* Read the vector "(x,y,z)", or "none", at *text, and move *text behind it. */
static status take_vector(const nrrd *n, const header_field *f, const char **text, bool *none,
                          double out[3]) {
    const char *at = *text + strspn(*text, " \t");
    *none = strncasecmp(at, "none", 4) == 0;
    if (*none) {
        *text = at + 4;
        return ST_OK;
    }
    const char *close = strchr(at, ')');
    char inside[160];
    if (*at == '(' && close && (size_t)(close - at) < sizeof inside) {
        memcpy(inside, at + 1, (size_t)(close - at) - 1);
        inside[close - at - 1] = 0;
        *text = close + 1;
        if (num_doubles(inside, "", ", ", 3, out) == ST_OK)
            return ST_OK;
    }
    return header_fields_fault(&n->fields, f, ST_CORRUPT,
                               "\"%s\": expected vectors \"(x,y,z)\" of three numbers", f->value);
}

static status check_space(const nrrd *n) {
    const header_field *f = get(n, "space dimension");
    int64_t dimension = 3;
    if (f) {
        status st = header_fields_int(&n->fields, f, 1, HEADER_FIELDS_AXES, &dimension);
        if (st != ST_OK)
            return st;
    }
    if (dimension != 3)
        return header_fields_fault(&n->fields, f, ST_UNSUPPORTED, "a volume lies in a space of 3");
    return ST_OK;
}

/* Values of "space", as names or letters, with or without "-time" behind. Where the axes are
 * unknown, their directions are the scanner's. */
static const struct {
    const char *name, *letters;
    world_axes axes;
    bool mirrored; /* x is mirrored: LAS */
} spaces[] = {
    {"right-anterior-superior", "RAS", WORLD_RAS, false},
    {"left-posterior-superior", "LPS", WORLD_LPS, false},
    {"left-anterior-superior", "LAS", WORLD_RAS, true},
    {"scanner-xyz", "", WORLD_UNTOLD, false},
    {"3D-right-handed", "", WORLD_UNTOLD, false},
    {"3D-left-handed", "", WORLD_UNTOLD, false},
};

static bool is_space(const char *value, const char *name) {
    const size_t length = strlen(name);
    return length > 0 && strncasecmp(value, name, length) == 0 &&
           (!value[length] || strcasecmp(value + length, "-time") == 0);
}

/* Read units, which are quoted strings or words. Those of the space's axes come first. */
static void take_units(world_frame *frame, const char *text) {
    for (int a = 0; a < 3; a++) {
        char unit[WORLD_UNIT];
        text += strspn(text, " \t");
        const bool quoted = *text == '"';
        text += quoted;
        const size_t length = strcspn(text, quoted ? "\"" : " \t");
        snprintf(unit, sizeof unit, "%.*s", (int)length, text);
        world_frame_set_unit(frame, a, unit);
        text += length;
        text += quoted && *text;
    }
}

/* Read the space and its units. LAS is mirrored to become RAS. */
static status read_frame(const nrrd *n) {
    const header_field *space = get(n, "space"), *units = get(n, "space units");
    grid *g = &n->l->g;
    if (units)
        take_units(&g->frame, units->value);
    if (!space)
        return ST_OK;
    for (size_t i = 0; i < sizeof spaces / sizeof *spaces; i++) {
        if (!is_space(space->value, spaces[i].name) && !is_space(space->value, spaces[i].letters))
            continue;
        g->frame.axes = spaces[i].axes;
        for (int c = 0; spaces[i].mirrored && c < 4; c++)
            g->to_world[0][c] = 0 - g->to_world[0][c]; /* never -0 */
        return ST_OK;
    }
    return header_fields_fault(&n->fields, space, ST_CORRUPT,
                               "\"%s\": expected a space that NRRD knows, such as "
                               "left-posterior-superior or RAS",
                               space->value);
}

/* Read the step from node to node along each axis: a vector of "space directions", or a spacing
 * along x, y or z. */
static status read_directions(const nrrd *n, double direction[3][3], double spacing[3]) {
    const header_field *f = get(n, "space directions");
    const char *text = f ? f->value : "";
    bool any = false;
    for (int axis = 0; f && axis < n->axes; axis++) {
        double v[3];
        bool none;
        status st = take_vector(n, f, &text, &none, v);
        if (st != ST_OK)
            return st;
        int a = axis - n->first;
        if (none || a < 0 || a > 2)
            continue;
        memcpy(direction[a], v, sizeof v);
        spacing[a] = 1;
        any = true;
    }
    if (any && text[strspn(text, " \t")])
        return header_fields_fault(&n->fields, f, ST_CORRUPT, "\"%s\": expected %d vectors",
                                   f->value, n->axes);
    return ST_OK;
}

/* Returns whether samples sit in the middle of their part of the axis. Then they start half a step
 * behind its minimum. */
static bool is_cell_centred(const nrrd *n, int a) {
    const header_field *f = get(n, "centerings");
    if (!f)
        f = get(n, "centers");
    return strncasecmp(word_of_axis(f, a + n->first), "cell", 4) == 0;
}

/* Read spacings and positions of axes given by their ends. */
static status read_ends(const nrrd *n, double spacing[3], double origin[3]) {
    double lo[3], hi[3];
    status st = read_axis_numbers(n, "axis mins", lo);
    if (st == ST_OK)
        st = read_axis_numbers(n, "axis maxs", hi);
    for (int a = 0; st == ST_OK && a < 3; a++) {
        bool cell = is_cell_centred(n, a);
        double steps = (double)n->l->g.dims[a] - !cell;
        if (isnan(spacing[a]))
            spacing[a] = isnan(lo[a] - hi[a]) || steps == 0 ? 1 : (hi[a] - lo[a]) / steps;
        origin[a] = isnan(lo[a]) ? 0 : lo[a] + (cell ? spacing[a] / 2 : 0);
    }
    return st;
}

static status read_placement(const nrrd *n) {
    double direction[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    double spacing[3], origin[3] = {0, 0, 0};
    status st = check_space(n);
    if (st == ST_OK)
        st = read_axis_numbers(n, "spacings", spacing);
    if (st == ST_OK)
        st = read_ends(n, spacing, origin);
    const header_field *f = get(n, "space origin");
    if (st == ST_OK && (f || get(n, "space directions")))
        memset(origin, 0, sizeof origin);
    if (st == ST_OK)
        st = read_directions(n, direction, spacing);
    bool none = false;
    const char *text = f ? f->value : NULL;
    if (st == ST_OK && f)
        st = take_vector(n, f, &text, &none, origin);
    if (st == ST_OK)
        volume_layout_place(n->l, direction, spacing, origin);
    return st == ST_OK ? read_frame(n) : st;
}

/* Copy the quoted word of an axis; "" if there is none. */
static void take_word(const char *text, int axis, char *to, size_t room) {
    to[0] = 0;
    for (int quotes = 0; quotes <= 2 * axis; quotes++) {
        text = strchr(text, '"');
        if (!text)
            return;
        text++;
    }
    const char *end = strchr(text, '"');
    if (end)
        snprintf(to, room, "%.*s", (int)(end - text), text);
}

/* Read where the axis of times, which is the last, starts, and its spacing and unit. */
static status read_times(const nrrd *n) {
    const header_field *spacings = get(n, "spacings"), *mins = get(n, "axis mins");
    const header_field *units = get(n, "units");
    double step[4] = {NAN, NAN, NAN, NAN}, first[4] = {NAN, NAN, NAN, NAN};
    char unit[WORLD_TIME_UNIT];
    if (n->axes != 4 || n->l->steps < 2)
        return ST_OK;
    status st = spacings ? header_fields_numbers(&n->fields, spacings, 4, step) : ST_OK;
    if (st == ST_OK && mins)
        st = header_fields_numbers(&n->fields, mins, 4, first);
    n->l->time_step = isfinite(step[3]) ? step[3] : 0;
    n->l->first_time = isfinite(first[3]) ? first[3] : 0;
    take_word(units ? units->value : "", 3, unit, sizeof unit);
    world_frame_set_time_unit(&n->l->g.frame, unit);
    return st;
}

static status read_axes(const nrrd *n) {
    for (int a = 0; a < 3; a++) {
        char key[32], what[512];
        snprintf(key, sizeof key, "leafcast axis %d", a);
        const header_field *f = header_fields_find_pair(&n->fields, key);
        if (!f)
            continue;
        snprintf(what, sizeof what, "%s: line %u: %s", n->fields.name, f->line, key);
        status st = grid_set_axis_text(&n->l->g, n->l->m, what, a, f->value);
        if (st != ST_OK)
            return st;
    }
    return ST_OK;
}

static void read_words(const nrrd *n) {
    const header_field *absent = header_fields_find_pair(&n->fields, "leafcast absent");
    const header_field *note = header_fields_find_pair(&n->fields, "leafcast note");
    const header_field *place = header_fields_find_pair(&n->fields, "leafcast place");
    const header_field *fields = header_fields_find_pair(&n->fields, "leafcast fields");
    const header_field *missing = header_fields_find_pair(&n->fields, "leafcast missing");
    n->l->g.terrain = header_fields_find_pair(&n->fields, "leafcast terrain") != NULL;
    n->l->has_missing = missing && num_double(missing->value, "", &n->l->missing) == ST_OK;
    if (absent)
        absent_parse(absent->value, &n->l->g.absent);
    if (note)
        text_name(n->l->g.note, sizeof n->l->g.note, note->value);
    if (place)
        text_name(n->l->g.place, sizeof n->l->g.place, place->value);
    if (fields && strlen(fields->value) < sizeof n->l->g.fields) /* JSON that is cut is none */
        memcpy(n->l->g.fields, fields->value, strlen(fields->value) + 1);
}

/* ---- where the samples are ---- */

static status find_samples(const nrrd *n, const volume_hints *hints) {
    const header_field *file = get(n, "data file");
    const header_field *line_skip = get(n, "line skip"), *byte_skip = get(n, "byte skip");
    int64_t lines = 0, bytes = 0;
    status st = ST_OK;
    if (line_skip)
        st = header_fields_int(&n->fields, line_skip, 0, INT32_MAX, &lines);
    if (st == ST_OK && byte_skip)
        st = header_fields_int(&n->fields, byte_skip, -INT64_MAX, INT64_MAX, &bytes);
    if (st == ST_OK && file && volume_files_are(file->value))
        return volume_files_open(n->l, n->fields.name, file->value, hints->trust.follow_links,
                                 (uint64_t)lines, bytes);
    if (st == ST_OK && file)
        st = volume_layout_open(n->l, n->fields.name, file->value, hints->trust.follow_links,
                                byte_stream_open_stored);
    return st == ST_OK ? volume_layout_skip(n->l, (uint64_t)lines, bytes) : st;
}

static status interpret(nrrd *n) {
    status (*const steps[])(nrrd *) = {read_sizes, read_content, read_type, read_encoding,
                                       read_endian};
    status st = check_known(n);
    for (size_t i = 0; st == ST_OK && i < sizeof steps / sizeof steps[0]; i++)
        st = steps[i](n);
    if (st == ST_OK)
        st = read_placement(n);
    if (st == ST_OK)
        st = grid_check(&n->l->g, n->fields.name);
    if (st == ST_OK)
        st = read_axes(n);
    if (st == ST_OK)
        st = read_times(n);
    read_words(n);
    return st;
}

static status open_layout(volume_layout *l, const volume_hints *hints) {
    byte_stream *header = l->data;
    status st = check_magic(header);
    if (st != ST_OK)
        return st;
    nrrd n = {.l = l};
    static const header_style style = {.separator = ':',
                                       .ends_blank = true,
                                       .end_key = "data file",
                                       .end_value = "LIST",
                                       .lines_read = 1};
    const uint32_t none[3] = {0, 0, 0};
    grid_init(&l->g, none, SAMPLE_U8);
    st = header_fields_read(&n.fields, l->m, header, &style);
    if (st == ST_OK)
        st = interpret(&n);
    if (st == ST_OK)
        st = find_samples(&n, hints);
    header_fields_release(&n.fields);
    return st;
}

const grid_reader nrrd_reader = {.format = "NRRD", .known = known, .layout = open_layout};
