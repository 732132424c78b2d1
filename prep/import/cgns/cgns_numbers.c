#include "prep/import/cgns/cgns_numbers.h"

#include <cgns_io.h>
#include <stdio.h>
#include <string.h>

/* What the library calls a cgsize_t. */
#define NUMBERS (sizeof(cgsize_t) == 4 ? "I4" : "I8")

/* ---- an array ---- */

status cgns_numbers_find(const cgns_file *f, int zone, const char *section, const char *array,
                         bool *there, cgns_numbers *n) {
    char path[2 * CGNS_NAME + 2], type[CGIO_MAX_DATATYPE_LENGTH + 1] = "";
    double parent = 0;
    int io = 0, rank = 0;
    cgsize_t dims[12] = {0};
    *n = (cgns_numbers){.zone = zone};
    snprintf(path, sizeof path, "%s/%s", section, array);
    if (cg_get_cgio(f->id, &io) != CG_OK || cg_zone_id(f->id, f->base, zone + 1, &parent) != CG_OK)
        return cgns_file_failed(f, section);
    const bool is = cgio_get_node_id(io, parent, path, &n->node) == CGIO_ERR_NONE;
    if (there)
        *there = is;
    if (there && !is)
        return ST_OK;
    if (!is || cgio_get_dimensions(io, n->node, &rank, dims) != CGIO_ERR_NONE ||
        cgio_get_data_type(io, n->node, type) != CGIO_ERR_NONE || rank != 1 || dims[0] < 0)
        return status_describe(ST_CORRUPT, "%s: zone %d: section %s has no %s", f->path, zone + 1,
                               section, array);
    n->count = (uint64_t)dims[0];
    n->as_it_is = strcmp(type, NUMBERS) == 0;
    return ST_OK;
}

status cgns_numbers_read(const cgns_file *f, const cgns_numbers *n, uint64_t first, size_t count,
                         cgsize_t *to) {
    const cgsize_t one = 1, size = (cgsize_t)count;
    const cgsize_t start = (cgsize_t)first + 1, end = start + size - 1;
    int io = 0;
    if (cg_get_cgio(f->id, &io) != CG_OK)
        return cgns_file_failed(f, "elements");
    /* Only the first call is there for ADF, and only the second one converts. */
    const int error = n->as_it_is ? cgio_read_data(io, n->node, &start, &end, &one, 1, &size, &one,
                                                   &size, &one, to)
                                  : cgio_read_data_type(io, n->node, &start, &end, &one, NUMBERS, 1,
                                                        &size, &one, &size, &one, to);
    if (error == CGIO_ERR_NONE)
        return ST_OK;
    char said[CGIO_MAX_ERROR_LENGTH + 1] = "";
    cgio_error_message(said);
    return status_describe(ST_CORRUPT, "%s: zone %d: elements: libcgns: %s", f->path, n->zone + 1,
                           said);
}

/* ---- lists ---- */

status cgns_lists_find(const cgns_file *f, int zone, const char *section, uint64_t count,
                       cgns_lists *l) {
    bool starts = false;
    *l = (cgns_lists){.count = count};
    status st = cgns_numbers_find(f, zone, section, "ElementConnectivity", NULL, &l->numbers);
    if (st == ST_OK)
        st = cgns_numbers_find(f, zone, section, "ElementStartOffset", &starts, &l->starts);
    l->counted = !starts;
    if (st == ST_OK && starts && l->starts.count != count + 1)
        st = status_describe(ST_CORRUPT,
                             "%s: zone %d: section %s has %llu numbers in ElementStartOffset, "
                             "expected %llu",
                             f->path, zone + 1, section, (unsigned long long)l->starts.count,
                             (unsigned long long)count + 1);
    return st;
}

static status wrong(const cgns_lists_walk *w, const cgns_file *f, const cgns_lists *l,
                    const char *what) {
    return status_describe(ST_CORRUPT,
                           "%s: zone %d: element %llu (counted from 0) of a section of %s", f->path,
                           l->numbers.zone + 1, (unsigned long long)w->element, what);
}

/* Have `count` numbers from w->at on in the buffer, which are there. */
static status hold(cgns_lists_walk *w, const cgns_file *f, const cgns_lists *l, size_t count) {
    const uint64_t left = l->numbers.count - w->at;
    if (w->at >= w->begun && w->at + count <= w->begun + w->held)
        return ST_OK;
    w->begun = w->at;
    w->held = left < 2 * CGNS_LIST_MAX ? (size_t)left : 2 * CGNS_LIST_MAX;
    return cgns_numbers_read(f, &l->numbers, w->at, w->held, w->numbers);
}

/* Read where a list begins: the i-th number of ElementStartOffset. */
static status read_start(cgns_lists_walk *w, const cgns_file *f, const cgns_lists *l, uint64_t i,
                         cgsize_t *start) {
    status st = ST_OK;
    if (w->starts_held == 0 || i < w->starts_begun || i - w->starts_begun >= w->starts_held) {
        const uint64_t left = l->starts.count - i;
        w->starts_begun = i;
        w->starts_held = left < CGNS_STARTS ? (size_t)left : CGNS_STARTS;
        st = cgns_numbers_read(f, &l->starts, i, w->starts_held, w->starts);
    }
    *start = w->starts[i - w->starts_begun];
    return st;
}

/* Find how long the next list is. It begins at w->at then. */
static status find_length(cgns_lists_walk *w, const cgns_file *f, const cgns_lists *l,
                          uint64_t *length) {
    cgsize_t start = 0, end = 0;
    status st = ST_OK;
    *length = 0;
    if (l->counted && w->at >= l->numbers.count)
        return wrong(w, f, l, "faces begins behind its numbers");
    if (l->counted) {
        st = hold(w, f, l, 1);
        end = w->numbers[w->at - w->begun];
        w->at++;
    } else {
        st = read_start(w, f, l, w->element, &start);
        if (st == ST_OK)
            st = read_start(w, f, l, w->element + 1, &end);
        if (st == ST_OK && (start < 0 || (uint64_t)start != w->at))
            return wrong(w, f, l, "faces does not begin where the last one ends");
    }
    if (st != ST_OK)
        return st;
    if (end < start || (uint64_t)(end - start) > l->numbers.count - w->at)
        return wrong(w, f, l, "faces ends behind its numbers");
    *length = (uint64_t)(end - start);
    return ST_OK;
}

status cgns_lists_next(cgns_lists_walk *w, const cgns_file *f, const cgns_lists *l,
                       const cgsize_t **list, size_t *length) {
    uint64_t many = 0;
    *list = NULL;
    *length = 0;
    if (w->element >= l->count)
        return w->at == l->numbers.count
                   ? ST_OK
                   : wrong(w, f, l, "faces is the last one, and has numbers behind it");
    status st = find_length(w, f, l, &many);
    if (st == ST_OK && many > CGNS_LIST_MAX)
        st = status_describe(ST_UNSUPPORTED,
                             "%s: zone %d: element %llu (counted from 0) of a section of faces has "
                             "%llu numbers, at most %d are supported",
                             f->path, l->numbers.zone + 1, (unsigned long long)w->element,
                             (unsigned long long)many, CGNS_LIST_MAX);
    if (st == ST_OK && many > 0)
        st = hold(w, f, l, (size_t)many);
    if (st != ST_OK)
        return st;
    *list = w->numbers + (many > 0 ? w->at - w->begun : 0);
    *length = (size_t)many;
    w->at += many;
    w->element++;
    return ST_OK;
}
