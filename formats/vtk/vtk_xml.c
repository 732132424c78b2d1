#include "formats/vtk/vtk_xml.h"

#include <assert.h>
#include <expat.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/num.h"

enum { TAG_MAX = 1 << 20, DEPTH_MAX = 64 };
#define COUNT_MAX ((int64_t)1 << 47) /* times components: no overflow */

struct vtk_xml {
    mem *m;
    const char *path;
    byte_stream *s;
    const vtk_xml_reader *reader;
    void *user;
    XML_Parser parser;
    int nest[DEPTH_MAX];
    int depth;
    status st; /* the fault of a handler that stopped the parser */
    bool big_endian, head64;
    vtk_packing packing;
    bool uses_appended;    /* some array lies in the appended data */
    bool at_appended;      /* its element has been reached: no XML from there on */
    bool appended_base64;  /* its encoding */
    uint64_t appended_tag; /* the byte behind its start tag */
};

void *vtk_xml_user(const vtk_xml *x) {
    return x->user;
}

/* ---- faults ---- */

status vtk_xml_fault(const vtk_xml *x, status st, const char *fmt, ...) {
    char text[STATUS_TEXT_MAX];
    va_list args;
    va_start(args, fmt);
    vsnprintf(text, sizeof text, fmt, args);
    va_end(args);
    return status_describe(st, "%s: line %llu: %s", byte_stream_name(x->s),
                           (unsigned long long)XML_GetCurrentLineNumber(x->parser), text);
}

/* ---- attributes ---- */

const char *vtk_xml_attribute(const char **attributes, const char *name) {
    for (; *attributes; attributes += 2)
        if (strcmp(attributes[0], name) == 0)
            return attributes[1];
    return NULL;
}

status vtk_xml_count(const vtk_xml *x, const char **attributes, const char *name, int64_t absent,
                     int64_t least, uint64_t *out) {
    const char *text = vtk_xml_attribute(attributes, name);
    int64_t value = absent;
    if (!text && absent < 0)
        return vtk_xml_fault(x, ST_CORRUPT, "expected the attribute %s", name);
    while (text && (*text == ' ' || *text == '\t' || *text == '\n'))
        text++;
    if (text && num_int(text, "", least, COUNT_MAX, &value) != ST_OK)
        return vtk_xml_fault(x, ST_CORRUPT, "%s=\"%.40s\", expected a whole number from %lld on",
                             name, text, (long long)least);
    *out = (uint64_t)value;
    return ST_OK;
}

status vtk_xml_numbers(const vtk_xml *x, const char **attributes, const char *name, int count,
                       double *out, bool *found) {
    const char *text = vtk_xml_attribute(attributes, name);
    if (found)
        *found = text;
    if (text && num_doubles(text, name, " ", count, out) != ST_OK)
        return vtk_xml_fault(x, ST_CORRUPT, "%s=\"%.80s\", expected %d numbers", name, text, count);
    return ST_OK;
}

status vtk_xml_whole(const vtk_xml *x, const char **attributes, const char *name, int count,
                     int64_t lo, int64_t hi, int64_t *out) {
    double numbers[6];
    bool found, good = true;
    assert(count <= 6);
    status st = vtk_xml_numbers(x, attributes, name, count, numbers, &found);
    if (st == ST_OK && !found)
        st = vtk_xml_fault(x, ST_CORRUPT, "expected the attribute %s", name);
    for (int i = 0; st == ST_OK && i < count; i++) {
        good = good && numbers[i] >= (double)lo && numbers[i] <= (double)hi &&
               numbers[i] == rint(numbers[i]);
        out[i] = good ? (int64_t)numbers[i] : 0;
    }
    return st == ST_OK && !good
               ? vtk_xml_fault(
                     x, ST_CORRUPT, "%s=\"%.80s\", expected %d whole numbers in %lld .. %lld", name,
                     vtk_xml_attribute(attributes, name), count, (long long)lo, (long long)hi)
               : st;
}

status vtk_xml_extent(const vtk_xml *x, const char **attributes, const char *name,
                      vtk_extent *out) {
    int64_t e[6];
    status st = vtk_xml_whole(x, attributes, name, 6, -VTK_EXTENT_MAX, VTK_EXTENT_MAX, e);
    for (int a = 0; st == ST_OK && a < 3; a++) {
        out->lo[a] = e[2 * a];
        out->hi[a] = e[2 * a + 1];
    }
    return st;
}

/* Returns the index of a value among the words: 0 when there is no value, -1 for any other word. */
static int choose_word(const char *value, const char *const *words) {
    if (!value)
        return 0;
    for (int i = 0; words[i]; i++)
        if (strcmp(value, words[i]) == 0)
            return i;
    return -1;
}

/* ---- elements ---- */

static status on_file(vtk_xml *x, const char **attributes) {
    static const char *const orders[] = {"LittleEndian", "BigEndian", NULL};
    static const char *const heads[] = {"UInt32", "UInt64", NULL};
    static const char *const packings[] = {[VTK_PLAIN] = "",
                                           [VTK_ZLIB] = "vtkZLibDataCompressor",
                                           [VTK_LZ4] = "vtkLZ4DataCompressor",
                                           [VTK_LZMA] = "vtkLZMADataCompressor",
                                           NULL};
    const char *type = vtk_xml_attribute(attributes, "type");
    const char *order = vtk_xml_attribute(attributes, "byte_order");
    const char *head = vtk_xml_attribute(attributes, "header_type");
    const char *packing = vtk_xml_attribute(attributes, "compressor");
    if (!type || strcmp(type, x->reader->type) != 0)
        return vtk_xml_fault(x, type ? ST_UNSUPPORTED : ST_CORRUPT,
                             "a VTKFile of type \"%.40s\"; %s is supported", type ? type : "",
                             x->reader->type);
    int big = choose_word(order, orders), wide = choose_word(head, heads);
    int packed = choose_word(packing, packings);
    if (big < 0)
        return vtk_xml_fault(x, ST_CORRUPT,
                             "byte_order=\"%.40s\", expected LittleEndian or BigEndian", order);
    if (wide < 0)
        return vtk_xml_fault(x, ST_CORRUPT, "header_type=\"%.40s\", expected UInt32 or UInt64",
                             head);
    if (packed < 0)
        return vtk_xml_fault(x, ST_UNSUPPORTED,
                             "compressor \"%.40s\"; those of zlib, LZ4 and LZMA are supported",
                             packing);
    x->big_endian = big;
    x->head64 = wide;
    x->packing = (vtk_packing)packed;
    return ST_OK;
}

static status parse_type(const vtk_xml *x, const char *name, vtk_type *out) {
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
    return vtk_xml_fault(x, ST_CORRUPT,
                         "type=\"%.40s\", expected Float32, Int64 or another of VTK's",
                         name ? name : "");
}

/* Returns the byte behind the tag that is being handled. */
static uint64_t behind_tag(const vtk_xml *x) {
    return (uint64_t)XML_GetCurrentByteIndex(x->parser) +
           (uint64_t)XML_GetCurrentByteCount(x->parser);
}

/* Find where an array's data start: behind the start tag, or at an offset in the appended data,
 * whose place is added later. */
static status parse_format(vtk_xml *x, const char **attributes, vtk_array *a) {
    static const char *const formats[] = {"ascii", "binary", "appended", NULL};
    const char *name = vtk_xml_attribute(attributes, "format");
    int format = choose_word(name, formats);
    if (format < 0)
        return vtk_xml_fault(x, ST_CORRUPT, "format=\"%.40s\", expected ascii, binary or appended",
                             name);
    a->at = behind_tag(x);
    a->coding = (vtk_coding[]){VTK_TEXT, VTK_BASE64, VTK_RAW}[format];
    if (format != 2)
        return ST_OK;
    x->uses_appended = true;
    return vtk_xml_count(x, attributes, "offset", -1, 0, &a->at);
}

static status on_array(vtk_xml *x, int parent, const char **attributes) {
    uint64_t components = 1;
    const char *name = vtk_xml_attribute(attributes, "Name");
    vtk_array a = {.path = x->path,
                   .role = "array",
                   .big_endian = x->big_endian,
                   .head64 = x->head64,
                   .packing = x->packing,
                   .line = (uint64_t)XML_GetCurrentLineNumber(x->parser)};
    if (parent < VTK_XML_OWN)
        return ST_OK; /* an array of the file as a whole */
    status st = parse_type(x, vtk_xml_attribute(attributes, "type"), &a.type);
    if (st == ST_OK)
        st = vtk_xml_count(x, attributes, "NumberOfComponents", 1, 0, &components);
    if (st == ST_OK && components > UINT32_MAX)
        st = vtk_xml_fault(x, ST_CORRUPT, "%llu components", (unsigned long long)components);
    a.components = components ? (uint32_t)components : 1; /* 0 by old writers: not given */
    if (st == ST_OK)
        st = parse_format(x, attributes, &a);
    return st == ST_OK ? x->reader->array(x, parent, name ? name : "", &a) : st;
}

/* Stop at the appended data: what follows is no longer XML, or not ours to parse. */
static status on_appended(vtk_xml *x, const char **attributes) {
    static const char *const encodings[] = {"base64", "raw", NULL};
    const char *name = vtk_xml_attribute(attributes, "encoding");
    int encoding = choose_word(name, encodings);
    if (encoding < 0)
        return vtk_xml_fault(x, ST_CORRUPT, "encoding=\"%.40s\", expected raw or base64", name);
    x->at_appended = true;
    x->appended_base64 = encoding == 0;
    x->appended_tag = behind_tag(x);
    return ST_OK;
}

/* Find the row of an element; a row without a name when there is none. */
static const vtk_xml_element *find_element(const vtk_xml *x, int parent, const char *name) {
    const vtk_xml_element *e = x->reader->elements;
    while (e->name && (e->parent != parent || strcmp(e->name, name) != 0))
        e++;
    return e;
}

static status start_element(vtk_xml *x, const char *name, const char **attributes) {
    if (x->depth == 0) {
        x->nest[x->depth++] = VTK_XML_FILE;
        return strcmp(name, "VTKFile") == 0
                   ? on_file(x, attributes)
                   : vtk_xml_fault(x, ST_CORRUPT, "<%.40s>, expected <VTKFile>", name);
    }
    if (x->depth == DEPTH_MAX)
        return vtk_xml_fault(x, ST_CORRUPT, "more than %d elements in each other", DEPTH_MAX);
    const int parent = x->nest[x->depth - 1];
    const vtk_xml_element *e = find_element(x, parent, name);
    x->nest[x->depth++] = e->name ? e->element : VTK_XML_OTHER;
    if (e->name)
        return e->start ? e->start(x, attributes) : ST_OK;
    if (strcmp(name, "DataArray") == 0 || strcmp(name, "Array") == 0)
        return on_array(x, parent, attributes);
    if (parent == VTK_XML_FILE && strcmp(name, "AppendedData") == 0)
        return on_appended(x, attributes);
    return ST_OK;
}

static void XMLCALL handle_start(void *user, const char *name, const char **attributes) {
    vtk_xml *x = user;
    if (x->st == ST_OK && !x->at_appended)
        x->st = start_element(x, name, attributes);
    if (x->st != ST_OK || x->at_appended)
        XML_StopParser(x->parser, XML_FALSE);
}

static void XMLCALL handle_end(void *user, const char *name) {
    (void)name;
    ((vtk_xml *)user)->depth--;
}

/* Refuse a document type, which no VTK file has: entities in it could grow without limit. */
static void XMLCALL handle_doctype(void *user, const char *name, const char *system,
                                   const char *public, int internal) {
    vtk_xml *x = user;
    (void)name, (void)system, (void)public, (void)internal;
    x->st = vtk_xml_fault(x, ST_UNSUPPORTED, "a document type declaration");
    XML_StopParser(x->parser, XML_FALSE);
}

/* ---- the file ---- */

static status parse_failed(const vtk_xml *x) {
    enum XML_Error error = XML_GetErrorCode(x->parser);
    if (error == XML_ERROR_NO_MEMORY)
        return status_describe(ST_NOMEM, "%s: no memory to parse it", byte_stream_name(x->s));
    return vtk_xml_fault(x, ST_CORRUPT, "column %llu: expected XML: %s",
                         (unsigned long long)XML_GetCurrentColumnNumber(x->parser),
                         XML_ErrorString(error));
}

/* Feed the parser until the file ends, or the appended data starts. */
static status parse_file(vtk_xml *x) {
    uint64_t fed = 0;
    for (bool ended = false; !ended && !x->at_appended;) {
        const uint8_t *data;
        size_t size;
        status st = byte_stream_peek(x->s, 1, &data, &size);
        if (st != ST_OK)
            return st;
        ended = size == 0;
        enum XML_Status result = XML_Parse(x->parser, (const char *)data, (int)size, ended);
        byte_stream_take(x->s, size);
        fed += size;
        if (x->st != ST_OK)
            return x->st;
        if (result != XML_STATUS_OK && !x->at_appended)
            return parse_failed(x);
        XML_Index at = XML_GetCurrentByteIndex(x->parser);
        if (!ended && at >= 0 && fed - (uint64_t)at > TAG_MAX)
            return vtk_xml_fault(x, ST_CORRUPT, "a tag of more than %d bytes", TAG_MAX);
    }
    return ST_OK;
}

/* Find the first '_', behind which the appended data start. */
static status find_underscore(const vtk_xml *x, uint64_t *at) {
    byte_stream *from;
    uint8_t c = ' ';
    size_t got = 1;
    status st = byte_stream_open(x->m, x->path, &from);
    if (st != ST_OK)
        return st;
    st = byte_stream_skip(from, x->appended_tag);
    while (st == ST_OK && got > 0 && (c == ' ' || (c >= '\t' && c <= '\r')))
        st = byte_stream_read(from, &c, 1, &got);
    *at = byte_stream_position(from);
    byte_stream_close(from);
    if (st == ST_OK && (got == 0 || c != '_'))
        st = status_describe(ST_CORRUPT, "%s: byte %llu: expected the '_' of the appended data",
                             x->path, (unsigned long long)(*at - got));
    return st;
}

static status find_appended(const vtk_xml *x, vtk_appended *out) {
    *out = (vtk_appended){.base64 = x->appended_base64};
    if (!x->uses_appended)
        return ST_OK;
    if (!x->at_appended)
        return status_describe(ST_CORRUPT, "%s: ends at byte %llu without AppendedData",
                               byte_stream_name(x->s),
                               (unsigned long long)byte_stream_position(x->s));
    return find_underscore(x, &out->at);
}

status vtk_xml_scan(mem *m, const char *path, byte_stream *data, const vtk_xml_reader *r,
                    void *user, vtk_appended *out) {
    vtk_xml x = {.m = m, .path = path, .s = data, .reader = r, .user = user};
    x.parser = XML_ParserCreate(NULL);
    if (!x.parser)
        return status_describe(ST_NOMEM, "%s: no memory to parse it", byte_stream_name(data));
    XML_SetUserData(x.parser, &x);
    XML_SetElementHandler(x.parser, handle_start, handle_end);
    XML_SetStartDoctypeDeclHandler(x.parser, handle_doctype);
    status st = parse_file(&x);
    if (st == ST_OK)
        st = find_appended(&x, out);
    XML_ParserFree(x.parser);
    return st;
}

void vtk_xml_locate(const vtk_appended *p, vtk_array *a) {
    if (a->type == VTK_ABSENT || a->coding != VTK_RAW)
        return;
    a->at += p->at;
    a->coding = p->base64 ? VTK_BASE64 : VTK_RAW;
}

void vtk_xml_locate_fields(const vtk_appended *p, const vtk_fields *f) {
    for (int o = 0; o < VTK_OWNERS; o++)
        for (size_t i = 0; i < f->count[o]; i++)
            vtk_xml_locate(p, &f->items[o][i]);
}

/* ---- recognising ---- */

bool vtk_xml_type(const uint8_t *start, size_t size, char type[VTK_XML_TYPE_MAX]) {
    static const char tag[] = "<VTKFile", name[] = "type";
    *type = 0;
    const char *at = memmem(start, size, tag, sizeof tag - 1);
    if (!at)
        return false;
    const char *file_end = (const char *)start + size;
    const char *end = memchr(at, '>', (size_t)(file_end - at));
    end = end ? end : file_end;
    at += sizeof tag - 1;
    /* Find the attribute of that name: a blank before it, and no more letters behind it. */
    while ((at = memmem(at, (size_t)(end - at), name, sizeof name - 1))) {
        const bool begins = strchr(" \t\r\n", at[-1]) != NULL;
        at += sizeof name - 1;
        const char *value = at;
        while (value < end && strchr(" \t\r\n=", *value))
            value++;
        if (!begins || value == at || value == end || (*value != '"' && *value != '\''))
            continue;
        const char *close = memchr(value + 1, *value, (size_t)(end - value - 1));
        const size_t length = close ? (size_t)(close - value - 1) : VTK_XML_TYPE_MAX;
        if (length >= VTK_XML_TYPE_MAX)
            return false;
        memcpy(type, value + 1, length);
        type[length] = 0;
        return length > 0;
    }
    return false;
}
