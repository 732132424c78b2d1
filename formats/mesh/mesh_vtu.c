#include "formats/mesh/mesh_vtu.h"

#include <expat.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/num.h"
#include "formats/base/text.h"
#include "formats/input/foreign.h"
#include "formats/mesh/vtk_cursor.h"
#include "formats/mesh/vtk_unstructured.h"

enum { TAG_MAX = 1 << 20, DEPTH_MAX = 64 };
#define COUNT_MAX ((int64_t)1 << 47) /* times components: no overflow */

/* What an element is to us; its children are read accordingly. */
typedef enum element {
    ELEMENT_OTHER,
    ELEMENT_FILE,   /* VTKFile */
    ELEMENT_GRID,   /* UnstructuredGrid */
    ELEMENT_PIECE,  /* Piece */
    ELEMENT_POINTS, /* Points */
    ELEMENT_CELLS,  /* Cells */
    ELEMENT_POINT_DATA,
    ELEMENT_CELL_DATA,
} element;

/* The pass over the XML that finds the arrays. */
typedef struct scan {
    vtk_unstructured *g;
    vtk_piece *piece;
    byte_stream *s;
    XML_Parser parser;
    element nest[DEPTH_MAX];
    int depth;
    status st; /* of a handler that stopped the parser */
    bool big_endian, head64, zlib;
    bool uses_appended;    /* some array lies in the appended data */
    bool at_appended;      /* its element was reached: no XML from there */
    bool appended_base64;  /* its encoding */
    uint64_t appended_tag; /* the byte behind its start tag */
} scan;

/* ---- faults ---- */

static unsigned long long here(const scan *s) {
    return (unsigned long long)XML_GetCurrentLineNumber(s->parser);
}

static status fault(const scan *s, status st, const char *fmt, ...)
    __attribute__((format(printf, 3, 4)));

static status fault(const scan *s, status st, const char *fmt, ...) {
    char text[STATUS_TEXT_MAX];
    va_list args;
    va_start(args, fmt);
    vsnprintf(text, sizeof text, fmt, args);
    va_end(args);
    return status_describe(st, "%s: line %llu: %s", byte_stream_name(s->s), here(s), text);
}

/* ---- attributes ---- */

static const char *find_attribute(const char **attributes, const char *name) {
    for (; *attributes; attributes += 2)
        if (strcmp(attributes[0], name) == 0)
            return attributes[1];
    return NULL;
}

/* A whole number; `absent` when it is not there, which is a fault for a negative one. */
static status count_attribute(const scan *s, const char **attributes, const char *name,
                              int64_t absent, int64_t least, uint64_t *out) {
    const char *text = find_attribute(attributes, name);
    int64_t value = absent;
    if (!text && absent < 0)
        return fault(s, ST_CORRUPT, "expected the attribute %s", name);
    while (text && (*text == ' ' || *text == '\t' || *text == '\n'))
        text++;
    if (text && num_int(text, "", least, COUNT_MAX, &value) != ST_OK)
        return fault(s, ST_CORRUPT, "%s=\"%.40s\", expected a whole number from %lld on", name,
                     text, (long long)least);
    *out = (uint64_t)value;
    return ST_OK;
}

/* Which of the words a value is; the first when there is none, -1 for any other. */
static int choose_word(const char *value, const char *const *words) {
    if (!value)
        return 0;
    for (int i = 0; words[i]; i++)
        if (strcmp(value, words[i]) == 0)
            return i;
    return -1;
}

/* ---- elements ---- */

static status on_file(scan *s, const char **attributes) {
    static const char *const orders[] = {"LittleEndian", "BigEndian", NULL};
    static const char *const heads[] = {"UInt32", "UInt64", NULL};
    static const char *const packers[] = {"", "vtkZLibDataCompressor", NULL};
    const char *type = find_attribute(attributes, "type");
    const char *order = find_attribute(attributes, "byte_order");
    const char *head = find_attribute(attributes, "header_type");
    const char *packer = find_attribute(attributes, "compressor");
    if (!type || strcmp(type, "UnstructuredGrid") != 0)
        return fault(s, type ? ST_UNSUPPORTED : ST_CORRUPT,
                     "a VTKFile of type \"%.40s\"; UnstructuredGrid is supported",
                     type ? type : "");
    int big = choose_word(order, orders), wide = choose_word(head, heads);
    int packed = choose_word(packer, packers);
    if (big < 0)
        return fault(s, ST_CORRUPT, "byte_order=\"%.40s\", expected LittleEndian or BigEndian",
                     order);
    if (wide < 0)
        return fault(s, ST_CORRUPT, "header_type=\"%.40s\", expected UInt32 or UInt64", head);
    if (packed < 0)
        return fault(s, ST_UNSUPPORTED, "compressor \"%.40s\"; vtkZLibDataCompressor is supported",
                     packer);
    s->big_endian = big;
    s->head64 = wide;
    s->zlib = packed;
    return ST_OK;
}

static status on_piece(scan *s, const char **attributes) {
    status st = vtk_unstructured_add_piece(s->g, &s->piece);
    if (st == ST_OK)
        st = count_attribute(s, attributes, "NumberOfPoints", -1, 0, &s->piece->points);
    if (st == ST_OK)
        st = count_attribute(s, attributes, "NumberOfCells", -1, 0, &s->piece->cells.count);
    if (st == ST_OK)
        s->piece->cells.ids_size = VTK_CURSOR_ANY;
    return st;
}

static status parse_type(const scan *s, const char *name, vtk_type *out) {
    static const struct {
        const char *name;
        vtk_type type;
    } types[] = {
        {"Int8", VTK_I8},     {"UInt8", VTK_U8},    {"Int16", VTK_I16},     {"UInt16", VTK_U16},
        {"Int32", VTK_I32},   {"UInt32", VTK_U32},  {"Int64", VTK_I64},     {"UInt64", VTK_U64},
        {"Float32", VTK_F32}, {"Float64", VTK_F64}, {"String", VTK_STRING}, {"Bit", VTK_BIT},
    };
    for (size_t i = 0; name && i < sizeof types / sizeof *types; i++)
        if (strcmp(name, types[i].name) == 0) {
            *out = types[i].type;
            return ST_OK;
        }
    return fault(s, ST_CORRUPT, "type=\"%.40s\", expected Float32, Int64 or another of VTK's",
                 name ? name : "");
}

/* Behind the start tag, or at an offset in the appended data, which is added when that is found. */
static status parse_format(scan *s, const char **attributes, vtk_array *a) {
    static const char *const formats[] = {"ascii", "binary", "appended", NULL};
    const char *name = find_attribute(attributes, "format");
    int format = choose_word(name, formats);
    if (format < 0)
        return fault(s, ST_CORRUPT, "format=\"%.40s\", expected ascii, binary or appended", name);
    a->at =
        (uint64_t)XML_GetCurrentByteIndex(s->parser) + (uint64_t)XML_GetCurrentByteCount(s->parser);
    a->coding = (vtk_coding[]){VTK_TEXT, VTK_BASE64, VTK_RAW}[format];
    if (format != 2)
        return ST_OK;
    s->uses_appended = true;
    return count_attribute(s, attributes, "offset", -1, 0, &a->at);
}

static status parse_array(scan *s, const char **attributes, vtk_array *a) {
    uint64_t components = 1;
    *a = (vtk_array){.path = s->g->source->path,
                     .role = "array",
                     .big_endian = s->big_endian,
                     .head64 = s->head64,
                     .zlib = s->zlib,
                     .line = here(s)};
    status st = parse_type(s, find_attribute(attributes, "type"), &a->type);
    if (st == ST_OK)
        st = count_attribute(s, attributes, "NumberOfComponents", 1, 0, &components);
    if (st == ST_OK && components > UINT32_MAX)
        st = fault(s, ST_CORRUPT, "%llu components", (unsigned long long)components);
    a->components = components ? (uint32_t)components : 1; /* old writers mean none by 0 */
    return st == ST_OK ? parse_format(s, attributes, a) : st;
}

static status on_cells_array(scan *s, const char *name, const vtk_array *a) {
    static const char *const names[] = {"", "connectivity", "offsets", "types", NULL};
    vtk_cells_source *c = &s->piece->cells;
    vtk_array *const to[] = {NULL, &c->ids, &c->offsets, &c->types};
    int which = choose_word(name, names);
    if (which <= 0)
        return ST_OK; /* faces of polyhedra, which are refused by the cells' types */
    if (to[which]->type != VTK_ABSENT)
        return fault(s, ST_CORRUPT, "%s comes twice", name);
    *to[which] = *a;
    to[which]->role = names[which];
    return ST_OK;
}

static status on_array(scan *s, element parent, const char **attributes) {
    vtk_array a;
    const char *name = find_attribute(attributes, "Name");
    if (parent < ELEMENT_POINTS)
        return ST_OK; /* of the file as a whole */
    status st = parse_array(s, attributes, &a);
    if (st != ST_OK)
        return st;
    if (parent == ELEMENT_CELLS)
        return on_cells_array(s, name, &a);
    if (parent == ELEMENT_POINTS) {
        if (s->piece->position.type != VTK_ABSENT)
            return fault(s, ST_CORRUPT, "the points come twice");
        s->piece->position = a;
        s->piece->position.role = "points";
        return ST_OK;
    }
    a.name = mem_copy_text(s->g->m, name ? name : "");
    if (!a.name)
        return ST_NOMEM;
    return vtk_unstructured_add_field(
        s->g, s->piece, parent == ELEMENT_POINT_DATA ? VTK_OF_POINTS : VTK_OF_CELLS, &a);
}

/* Whatever follows is no XML any more, or not ours to parse. */
static status on_appended(scan *s, const char **attributes) {
    static const char *const encodings[] = {"base64", "raw", NULL};
    const char *name = find_attribute(attributes, "encoding");
    int encoding = choose_word(name, encodings);
    if (encoding < 0)
        return fault(s, ST_CORRUPT, "encoding=\"%.40s\", expected raw or base64", name);
    s->at_appended = true;
    s->appended_base64 = encoding == 0;
    s->appended_tag =
        (uint64_t)XML_GetCurrentByteIndex(s->parser) + (uint64_t)XML_GetCurrentByteCount(s->parser);
    return ST_OK;
}

static element child_element(element parent, const char *name) {
    static const struct {
        element parent, child;
        const char *name;
    } nests[] = {
        {ELEMENT_FILE, ELEMENT_GRID, "UnstructuredGrid"},
        {ELEMENT_GRID, ELEMENT_PIECE, "Piece"},
        {ELEMENT_PIECE, ELEMENT_POINTS, "Points"},
        {ELEMENT_PIECE, ELEMENT_CELLS, "Cells"},
        {ELEMENT_PIECE, ELEMENT_POINT_DATA, "PointData"},
        {ELEMENT_PIECE, ELEMENT_CELL_DATA, "CellData"},
    };
    for (size_t i = 0; i < sizeof nests / sizeof *nests; i++)
        if (nests[i].parent == parent && strcmp(nests[i].name, name) == 0)
            return nests[i].child;
    return ELEMENT_OTHER;
}

static status start_element(scan *s, const char *name, const char **attributes) {
    if (s->depth == 0) {
        s->nest[s->depth++] = ELEMENT_FILE;
        return strcmp(name, "VTKFile") == 0
                   ? on_file(s, attributes)
                   : fault(s, ST_CORRUPT, "<%.40s>, expected <VTKFile>", name);
    }
    if (s->depth == DEPTH_MAX)
        return fault(s, ST_CORRUPT, "more than %d elements in each other", DEPTH_MAX);
    element parent = s->nest[s->depth - 1], inner = child_element(parent, name);
    s->nest[s->depth++] = inner;
    if (inner == ELEMENT_PIECE)
        return on_piece(s, attributes);
    if (strcmp(name, "DataArray") == 0 || strcmp(name, "Array") == 0)
        return on_array(s, parent, attributes);
    if (parent == ELEMENT_FILE && strcmp(name, "AppendedData") == 0)
        return on_appended(s, attributes);
    return ST_OK;
}

static void XMLCALL handle_start(void *user, const char *name, const char **attributes) {
    scan *s = user;
    if (s->st == ST_OK && !s->at_appended)
        s->st = start_element(s, name, attributes);
    if (s->st != ST_OK || s->at_appended)
        XML_StopParser(s->parser, XML_FALSE);
}

static void XMLCALL handle_end(void *user, const char *name) {
    (void)name;
    ((scan *)user)->depth--;
}

/* No file of VTK has a document type; entities in one could grow without limit. */
static void XMLCALL handle_doctype(void *user, const char *name, const char *system,
                                   const char *public, int internal) {
    scan *s = user;
    (void)name, (void)system, (void)public, (void)internal;
    s->st = fault(s, ST_UNSUPPORTED, "a document type declaration");
    XML_StopParser(s->parser, XML_FALSE);
}

/* ---- the file ---- */

static status parse_failed(const scan *s) {
    enum XML_Error error = XML_GetErrorCode(s->parser);
    if (error == XML_ERROR_NO_MEMORY)
        return status_describe(ST_NOMEM, "%s: no memory to parse it", byte_stream_name(s->s));
    return fault(s, ST_CORRUPT, "column %llu: expected XML: %s",
                 (unsigned long long)XML_GetCurrentColumnNumber(s->parser), XML_ErrorString(error));
}

/* Feed the parser until the file ends, or the appended data starts. */
static status parse_file(scan *s) {
    uint64_t fed = 0;
    for (bool ended = false; !ended && !s->at_appended;) {
        const uint8_t *data;
        size_t size;
        status st = byte_stream_peek(s->s, 1, &data, &size);
        if (st != ST_OK)
            return st;
        ended = size == 0;
        enum XML_Status result = XML_Parse(s->parser, (const char *)data, (int)size, ended);
        byte_stream_take(s->s, size);
        fed += size;
        if (s->st != ST_OK)
            return s->st;
        if (result != XML_STATUS_OK && !s->at_appended)
            return parse_failed(s);
        XML_Index at = XML_GetCurrentByteIndex(s->parser);
        if (!ended && at >= 0 && fed - (uint64_t)at > TAG_MAX)
            return fault(s, ST_CORRUPT, "a tag of more than %d bytes", TAG_MAX);
    }
    return ST_OK;
}

/* The appended data start behind the first '_'. */
static status find_appended(const scan *s, uint64_t *at) {
    byte_stream *from;
    uint8_t c = ' ';
    size_t got = 1;
    status st = byte_stream_open(s->g->m, s->g->source->path, &from);
    if (st != ST_OK)
        return st;
    st = byte_stream_skip(from, s->appended_tag);
    while (st == ST_OK && got > 0 && (c == ' ' || (c >= '\t' && c <= '\r')))
        st = byte_stream_read(from, &c, 1, &got);
    *at = byte_stream_position(from);
    byte_stream_close(from);
    if (st == ST_OK && (got == 0 || c != '_'))
        st = status_describe(ST_CORRUPT, "%s: byte %llu: expected the '_' of the appended data",
                             s->g->source->path, (unsigned long long)(*at - got));
    return st;
}

static void place_array(const scan *s, uint64_t base, vtk_array *a) {
    if (a->type == VTK_ABSENT || a->coding != VTK_RAW)
        return;
    a->at += base;
    a->coding = s->appended_base64 ? VTK_BASE64 : VTK_RAW;
}

/* Appended arrays know their offsets only: add where the data start. */
static status place_appended(scan *s) {
    uint64_t base;
    if (!s->uses_appended)
        return ST_OK;
    if (!s->at_appended)
        return status_describe(ST_CORRUPT, "%s: ends at byte %llu without AppendedData",
                               byte_stream_name(s->s),
                               (unsigned long long)byte_stream_position(s->s));
    status st = find_appended(s, &base);
    for (size_t i = 0; st == ST_OK && i < s->g->count; i++) {
        vtk_piece *p = &s->g->pieces[i];
        place_array(s, base, &p->position);
        place_array(s, base, &p->cells.ids);
        place_array(s, base, &p->cells.offsets);
        place_array(s, base, &p->cells.types);
        for (int o = 0; o < VTK_OWNERS; o++)
            for (size_t f = 0; f < p->count[o]; f++)
                place_array(s, base, &p->fields[o][f]);
    }
    return st;
}

/* Offsets make a cell's points; without them the ids would be read in the legacy form. */
static status check_cells(const scan *s) {
    for (size_t i = 0; i < s->g->count; i++) {
        const vtk_cells_source *c = &s->g->pieces[i].cells;
        if (c->count > 0 && c->offsets.type == VTK_ABSENT)
            return status_describe(ST_CORRUPT, "%s: piece %zu: expected the offsets of its cells",
                                   s->g->source->path, i + 1);
    }
    if (s->g->count == 0)
        return status_describe(ST_CORRUPT, "%s: expected a Piece in an UnstructuredGrid",
                               s->g->source->path);
    return ST_OK;
}

static status scan_file(vtk_unstructured *g, byte_stream *data) {
    scan s = {.g = g, .s = data, .parser = XML_ParserCreate(NULL)};
    if (!s.parser)
        return status_describe(ST_NOMEM, "%s: no memory to parse it", byte_stream_name(data));
    XML_SetUserData(s.parser, &s);
    XML_SetElementHandler(s.parser, handle_start, handle_end);
    XML_SetStartDoctypeDeclHandler(s.parser, handle_doctype);
    status st = parse_file(&s);
    if (st == ST_OK)
        st = place_appended(&s);
    if (st == ST_OK)
        st = check_cells(&s);
    XML_ParserFree(s.parser);
    return st;
}

/* ---- the reader ---- */

static bool known(const char *path, const uint8_t *start, size_t size) {
    static const char tag[] = "<VTKFile";
    return (memmem(start, size < 1024 ? size : 1024, tag, sizeof tag - 1) ||
            text_ends_in(path, ".vtu")) &&
           !foreign_is_other_vtk(start, size);
}

static status open_file(mesh_source *source, void **state) {
    return vtk_unstructured_open(source, scan_file, state);
}

const mesh_reader mesh_vtu_reader = {
    .format = "VTU",
    .known = known,
    .open = open_file,
    .read = vtk_unstructured_read,
    .close = vtk_unstructured_close,
    .fields = vtk_unstructured_fields,
};
