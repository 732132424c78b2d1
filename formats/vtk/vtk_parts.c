#include "formats/vtk/vtk_parts.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "formats/base/file.h"
#include "formats/base/name_list.h"
#include "formats/input/named_file.h"
#include "formats/vtk/vtk_xml.h"

/* Our kinds of elements. How an element's children are read depends on its kind. */
enum { ELEMENT_LIST = VTK_XML_OWN, ELEMENT_FILE };

enum { PEEK = 4096, PARTS_MAX = 1 << 20 };

typedef struct scan {
    mem *m;
    const char *path; /* path of the file that names the others */
    bool follow_links;
    vtk_parts *to;
} scan;

/* ---- kinds ---- */

static const struct {
    const char *type, *suffixes; /* each with a blank behind */
    vtk_parts_kind kind;
} kinds[] = {
    {"PUnstructuredGrid", ".pvtu ", VTK_PARTS_PIECES},
    {"vtkMultiBlockDataSet", ".vtm .vtmb ", VTK_PARTS_BLOCKS},
    {"Collection", ".pvd ", VTK_PARTS_COLLECTION},
};

enum { KINDS = sizeof kinds / sizeof *kinds };

/* Returns whether a name ends in one of the suffixes, each with a blank behind. */
static bool has_suffix(const char *name, size_t length, const char *suffixes) {
    for (const char *at = suffixes; *at; at += strcspn(at, " ") + 1) {
        const size_t size = strcspn(at, " ");
        if (length > size && strncasecmp(name + length - size, at, size) == 0)
            return true;
    }
    return false;
}

vtk_parts_kind vtk_parts_find_kind(const char *path, const uint8_t *start, size_t size) {
    char type[VTK_XML_TYPE_MAX];
    const bool says = vtk_xml_type(start, size, type);
    for (int i = 0; i < KINDS; i++)
        if (says ? strcmp(type, kinds[i].type) == 0
                 : has_suffix(path, strlen(path), kinds[i].suffixes))
            return kinds[i].kind;
    return VTK_PARTS_NONE;
}

bool vtk_parts_begin_with(const uint8_t *start, size_t size, const char *suffixes) {
    static const char word[] = "file=";
    const char *end = (const char *)start + size, *at = memmem(start, size, word, sizeof word - 1);
    if (!at || (at += sizeof word - 1) >= end)
        return false;
    const char *close = memchr(at + 1, *at, (size_t)(end - at - 1));
    return close && has_suffix(at + 1, (size_t)(close - at - 1), suffixes);
}

bool vtk_parts_are_grids(const uint8_t *start, size_t size) {
    return vtk_parts_begin_with(start, size, ".vti .vtr .vts .pvti .pvtr .pvts ");
}

/* ---- elements ---- */

/* Check that a file is there, and count it as an input from now on, though only another step may be
 * read. */
static status look_at(const vtk_xml *x, const char *path) {
    const scan *s = vtk_xml_user(x);
    file *f = NULL;
    char why[STATUS_TEXT_MAX];
    status st = file_open(s->m, path, &f);
    file_close(f);
    if (st != ST_IO)
        return st;
    snprintf(why, sizeof why, "%s", status_text());
    return vtk_xml_fault(x, st, "the file that it names: %s", why);
}

static status add_part(vtk_xml *x, const char *name, double time) {
    scan *s = vtk_xml_user(x);
    vtk_parts *p = s->to;
    char *path = NULL;
    if (p->count == PARTS_MAX)
        return vtk_xml_fault(x, ST_UNSUPPORTED, "more than %d files", PARTS_MAX);
    status st = mem_grow(s->m, &p->items, sizeof *p->items, p->count, 16, &p->room);
    if (st == ST_OK)
        st = named_file_find(s->m, s->path, name, s->follow_links, &path);
    if (st != ST_OK)
        return st;
    st = look_at(x, path);
    if (st != ST_OK) {
        mem_free(s->m, path);
        return st;
    }
    p->items[p->count] = (vtk_part){path, time, p->count};
    p->count++;
    return ST_OK;
}

static status on_piece(vtk_xml *x, const char **attributes) {
    const char *name = vtk_xml_attribute(attributes, "Source");
    return name ? add_part(x, name, 0)
                : vtk_xml_fault(x, ST_CORRUPT, "expected the attribute Source");
}

/* A block without a file is empty. */
static status on_data_set(vtk_xml *x, const char **attributes) {
    const scan *s = vtk_xml_user(x);
    const char *name = vtk_xml_attribute(attributes, "file");
    double time = 0;
    status st = s->to->kind == VTK_PARTS_COLLECTION
                    ? vtk_xml_numbers(x, attributes, "timestep", 1, &time, NULL)
                    : ST_OK;
    if (st == ST_OK && !isfinite(time))
        st = vtk_xml_fault(x, ST_CORRUPT, "timestep: expected a finite number");
    if (st != ST_OK || (name && *name))
        return st == ST_OK ? add_part(x, name, time) : st;
    return s->to->kind == VTK_PARTS_COLLECTION
               ? vtk_xml_fault(x, ST_CORRUPT, "expected the attribute file")
               : ST_OK;
}

static status on_array(vtk_xml *x, int element, const char *name, const vtk_array *a) {
    (void)x, (void)element, (void)name, (void)a;
    return ST_OK;
}

static const vtk_xml_element elements[] = {
    {VTK_XML_FILE, "PUnstructuredGrid", ELEMENT_LIST, NULL},
    {VTK_XML_FILE, "vtkMultiBlockDataSet", ELEMENT_LIST, NULL},
    {VTK_XML_FILE, "Collection", ELEMENT_LIST, NULL},
    {ELEMENT_LIST, "Block", ELEMENT_LIST, NULL},
    {ELEMENT_LIST, "Piece", ELEMENT_LIST, NULL},
    {ELEMENT_LIST, "DataSet", ELEMENT_FILE, on_data_set},
    {0, NULL, 0, NULL},
};

static const vtk_xml_element of_pieces[] = {
    {VTK_XML_FILE, "PUnstructuredGrid", ELEMENT_LIST, NULL},
    {ELEMENT_LIST, "Piece", ELEMENT_FILE, on_piece},
    {0, NULL, 0, NULL},
};

/* ---- steps ---- */

static int by_time(const void *a, const void *b) {
    const vtk_part *p = a, *q = b;
    return p->time != q->time ? (p->time > q->time) - (p->time < q->time)
                              : (p->at > q->at) - (p->at < q->at);
}

static status make_steps(mem *m, vtk_parts *p) {
    qsort(p->items, p->count, sizeof *p->items, by_time);
    p->times = mem_array(m, p->count, sizeof *p->times);
    p->first = mem_array(m, p->count + 1, sizeof *p->first);
    if (!p->times || !p->first)
        return ST_NOMEM;
    for (size_t i = 0; i < p->count; i++)
        if (i == 0 || p->items[i].time != p->items[i - 1].time) {
            p->times[p->steps] = p->items[i].time;
            p->first[p->steps++] = i;
        }
    p->first[p->steps] = p->count;
    return ST_OK;
}

/* ---- files ---- */

status vtk_parts_read(mem *m, const char *path, byte_stream *data, bool follow_links,
                      vtk_parts *out) {
    const uint8_t *start;
    size_t size;
    scan s = {m, path, follow_links, out};
    vtk_appended appended;
    *out = (vtk_parts){0};
    status st = byte_stream_peek(data, PEEK, &start, &size);
    if (st != ST_OK)
        return st;
    out->kind = vtk_parts_find_kind(byte_stream_kind(data), start, size);
    vtk_xml_reader reader = {NULL, out->kind == VTK_PARTS_PIECES ? of_pieces : elements, on_array};
    for (int i = 0; i < KINDS; i++)
        if (kinds[i].kind == out->kind)
            reader.type = kinds[i].type;
    st = vtk_xml_scan(m, path, data, &reader, &s, &appended);
    if (st == ST_OK && out->count == 0)
        st = status_describe(ST_CORRUPT, "%s: it names no file", path);
    return st == ST_OK ? make_steps(m, out) : st;
}

void vtk_parts_release(vtk_parts *p, mem *m) {
    for (size_t i = 0; i < p->count; i++)
        mem_free(m, p->items[i].path);
    mem_free(m, p->items);
    mem_free(m, p->times);
    mem_free(m, p->first);
    *p = (vtk_parts){0};
}

const char *vtk_parts_list(const vtk_parts *p, uint32_t step, char text[VTK_PARTS_TEXT]) {
    name_list names = {0};
    for (size_t i = p->first[step]; i < p->first[step + 1]; i++)
        name_list_add(&names, p->items[i].path);
    snprintf(text, VTK_PARTS_TEXT, "%s", name_list_print(&names));
    return text;
}

status vtk_parts_check_step(const vtk_parts *p, const char *path, uint32_t step) {
    if (step < p->steps)
        return ST_OK;
    return status_describe(ST_USAGE, "%s: no step %u: there %s %u, counted from 0", path, step,
                           p->steps == 1 ? "is" : "are", p->steps);
}
