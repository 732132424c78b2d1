#include "formats/grid/xdmf_file.h"

#include <expat.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "formats/base/file.h"
#include "formats/base/num.h"
#include "formats/grid/grid.h"
#include "formats/input/named_file.h"
#include "formats/input/text_number.h"

#define PARAVIEW "ParaView opens it and saves it as .vti or .vtu"

enum { DEPTH_MAX = 32, TEXT_MAX = 1 << 25, STEPS_MAX = 1 << 20, TOKEN_MAX = 64 };

/* Our kinds of elements. */
typedef enum element {
    OTHER, /* unknown, with all that is in it */
    ROOT,
    DOMAIN,
    COLLECTION,
    GRID,
    TOPOLOGY,
    GEOMETRY,
    ATTRIBUTE,
    TIME,
    ITEM
} element;

typedef struct scan {
    mem *m;
    xdmf_file *to;
    const char *path;
    byte_stream *s;
    bool follow_links;
    uint32_t step; /* the step to keep */
    XML_Parser parser;
    status st; /* the fault of a handler that stopped the parser */
    element nest[DEPTH_MAX];
    int depth;
    /* the grid that is being read */
    bool kept, topology, rectilinear, geometry, timed;
    double time;
    int items;         /* items of its geometry so far */
    xdmf_field field;  /* the current attribute */
    bool item_of_text; /* the current item's numbers stand in this file */
    size_t rooms, field_room;
    uint32_t times;     /* number of steps that have a time */
    double *list;       /* the collection's times */
    uint64_t list_size; /* how many numbers the list has */
    bool list_of_steps; /* the list has the first time, the step and the count */
    char *text;         /* text of an item */
    size_t length, room;
} scan;

/* ---- faults ---- */

static status fault(const scan *x, status st, const char *fmt, ...)
    __attribute__((format(printf, 3, 4)));

static status fault(const scan *x, status st, const char *fmt, ...) {
    char text[STATUS_TEXT_MAX];
    va_list args;
    va_start(args, fmt);
    vsnprintf(text, sizeof text, fmt, args);
    va_end(args);
    return status_describe(st, "%s: line %llu: %s", byte_stream_name(x->s),
                           (unsigned long long)XML_GetCurrentLineNumber(x->parser), text);
}

static status refuse(const scan *x, const char *what, const char *value) {
    return fault(x, ST_UNSUPPORTED, "%s \"%.60s\" of XDMF is not read here; " PARAVIEW, what,
                 value);
}

static const char *find(const char **attributes, const char *name, const char *other) {
    for (; *attributes; attributes += 2)
        if (strcasecmp(attributes[0], name) == 0 || (other && strcasecmp(*attributes, other) == 0))
            return attributes[1];
    return NULL;
}

static bool is(const char *value, const char *word) {
    return value && strcasecmp(value, word) == 0;
}

/* ---- numbers ---- */

/* Read the next word of a text. Returns false if there is none, or it is too long. */
static bool next_word(const char **at, char word[TOKEN_MAX]) {
    *at += strspn(*at, " \t\r\n,");
    const size_t length = strcspn(*at, " \t\r\n,");
    if (length == 0 || length >= TOKEN_MAX)
        return false;
    memcpy(word, *at, length);
    word[length] = 0;
    *at += length;
    return true;
}

/* Read exactly count finite numbers. */
static status read_numbers(const scan *x, const char *text, size_t count, double *out) {
    char word[TOKEN_MAX];
    size_t n = 0;
    const char *at = text ? text : "";
    for (; n < count && next_word(&at, word); n++)
        if (!text_number_double(word, &out[n]) || !isfinite(out[n]))
            return fault(x, ST_CORRUPT, "\"%s\", expected a finite number", word);
    at += strspn(at, " \t\r\n,");
    if (n < count || *at)
        return fault(x, ST_CORRUPT, "%s than the %zu numbers that are expected",
                     n < count ? "fewer" : "more", count);
    return ST_OK;
}

/* Read whole numbers from 1 on, at most XDMF_RANK; *rank: how many. */
static status read_dims(const scan *x, const char *text, uint64_t dims[XDMF_RANK], int *rank) {
    char word[TOKEN_MAX];
    int64_t n;
    const char *at = text ? text : "";
    for (*rank = 0; *rank < XDMF_RANK && next_word(&at, word); ++*rank) {
        if (!text_number_int(word, 1, INT64_MAX, &n))
            return fault(x, ST_CORRUPT, "Dimensions: \"%s\", expected a whole number from 1 on",
                         word);
        dims[*rank] = (uint64_t)n;
    }
    at += strspn(at, " \t\r\n,");
    if (*at || *rank == 0)
        return fault(x, ST_CORRUPT, "Dimensions=\"%.60s\", expected 1 to %d whole numbers",
                     text ? text : "", XDMF_RANK);
    return ST_OK;
}

/* ---- the elements of a grid ---- */

static status begin_grid(scan *x) {
    if (x->to->steps == STEPS_MAX)
        return fault(x, ST_UNSUPPORTED, "more than %d grids", STEPS_MAX);
    x->kept = x->to->steps++ == x->step;
    x->topology = x->geometry = x->rectilinear = x->timed = false;
    x->items = 0;
    return ST_OK;
}

static status on_grid(scan *x, const char **attributes, element parent, element *out) {
    const char *kind = find(attributes, "GridType", NULL);
    const char *of = find(attributes, "CollectionType", NULL);
    *out = GRID;
    if (is(kind, "Collection") && parent == DOMAIN && is(of, "Temporal")) {
        *out = COLLECTION;
        return ST_OK;
    }
    if (is(kind, "Collection"))
        return refuse(x, "the collection", of ? of : "Spatial");
    if (kind && !is(kind, "Uniform"))
        return refuse(x, "the GridType", kind);
    if (parent == DOMAIN && x->to->steps > 0)
        return fault(x, ST_UNSUPPORTED,
                     "a second grid that is no time step; " PARAVIEW " one by one");
    return begin_grid(x);
}

static status on_topology(scan *x, const char **attributes) {
    const char *type = find(attributes, "TopologyType", "Type");
    const char *text = find(attributes, "Dimensions", "NumberOfElements");
    uint64_t dims[XDMF_RANK];
    int rank;
    x->rectilinear = is(type, "3DRectMesh");
    if (!x->rectilinear && !is(type, "3DCoRectMesh"))
        return refuse(x, "the topology", type ? type : "");
    if (x->topology)
        return fault(x, ST_CORRUPT, "a second topology of a grid");
    x->topology = true;
    status st = read_dims(x, text, dims, &rank);
    if (st == ST_OK && rank != 3)
        st = fault(x, ST_CORRUPT, "a topology of %d dimensions, expected 3", rank);
    for (int a = 0; st == ST_OK && a < 3; a++)
        if (dims[2 - a] > GRID_DIM_MAX)
            st = fault(x, ST_UNSUPPORTED, "%llu nodes; at most %d are supported",
                       (unsigned long long)dims[2 - a], GRID_DIM_MAX);
        else if (x->kept)
            x->to->nodes[a] = (uint32_t)dims[2 - a];
    return st;
}

static status on_geometry(scan *x, const char **attributes) {
    const char *type = find(attributes, "GeometryType", "Type");
    if (!x->topology)
        return fault(x, ST_CORRUPT, "the geometry before the topology");
    if (x->geometry)
        return fault(x, ST_CORRUPT, "a second geometry of a grid");
    x->geometry = true;
    return is(type, x->rectilinear ? "VXVYVZ" : "ORIGIN_DXDYDZ")
               ? ST_OK
               : refuse(x, "the geometry", type ? type : "XYZ");
}

static void drop_field(scan *x) {
    mem_free(x->m, x->field.name);
    mem_free(x->m, x->field.file);
    mem_free(x->m, x->field.inside);
    x->field = (xdmf_field){0};
}

static status on_attribute(scan *x, const char **attributes) {
    const char *name = find(attributes, "Name", NULL), *center = find(attributes, "Center", NULL);
    drop_field(x);
    x->field.cells = is(center, "Cell");
    x->field.name = mem_copy_text(x->m, name ? name : "");
    if (!x->field.name)
        return ST_NOMEM;
    return !center || is(center, "Node") || x->field.cells ? ST_OK
                                                           : refuse(x, "the Center", center);
}

static status on_time(scan *x, const char **attributes, element parent) {
    const char *value = find(attributes, "Value", NULL), *type = find(attributes, "TimeType", NULL);
    if (parent == COLLECTION) {
        x->list_of_steps = is(type, "HyperSlab");
        return x->list_of_steps || is(type, "List") ? ST_OK
                                                    : refuse(x, "the TimeType", type ? type : "");
    }
    if (type && !is(type, "Single"))
        return refuse(x, "the TimeType", type);
    x->timed = value != NULL;
    return value ? read_numbers(x, value, 1, &x->time) : ST_OK;
}

/* ---- items ---- */

static status read_type(const scan *x, const char **attributes, sample_type *out) {
    static const struct {
        const char *name;
        int precision;
        sample_type type;
    } types[] = {{"Float", 4, SAMPLE_F32}, {"Float", 8, SAMPLE_F64}, {"Int", 1, SAMPLE_I8},
                 {"Int", 2, SAMPLE_I16},   {"Int", 4, SAMPLE_I32},   {"Int", 8, SAMPLE_I64},
                 {"UInt", 1, SAMPLE_U8},   {"UInt", 2, SAMPLE_U16},  {"UInt", 4, SAMPLE_U32},
                 {"UInt", 8, SAMPLE_U64},  {"Char", 1, SAMPLE_I8},   {"UChar", 1, SAMPLE_U8}};
    const char *name = find(attributes, "NumberType", "DataType");
    const char *precision = find(attributes, "Precision", NULL);
    name = name ? name : "Float";
    int64_t bytes = is(name, "Char") || is(name, "UChar") ? 1 : 4;
    if (precision && !text_number_int(precision, 1, 16, &bytes))
        return fault(x, ST_CORRUPT, "Precision=\"%.40s\", expected bytes", precision);
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        if (is(name, types[i].name) && bytes == types[i].precision) {
            *out = types[i].type;
            return ST_OK;
        }
    return fault(x, ST_UNSUPPORTED, "numbers of type %.40s and %lld bytes", name, (long long)bytes);
}

static status on_heavy(scan *x, const char **attributes, bool raw) {
    xdmf_field *f = &x->field;
    const char *seek = find(attributes, "Seek", NULL), *endian = find(attributes, "Endian", NULL);
    const char *packed = find(attributes, "Compression", NULL);
    status st = read_dims(x, find(attributes, "Dimensions", NULL), f->dims, &f->rank);
    if (st == ST_OK && raw)
        st = read_type(x, attributes, &f->type);
    if (st == ST_OK && packed && !is(packed, "Raw"))
        st = refuse(x, "the Compression", packed);
    f->big_endian = is(endian, "Big");
    if (st == ST_OK && endian && !f->big_endian && !is(endian, "Little") && !is(endian, "Native"))
        st = fault(x, ST_CORRUPT, "Endian=\"%.40s\", expected Little, Big or Native", endian);
    if (st == ST_OK && seek && !text_number_whole(seek, &f->seek))
        st = fault(x, ST_CORRUPT, "Seek=\"%.40s\", expected a number of bytes", seek);
    return st;
}

/* Begin the list of a collection's times. */
static status on_times(scan *x, const char **attributes) {
    uint64_t dims[XDMF_RANK];
    int rank;
    if (!x->item_of_text)
        return refuse(x, "a list of times in the format", find(attributes, "Format", NULL));
    status st = read_dims(x, find(attributes, "Dimensions", NULL), dims, &rank);
    if (st == ST_OK && (rank != 1 || dims[0] > STEPS_MAX || (x->list_of_steps && dims[0] != 3)))
        st = fault(x, ST_CORRUPT, "a list of times of other dimensions than expected");
    x->list_size = dims[0];
    return st;
}

static status on_item(scan *x, const char **attributes, element parent) {
    const char *kind = find(attributes, "ItemType", NULL);
    const char *format = find(attributes, "Format", NULL);
    x->length = 0;
    x->item_of_text = !format || is(format, "XML");
    if (kind && !is(kind, "Uniform"))
        return refuse(x, "the ItemType", kind);
    if (parent == TIME)
        return on_times(x, attributes);
    if (parent == GEOMETRY)
        return x->item_of_text ? ST_OK : refuse(x, "a geometry in the format", format);
    if (x->field.file)
        return fault(x, ST_UNSUPPORTED, "an attribute of several items");
    const bool raw = is(format, "Binary");
    if (!raw && !is(format, "HDF"))
        return refuse(x, "an attribute in the format", format ? format : "XML");
    return on_heavy(x, attributes, raw);
}

/* Take an item of a geometry. Origin and spacing stand as z, y, x, as ParaView reads them. */
static status end_of_geometry(scan *x) {
    xdmf_file *to = x->to;
    double zyx[3];
    const int i = x->items++;
    if (!x->kept || i >= (x->rectilinear ? 3 : 2))
        return x->kept ? fault(x, ST_CORRUPT, "too many items of a geometry") : ST_OK;
    if (x->rectilinear) {
        to->axis[i] = mem_array(x->m, to->nodes[i], sizeof *to->axis[i]);
        return to->axis[i] ? read_numbers(x, x->text, to->nodes[i], to->axis[i]) : ST_NOMEM;
    }
    status st = read_numbers(x, x->text, 3, zyx);
    for (int a = 0; st == ST_OK && a < 3; a++)
        (i == 0 ? to->origin : to->spacing)[a] = zyx[2 - a];
    return st;
}

static status end_of_times(scan *x) {
    if (x->list)
        return fault(x, ST_CORRUPT, "a second list of times");
    x->list = mem_array(x->m, (size_t)x->list_size, sizeof *x->list);
    return x->list ? read_numbers(x, x->text, (size_t)x->list_size, x->list) : ST_NOMEM;
}

/* Check that a file is there, and count it as an input from now on. */
static status look_at(const scan *x, const char *path) {
    file *f = NULL;
    char why[STATUS_TEXT_MAX];
    status st = file_open(x->m, path, &f);
    file_close(f);
    if (st != ST_IO)
        return st;
    snprintf(why, sizeof why, "%s", status_text());
    return fault(x, st, "the file that it names: %s", why);
}

/* Read where an attribute's samples are: "file.h5:/path", or the file of raw samples. */
static status end_of_attribute(scan *x) {
    xdmf_field *f = &x->field;
    char *name = x->text + strspn(x->text, " \t\r\n");
    size_t length = strlen(name);
    while (length > 0 && strchr(" \t\r\n", name[length - 1]))
        name[--length] = 0;
    char *colon = f->type ? NULL : strrchr(name, ':');
    if (!*name || (!f->type && (!colon || colon == name || !colon[1])))
        return fault(x, ST_CORRUPT, "\"%.60s\", expected %s", name,
                     f->type ? "the name of a file" : "FILE:/PATH of a data set in HDF5");
    if (colon) {
        *colon++ = 0;
        f->inside = mem_copy_text(x->m, colon);
        if (!f->inside)
            return ST_NOMEM;
    }
    status st = named_file_find(x->m, x->path, name, x->follow_links, &f->file);
    return st == ST_OK ? look_at(x, f->file) : st;
}

static status end_item(scan *x, element parent) {
    if (!x->text || x->length == 0)
        return fault(x, ST_CORRUPT, "an item without contents");
    x->text[x->length] = 0;
    return parent == GEOMETRY ? end_of_geometry(x)
           : parent == TIME   ? end_of_times(x)
                              : end_of_attribute(x);
}

static status end_attribute(scan *x) {
    xdmf_file *to = x->to;
    if (!x->field.file)
        return fault(x, ST_CORRUPT, "an attribute without an item");
    if (!x->kept)
        return ST_OK;
    status st = mem_grow(x->m, &to->fields, sizeof *to->fields, to->count, 8, &x->field_room);
    if (st != ST_OK)
        return st;
    to->fields[to->count++] = x->field;
    x->field = (xdmf_field){0};
    return ST_OK;
}

static status end_grid(scan *x) {
    xdmf_file *to = x->to;
    if (!x->geometry || (x->kept && x->items < (x->rectilinear ? 3 : 2)))
        return fault(x, ST_CORRUPT, "a grid without a complete geometry");
    status st = mem_grow(x->m, &to->times, sizeof *to->times, to->steps - 1, 16, &x->rooms);
    if (st != ST_OK)
        return st;
    to->times[to->steps - 1] = x->time;
    x->times += x->timed;
    return ST_OK;
}

/* ---- elements ---- */

static element child_of(element parent, const char *name) {
    static const struct {
        element parent;
        const char *name;
        element child;
    } rows[] = {
        {ROOT, "Domain", DOMAIN},     {DOMAIN, "Grid", GRID},       {COLLECTION, "Grid", GRID},
        {GRID, "Topology", TOPOLOGY}, {GRID, "Geometry", GEOMETRY}, {GRID, "Attribute", ATTRIBUTE},
        {GRID, "Time", TIME},         {COLLECTION, "Time", TIME},   {TIME, "DataItem", ITEM},
        {GEOMETRY, "DataItem", ITEM}, {ATTRIBUTE, "DataItem", ITEM}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        if (rows[i].parent == parent && strcmp(rows[i].name, name) == 0)
            return rows[i].child;
    return OTHER;
}

static status begin_element(scan *x, const char *name, const char **attributes) {
    const element parent = x->depth ? x->nest[x->depth - 1] : OTHER;
    if (x->depth == 0 && strcmp(name, "Xdmf") != 0)
        return fault(x, ST_CORRUPT, "<%.40s>, expected <Xdmf>", name);
    if (x->depth == DEPTH_MAX)
        return fault(x, ST_CORRUPT, "more than %d elements in each other", DEPTH_MAX);
    element e = x->depth ? child_of(parent, name) : ROOT;
    status st = ST_OK;
    if (strcmp(name, "xi:include") == 0)
        return refuse(x, "the element", name);
    if (e != OTHER && find(attributes, "Reference", NULL))
        return refuse(x, "a Reference of", name);
    switch (e) {
    case GRID: st = on_grid(x, attributes, parent, &e); break;
    case TOPOLOGY: st = on_topology(x, attributes); break;
    case GEOMETRY: st = on_geometry(x, attributes); break;
    case ATTRIBUTE: st = on_attribute(x, attributes); break;
    case TIME: st = on_time(x, attributes, parent); break;
    case ITEM: st = on_item(x, attributes, parent); break;
    default: break;
    }
    x->nest[x->depth++] = e;
    return st;
}

static void XMLCALL handle_start(void *user, const char *name, const char **attributes) {
    scan *x = user;
    if (x->st == ST_OK)
        x->st = begin_element(x, name, attributes);
    if (x->st != ST_OK)
        XML_StopParser(x->parser, XML_FALSE);
}

static void XMLCALL handle_end(void *user, const char *name) {
    scan *x = user;
    (void)name;
    if (x->st != ST_OK)
        return;
    switch (x->nest[--x->depth]) {
    case ITEM: x->st = end_item(x, x->nest[x->depth - 1]); break;
    case ATTRIBUTE: x->st = end_attribute(x); break;
    case GRID: x->st = end_grid(x); break;
    default: break;
    }
    if (x->st != ST_OK)
        XML_StopParser(x->parser, XML_FALSE);
}

static void XMLCALL handle_text(void *user, const char *text, int length) {
    scan *x = user;
    const size_t more = (size_t)length;
    if (x->st != ST_OK || x->depth == 0 || x->nest[x->depth - 1] != ITEM)
        return;
    if (x->length + more >= TEXT_MAX)
        x->st = fault(x, ST_UNSUPPORTED, "an item of more than %d bytes", TEXT_MAX);
    else if (x->length + more >= x->room) {
        const size_t room = 2 * (x->length + more + 64);
        char *larger = mem_alloc(x->m, room);
        if (larger && x->length)
            memcpy(larger, x->text, x->length);
        if (larger) {
            mem_free(x->m, x->text);
            x->text = larger;
            x->room = room;
        } else
            x->st = ST_NOMEM;
    }
    if (x->st != ST_OK) {
        XML_StopParser(x->parser, XML_FALSE);
        return;
    }
    memcpy(x->text + x->length, text, more);
    x->length += more;
}

/* Refuse entities, which could grow without limit. XDMF files name a document type, but need no
 * entities. */
static void XMLCALL handle_entity(void *user, const char *name, int parameter, const char *value,
                                  int length, const char *base, const char *system,
                                  const char *public, const char *notation) {
    scan *x = user;
    (void)parameter, (void)value, (void)length, (void)base, (void)system, (void)public,
        (void)notation;
    x->st = fault(x, ST_UNSUPPORTED, "an entity, \"%.40s\"", name);
    XML_StopParser(x->parser, XML_FALSE);
}

/* ---- the file ---- */

static status parse_file(scan *x) {
    for (bool ended = false; !ended;) {
        const uint8_t *data;
        size_t size;
        status st = byte_stream_peek(x->s, 1, &data, &size);
        if (st != ST_OK)
            return st;
        ended = size == 0;
        enum XML_Status result = XML_Parse(x->parser, (const char *)data, (int)size, ended);
        byte_stream_take(x->s, size);
        if (x->st != ST_OK)
            return x->st;
        if (result != XML_STATUS_OK)
            return fault(x,
                         XML_GetErrorCode(x->parser) == XML_ERROR_NO_MEMORY ? ST_NOMEM : ST_CORRUPT,
                         "expected XML: %s", XML_ErrorString(XML_GetErrorCode(x->parser)));
    }
    return ST_OK;
}

/* Take the collection's times, where the grids have none of their own. */
static status take_list(scan *x) {
    xdmf_file *to = x->to;
    const double count = x->list_of_steps ? x->list[2] : (double)x->list_size;
    if (x->times == to->steps)
        return ST_OK;
    if (count != to->steps)
        return status_describe(ST_CORRUPT, "%s: %g times of %u grids", x->path, count, to->steps);
    for (uint32_t i = 0; i < to->steps; i++)
        to->times[i] = x->list_of_steps ? x->list[0] + i * x->list[1] : x->list[i];
    return ST_OK;
}

static status check_whole(scan *x) {
    xdmf_file *to = x->to;
    if (to->steps == 0)
        return status_describe(ST_CORRUPT, "%s: it has no grid", x->path);
    if (x->step >= to->steps)
        return status_describe(ST_USAGE, "%s: no step %u: there %s %u, counted from 0", x->path,
                               x->step, to->steps == 1 ? "is" : "are", to->steps);
    if (to->count == 0)
        return status_describe(ST_UNSUPPORTED, "%s: its grid has no attribute", x->path);
    if (x->times < to->steps && !x->list) {
        mem_free(x->m, to->times);
        to->times = NULL;
    }
    return x->list ? take_list(x) : ST_OK;
}

status xdmf_file_read(mem *m, const char *path, byte_stream *data, bool follow_links, uint32_t step,
                      xdmf_file *out) {
    scan x = {.m = m,
              .to = out,
              .path = path,
              .s = data,
              .follow_links = follow_links,
              .step = step,
              .parser = XML_ParserCreate(NULL)};
    *out = (xdmf_file){.m = m};
    if (!x.parser)
        return status_describe(ST_NOMEM, "%s: no memory to parse it", byte_stream_name(data));
    XML_SetUserData(x.parser, &x);
    XML_SetElementHandler(x.parser, handle_start, handle_end);
    XML_SetCharacterDataHandler(x.parser, handle_text);
    XML_SetEntityDeclHandler(x.parser, handle_entity);
    status st = parse_file(&x);
    if (st == ST_OK)
        st = check_whole(&x);
    drop_field(&x);
    mem_free(m, x.text);
    mem_free(m, x.list);
    XML_ParserFree(x.parser);
    return st;
}

void xdmf_file_release(xdmf_file *x) {
    for (size_t i = 0; i < x->count; i++) {
        mem_free(x->m, x->fields[i].name);
        mem_free(x->m, x->fields[i].file);
        mem_free(x->m, x->fields[i].inside);
    }
    for (int a = 0; a < 3; a++)
        mem_free(x->m, x->axis[a]);
    mem_free(x->m, x->fields);
    mem_free(x->m, x->times);
}
