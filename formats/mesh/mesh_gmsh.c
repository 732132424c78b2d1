#include "formats/mesh/mesh_gmsh.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/id_map.h"
#include "formats/base/text.h"
#include "formats/mesh/gmsh_file.h"
#include "formats/mesh/mesh_average.h"
#include "formats/mesh/mesh_choice.h"
#include "formats/mesh/mesh_split.h"

enum { NODES_MAX = 56, SKIPPED = -1, REFUSED = -2, QUADRATIC_TET = 11 };

/* The meaning of an element's type number. kind: SKIPPED for anything less than a volume. corners:
 * of higher order, the kind that its corners make, which are its first nodes. */
typedef struct element_type {
    int nodes, kind, corners;
} element_type;

static const element_type types[] = {[1] = {2, SKIPPED, 0},
                                     [2] = {3, SKIPPED, 0},
                                     [3] = {4, SKIPPED, 0},
                                     [4] = {4, CELL_TET, 0},
                                     [5] = {8, CELL_HEXAHEDRON, 0},
                                     [6] = {6, CELL_WEDGE, 0},
                                     [7] = {5, CELL_PYRAMID, 0},
                                     [8] = {3, SKIPPED, 0},
                                     [9] = {6, SKIPPED, 0},
                                     [10] = {9, SKIPPED, 0},
                                     [11] = {10, REFUSED, CELL_TET},
                                     [12] = {27, REFUSED, CELL_HEXAHEDRON},
                                     [13] = {18, REFUSED, CELL_WEDGE},
                                     [14] = {14, REFUSED, CELL_PYRAMID},
                                     [15] = {1, SKIPPED, 0},
                                     [16] = {8, SKIPPED, 0},
                                     [17] = {20, REFUSED, CELL_HEXAHEDRON},
                                     [18] = {15, REFUSED, CELL_WEDGE},
                                     [19] = {13, REFUSED, CELL_PYRAMID},
                                     [20] = {9, SKIPPED, 0},
                                     [21] = {10, SKIPPED, 0},
                                     [22] = {12, SKIPPED, 0},
                                     [23] = {15, SKIPPED, 0},
                                     [24] = {15, SKIPPED, 0},
                                     [25] = {21, SKIPPED, 0},
                                     [26] = {4, SKIPPED, 0},
                                     [27] = {5, SKIPPED, 0},
                                     [28] = {6, SKIPPED, 0},
                                     [29] = {20, REFUSED, CELL_TET},
                                     [30] = {35, REFUSED, CELL_TET},
                                     [31] = {56, REFUSED, CELL_TET}};

typedef struct gmsh_state {
    gmsh_file file;
    const mesh_hints *hints;
    const gmsh_array **taken; /* the fields */
    uint32_t count;           /* 0: there is none */
    uint32_t steps;           /* the most arrays of one name, 1 or more */
    double *times;            /* of each step; NULL: there is one */
} gmsh_state;

/* An array of floats that grows. */
typedef struct float_list {
    mem *m;
    float *items;
    size_t count, room;
} float_list;

/* A field while a mesh is read. */
typedef struct gmsh_field {
    const gmsh_array *array;
    uint32_t number;   /* 0, 1, .. */
    id_map rows;       /* element data: the elements' numbers */
    float_list values; /* row by row; a row of $ElementNodeData begins with its number of nodes */
    uint64_t *starts;  /* $ElementNodeData: where each row starts in values */
    size_t starts_room;
    mesh_average average; /* element data: sums over the cells */
} gmsh_field;

/* State while a mesh is read. */
typedef struct gmsh_reading {
    const gmsh_file *file;
    bool by_corners; /* mesh_hints.by_corners */
    gmsh_field *fields;
    uint32_t count;
    mesh_feed *feed;
    int component;
    id_map nodes;
} gmsh_reading;

static bool gmsh_known(const char *path, const uint8_t *start, size_t size) {
    static const char format[] = "$MeshFormat", comments[] = "$Comments";
    (void)path;
    return (size >= sizeof format - 1 && memcmp(start, format, sizeof format - 1) == 0) ||
           (size >= sizeof comments - 1 && memcmp(start, comments, sizeof comments - 1) == 0);
}

/* ---- opening ---- */

static bool is_wanted(const gmsh_array *a, const mesh_hints *hints) {
    return (a->owner == GMSH_ELEMENTS) == hints->cells_to_points &&
           (!hints->field || text_same_name(a->name, hints->field, sizeof a->name));
}

static status no_array(const gmsh_state *s, const mesh_hints *asked) {
    name_list points = {0}, cells = {0};
    for (size_t i = 0; i < s->file.count; i++) {
        const gmsh_array *a = &s->file.arrays[i];
        name_list_add(a->owner == GMSH_ELEMENTS ? &cells : &points, a->name);
    }
    return mesh_choice_missing(s->file.path, asked, &points, &cells);
}

/* Returns whether an array is a later, or earlier, step of another. */
static bool is_step_of(const gmsh_array *a, const gmsh_array *other) {
    return (a->owner == GMSH_ELEMENTS) == (other->owner == GMSH_ELEMENTS) &&
           strcmp(a->name, other->name) == 0;
}

/* Returns step number `step` of the field that begins at array `first`. A field of one array has it
 * at all steps; NULL: the field has no such step. */
static const gmsh_array *find_step(const gmsh_file *f, size_t first, uint32_t step) {
    uint32_t found = 0;
    for (size_t i = first; i < f->count; i++)
        if (is_step_of(&f->arrays[i], &f->arrays[first]) && found++ == step)
            return &f->arrays[i];
    return found == 1 ? &f->arrays[first] : NULL;
}

/* Take the array of this name at the hints' step; NULL: of the first name. */
static status take_array(gmsh_state *s, const char *name) {
    mesh_hints asked = *s->hints;
    asked.field = name;
    size_t i = 0;
    while (i < s->file.count && !is_wanted(&s->file.arrays[i], &asked))
        i++;
    if (i == s->file.count)
        return no_array(s, &asked);
    const gmsh_array *found = find_step(&s->file, i, s->hints->step);
    if (!found)
        return status_describe(ST_USAGE, "%s: \"%s\" has no step %u", s->file.path,
                               s->file.arrays[i].name, s->hints->step);
    s->taken[s->count++] = found;
    return mesh_choice_component(s->file.path, &asked, found->name, found->components);
}

static status gmsh_take(void *state, const char *const *names, uint32_t count) {
    gmsh_state *s = state;
    mem_free(s->file.m, s->taken);
    s->count = 0;
    s->taken = mem_array(s->file.m, count, sizeof *s->taken);
    status st = s->taken ? ST_OK : ST_NOMEM;
    for (uint32_t i = 0; st == ST_OK && i < count; i++)
        st = take_array(s, names[i]);
    return st;
}

/* By field; the steps of a field in the file's order. */
static int compare_arrays(const void *x, const void *y) {
    const gmsh_array *a = *(const gmsh_array *const *)x, *b = *(const gmsh_array *const *)y;
    const bool of_cells = a->owner == GMSH_ELEMENTS, other = b->owner == GMSH_ELEMENTS;
    const int names = strcmp(a->name, b->name);
    if (of_cells != other || names != 0)
        return of_cells != other ? of_cells - other : names;
    return (a > b) - (a < b);
}

/* Returns the longest run of arrays of one field. */
static const gmsh_array *const *longest_field(const gmsh_array *const *sorted, size_t count,
                                              uint32_t *steps) {
    const gmsh_array *const *longest = sorted;
    *steps = 1;
    for (size_t i = 0, first = 0; i < count; i++) {
        first = is_step_of(sorted[i], sorted[first]) ? first : i;
        if (i - first + 1 > *steps) {
            *steps = (uint32_t)(i - first + 1);
            longest = sorted + first;
        }
    }
    return longest;
}

static status keep_times(gmsh_state *s, const gmsh_array *const *field) {
    s->times = mem_array(s->file.m, s->steps, sizeof *s->times);
    for (uint32_t k = 0; s->times && k < s->steps; k++)
        s->times[k] = field[k]->time;
    return s->times ? ST_OK : ST_NOMEM;
}

/* Find the field of the most steps, and its times. */
static status find_steps(gmsh_state *s) {
    const gmsh_file *f = &s->file;
    const gmsh_array **sorted = mem_array(f->m, f->count + 1, sizeof *sorted);
    if (!sorted)
        return ST_NOMEM;
    for (size_t i = 0; i < f->count; i++)
        sorted[i] = &f->arrays[i];
    qsort(sorted, f->count, sizeof *sorted, compare_arrays);
    const gmsh_array *const *field = longest_field(sorted, f->count, &s->steps);
    status st = s->steps > 1 ? keep_times(s, field) : ST_OK;
    mem_free(f->m, sorted);
    if (st == ST_OK && s->hints->step >= s->steps)
        st = status_describe(ST_USAGE, "%s: no step %u: there %s %u, counted from 0", f->path,
                             s->hints->step, s->steps == 1 ? "is" : "are", s->steps);
    return st;
}

static uint32_t gmsh_steps(const void *state, const double **times) {
    const gmsh_state *s = state;
    *times = s->times;
    return s->steps;
}

static status gmsh_open(mesh_source *source, void **state) {
    if (strcmp(source->path, "-") == 0 || byte_stream_left(source->data) == UINT64_MAX)
        return status_describe(ST_UNSUPPORTED, "%s: Gmsh's format needs a file, not a pipe",
                               byte_stream_name(source->data));
    gmsh_state *s = mem_zalloc(source->m, sizeof *s);
    if (!s)
        return ST_NOMEM;
    *state = s;
    s->file.m = source->m;
    s->hints = &source->hints;
    const status st = gmsh_file_scan(&s->file, source->m, source->data);
    return st == ST_OK ? find_steps(s) : st;
}

static void gmsh_close(void *state) {
    gmsh_state *s = state;
    if (!s)
        return;
    mem *m = s->file.m;
    gmsh_file_release(&s->file);
    mem_free(m, s->taken);
    mem_free(m, s->times);
    mem_free(m, s);
}

/* ---- nodes ---- */

static status read_point(gmsh_reading *r, gmsh_cursor *c, int parameters) {
    double xyz[3] = {0}, waste;
    status st = ST_OK;
    for (int a = 0; st == ST_OK && a < 3; a++)
        st = gmsh_cursor_double(c, "a coordinate", &xyz[a]);
    for (int i = 0; st == ST_OK && i < parameters; i++)
        st = gmsh_cursor_double(c, "a parameter", &waste);
    return st == ST_OK ? mesh_feed_point(r->feed, xyz) : st;
}

static status read_nodes_2(gmsh_reading *r, gmsh_cursor *c) {
    uint64_t count = 0, id = 0;
    status st = gmsh_cursor_line(c, "the number of nodes", &count);
    if (st == ST_OK)
        st = mesh_feed_expect(r->feed, count);
    for (uint64_t i = 0; st == ST_OK && i < count; i++) {
        st = gmsh_cursor_int(c, "a node's number", &id);
        if (st == ST_OK)
            st = id_map_add(&r->nodes, id);
        if (st == ST_OK)
            st = read_point(r, c, 0);
    }
    return st;
}

/* Read a block: all its node numbers, then all its points. */
static status read_node_block(gmsh_reading *r, gmsh_cursor *c) {
    uint64_t dimensions = 0, tag, parametric = 0, count = 0, id = 0;
    status st = gmsh_cursor_int(c, "an entity's dimension", &dimensions);
    if (st == ST_OK)
        st = gmsh_cursor_int(c, "an entity's number", &tag);
    if (st == ST_OK)
        st = gmsh_cursor_int(c, "0 or 1, parametric", &parametric);
    if (st == ST_OK)
        st = gmsh_cursor_size(c, "the number of nodes of a block", &count);
    if (st == ST_OK && (dimensions > 3 || parametric > 1))
        return gmsh_cursor_fault(c, ST_CORRUPT,
                                 "expected a dimension of 0 to 3, parametric 0 or 1");
    if (st == ST_OK && count > r->feed->points - r->nodes.ids)
        return gmsh_cursor_fault(c, ST_CORRUPT, "a block of %llu nodes, expected at most %llu more",
                                 (unsigned long long)count,
                                 (unsigned long long)(r->feed->points - r->nodes.ids));
    for (uint64_t i = 0; st == ST_OK && i < count; i++) {
        st = gmsh_cursor_size(c, "a node's number", &id);
        if (st == ST_OK)
            st = id_map_add(&r->nodes, id);
    }
    for (uint64_t i = 0; st == ST_OK && i < count; i++)
        st = read_point(r, c, parametric ? (int)dimensions : 0);
    return st;
}

/* Read "blocks all least greatest", the header of the nodes and of the elements. */
static status read_block_header(gmsh_cursor *c, uint64_t *blocks, uint64_t *all) {
    uint64_t waste;
    status st = gmsh_cursor_size(c, "the number of blocks", blocks);
    if (st == ST_OK)
        st = gmsh_cursor_size(c, "the number in all blocks", all);
    if (st == ST_OK)
        st = gmsh_cursor_size(c, "the least number", &waste);
    return st == ST_OK ? gmsh_cursor_size(c, "the greatest number", &waste) : st;
}

static status read_nodes_4(gmsh_reading *r, gmsh_cursor *c) {
    uint64_t blocks = 0, count = 0;
    status st = read_block_header(c, &blocks, &count);
    if (st == ST_OK)
        st = mesh_feed_expect(r->feed, count);
    for (uint64_t i = 0; st == ST_OK && i < blocks; i++)
        st = read_node_block(r, c);
    if (st == ST_OK && r->nodes.ids < count)
        return gmsh_cursor_fault(c, ST_CORRUPT, "%llu nodes in all blocks, expected %llu",
                                 (unsigned long long)r->nodes.ids, (unsigned long long)count);
    return st;
}

static status read_nodes(gmsh_reading *r) {
    gmsh_cursor c;
    uint64_t twice;
    status st = gmsh_cursor_open(r->file, &r->file->nodes, &c);
    if (st == ST_OK)
        st = r->file->version == 2 ? read_nodes_2(r, &c) : read_nodes_4(r, &c);
    if (st == ST_OK)
        st = gmsh_cursor_end(&c, "$EndNodes");
    if (st == ST_OK && !id_map_seal(&r->nodes, &twice))
        st = gmsh_cursor_fault(&c, ST_CORRUPT, "node %lld is there twice, expected once",
                               (long long)twice);
    gmsh_cursor_close(&c);
    return st;
}

/* ---- the field ---- */

static status push(float_list *list, float value) {
    status st =
        mem_grow(list->m, &list->items, sizeof *list->items, list->count, 1024, &list->room);
    if (st == ST_OK)
        list->items[list->count++] = value;
    return st;
}

/* Read a row's components and reduce them to one value. */
static status read_value(const gmsh_reading *r, const gmsh_field *f, gmsh_cursor *c, float *value) {
    double components[GMSH_COMPONENTS_MAX];
    int count = f->array->components;
    status st = ST_OK;
    for (int i = 0; st == ST_OK && i < count; i++)
        st = gmsh_cursor_double(c, "a value", &components[i]);
    if (st == ST_OK)
        *value = (float)mesh_feed_magnitude(components, count, r->component);
    return st;
}

static status read_node_data(gmsh_reading *r, gmsh_field *f, gmsh_cursor *c) {
    size_t points = (size_t)r->feed->points;
    f->values.items = mem_array(f->values.m, points, sizeof *f->values.items);
    status st = f->values.items ? ST_OK : ST_NOMEM;
    for (size_t i = 0; st == ST_OK && i < points; i++)
        f->values.items[i] = NAN;
    for (uint64_t i = 0; st == ST_OK && i < f->array->count; i++) {
        uint64_t id = 0;
        float value = 0;
        st = gmsh_cursor_int(c, "a node's number", &id);
        if (st == ST_OK)
            st = read_value(r, f, c, &value);
        uint64_t index = st == ST_OK ? id_map_find(&r->nodes, id) : UINT64_MAX;
        if (index != UINT64_MAX) /* views may know more nodes than the mesh */
            f->values.items[index] = value;
    }
    if (st == ST_OK)
        st = mesh_feed_values(r->feed, f->number, f->values.items, points);
    mem_free(f->values.m, f->values.items);
    f->values.items = NULL;
    return st;
}

static status push_start(gmsh_field *f) {
    size_t row = (size_t)f->rows.ids - 1;
    status st = mem_grow(f->rows.m, &f->starts, sizeof *f->starts, row, 1024, &f->starts_room);
    if (st == ST_OK)
        f->starts[row] = f->values.count;
    return st;
}

/* Read a row's number of nodes, and keep it in front of the row's values. */
static status begin_row(gmsh_field *f, gmsh_cursor *c, uint64_t *values) {
    status st = gmsh_cursor_int(c, "the number of an element's nodes", values);
    if (st == ST_OK && (*values < 1 || *values > 1000))
        return gmsh_cursor_fault(c, ST_CORRUPT, "an element of %lld nodes, expected 1 to 1000",
                                 (long long)*values);
    if (st == ST_OK)
        st = push_start(f);
    return st == ST_OK ? push(&f->values, (float)*values) : st;
}

static status read_element_data(gmsh_reading *r, gmsh_field *f, gmsh_cursor *c) {
    uint64_t twice;
    status st = ST_OK;
    for (uint64_t i = 0; st == ST_OK && i < f->array->count; i++) {
        uint64_t id = 0, values = 1;
        float value = 0;
        st = gmsh_cursor_int(c, "an element's number", &id);
        if (st == ST_OK)
            st = id_map_add(&f->rows, id);
        if (st == ST_OK && f->array->owner == GMSH_ELEMENT_NODES)
            st = begin_row(f, c, &values);
        for (; st == ST_OK && values > 0; values--) {
            st = read_value(r, f, c, &value);
            if (st == ST_OK)
                st = push(&f->values, value);
        }
    }
    if (st == ST_OK && !id_map_seal(&f->rows, &twice))
        return gmsh_cursor_fault(c, ST_CORRUPT, "element %lld has two rows, expected one",
                                 (long long)twice);
    return st == ST_OK ? mesh_average_begin(&f->average, r->file->m, r->feed->points, 1) : st;
}

static status read_field(gmsh_reading *r, gmsh_field *f) {
    static const char *const ends[] = {[GMSH_NODES] = "$EndNodeData",
                                       [GMSH_ELEMENT_NODES] = "$EndElementNodeData",
                                       [GMSH_ELEMENTS] = "$EndElementData"};
    gmsh_cursor c;
    status st = gmsh_cursor_open(r->file, &f->array->rows, &c);
    if (st == ST_OK)
        st = f->array->owner == GMSH_NODES ? read_node_data(r, f, &c) : read_element_data(r, f, &c);
    if (st == ST_OK)
        st = gmsh_cursor_end(&c, ends[f->array->owner]);
    gmsh_cursor_close(&c);
    return st;
}

/* ---- elements ---- */

static status find_type(const gmsh_reading *r, const gmsh_cursor *c, uint64_t number,
                        element_type *type) {
    const bool known = number < sizeof types / sizeof *types && types[number].nodes > 0;
    const bool quadratic = number == QUADRATIC_TET;
    if (quadratic && !r->by_corners && mesh_feed_takes_quadratic(r->feed)) {
        *type = (element_type){types[number].nodes, CELL_QUADRATIC_TET, 0};
        return ST_OK;
    }
    if (!known || (types[number].kind == REFUSED && !r->by_corners))
        return gmsh_cursor_fault(c, ST_UNSUPPORTED,
                                 "an element of type %lld, expected tets, hexes, prisms and "
                                 "pyramids of first order (4 5 6 7), surfaces, edges or points%s",
                                 (long long)number,
                                 quadratic
                                     ? " (--whole-cells takes it as it is, --by-corners as of "
                                       "first order)"
                                 : known ? " (--by-corners takes it as of first order)"
                                         : "");
    *type = types[number];
    return ST_OK;
}

/* Add a cell's element data, if it has any, to its points. nodes: of the element. */
static status add_to_average(gmsh_field *f, const gmsh_cursor *c, cell_shape kind, int nodes,
                             uint64_t id, const uint64_t *ids) {
    uint64_t row = id_map_find(&f->rows, id);
    if (row == UINT64_MAX)
        return ST_OK;
    if (f->array->owner == GMSH_ELEMENTS) {
        mesh_average_add(&f->average, 0, kind, ids, (double)f->values.items[row]);
        return ST_OK;
    }
    const float *values = &f->values.items[f->starts[row]];
    if ((int)values[0] != nodes)
        return gmsh_cursor_fault(c, ST_CORRUPT, "element %lld has values for %d nodes, expected %d",
                                 (long long)id, (int)values[0], nodes);
    mesh_average_add_each(&f->average, 0, kind, ids, values + 1);
    return ST_OK;
}

static status add_to_averages(gmsh_reading *r, const gmsh_cursor *c, cell_shape kind, int nodes,
                              uint64_t id, const uint64_t *ids) {
    status st = ST_OK;
    for (uint32_t k = 0; st == ST_OK && k < r->count; k++)
        if (r->fields[k].average.m)
            st = add_to_average(&r->fields[k], c, kind, nodes, id, ids);
    return st;
}

/* Read an element's nodes, which come next, and feed the cell. */
static status read_element(gmsh_reading *r, gmsh_cursor *c, element_type type, uint64_t id) {
    uint64_t ids[NODES_MAX];
    status st = ST_OK;
    for (int i = 0; st == ST_OK && i < type.nodes; i++)
        st = r->file->version == 2 ? gmsh_cursor_int(c, "the number of a node", &ids[i])
                                   : gmsh_cursor_size(c, "the number of a node", &ids[i]);
    if (st != ST_OK)
        return st;
    if (type.kind == SKIPPED) {
        r->feed->report->skipped++;
        return ST_OK;
    }
    const cell_shape kind = (cell_shape)(type.kind == REFUSED ? type.corners : type.kind);
    for (int i = 0; i < cell_shape_vertices(kind); i++)
        ids[i] = id_map_find(&r->nodes, ids[i]);
    r->feed->report->by_corners += type.kind == REFUSED;
    st = add_to_averages(r, c, kind, type.nodes, id, ids);
    if (kind == CELL_QUADRATIC_TET) { /* Gmsh has the node of edge 23 before that of edge 13 */
        const uint64_t last = ids[9];
        ids[9] = ids[8];
        ids[8] = last;
    }
    return st == ST_OK ? mesh_feed_cell(r->feed, kind, ids) : st;
}

static status skip_tags(gmsh_cursor *c, uint64_t count) {
    uint64_t waste;
    status st = ST_OK;
    if (count > 1000)
        return gmsh_cursor_fault(c, ST_CORRUPT, "%lld tags, expected up to 1000", (long long)count);
    for (uint64_t i = 0; st == ST_OK && i < count; i++)
        st = gmsh_cursor_int(c, "an element's tag", &waste);
    return st;
}

/* Text: "id type tags .. nodes". Binary: the type and the number of tags stand once in front of
 * `members` elements. */
static status read_elements_2(gmsh_reading *r, gmsh_cursor *c) {
    uint64_t count = 0, id = 0, number = 0, members = 0, tags = 0;
    element_type type = {0};
    bool binary = r->file->binary;
    status st = gmsh_cursor_line(c, "the number of elements", &count);
    mesh_feed_expect_cells(r->feed, count);
    for (uint64_t i = 0; st == ST_OK && i < count; i++) {
        if (!binary)
            st = gmsh_cursor_int(c, "an element's number", &id);
        if (st == ST_OK && (!binary || members == 0)) {
            st = gmsh_cursor_int(c, "an element's type", &number);
            members = 1;
            if (st == ST_OK && binary)
                st = gmsh_cursor_int(c, "the number of elements of this type", &members);
            if (st == ST_OK)
                st = gmsh_cursor_int(c, "the number of tags", &tags);
            if (st == ST_OK)
                st = find_type(r, c, number, &type);
            if (st == ST_OK && (members < 1 || members > count - i))
                st = gmsh_cursor_fault(c, ST_CORRUPT, "%lld elements, expected 1 to %llu",
                                       (long long)members, (unsigned long long)(count - i));
        }
        if (st == ST_OK && binary)
            st = gmsh_cursor_int(c, "an element's number", &id);
        if (st == ST_OK)
            st = skip_tags(c, tags);
        if (st == ST_OK)
            st = read_element(r, c, type, id);
        members--;
    }
    return st;
}

/* Read a block of elements of one type. *left: elements still to come in all blocks. */
static status read_element_block(gmsh_reading *r, gmsh_cursor *c, uint64_t *left) {
    uint64_t waste, number = 0, count = 0, id = 0;
    element_type type = {0};
    status st = gmsh_cursor_int(c, "an entity's dimension", &waste);
    if (st == ST_OK)
        st = gmsh_cursor_int(c, "an entity's number", &waste);
    if (st == ST_OK)
        st = gmsh_cursor_int(c, "an element's type", &number);
    if (st == ST_OK)
        st = gmsh_cursor_size(c, "the number of elements of a block", &count);
    if (st == ST_OK && count > *left)
        return gmsh_cursor_fault(c, ST_CORRUPT, "a block of %lld elements, expected at most %llu",
                                 (long long)count, (unsigned long long)*left);
    *left -= count;
    if (st == ST_OK)
        st = find_type(r, c, number, &type);
    for (; st == ST_OK && count > 0; count--) {
        st = gmsh_cursor_size(c, "an element's number", &id);
        if (st == ST_OK)
            st = read_element(r, c, type, id);
    }
    return st;
}

static status read_elements_4(gmsh_reading *r, gmsh_cursor *c) {
    uint64_t blocks = 0, left = 0;
    status st = read_block_header(c, &blocks, &left);
    mesh_feed_expect_cells(r->feed, left);
    for (uint64_t i = 0; st == ST_OK && i < blocks; i++)
        st = read_element_block(r, c, &left);
    if (st == ST_OK && left > 0)
        return gmsh_cursor_fault(c, ST_CORRUPT, "expected %llu elements more in the blocks",
                                 (unsigned long long)left);
    return st;
}

static status read_elements(gmsh_reading *r) {
    gmsh_cursor c;
    status st = gmsh_cursor_open(r->file, &r->file->elements, &c);
    if (st == ST_OK)
        st = r->file->version == 2 ? read_elements_2(r, &c) : read_elements_4(r, &c);
    if (st == ST_OK)
        st = gmsh_cursor_end(&c, "$EndElements");
    gmsh_cursor_close(&c);
    return st;
}

/* ---- all of it ---- */

static status read_fields(gmsh_reading *r) {
    status st = r->count > 0 ? ST_OK : mesh_feed_zeros(r->feed);
    for (uint32_t k = 0; st == ST_OK && k < r->count; k++)
        st = read_field(r, &r->fields[k]);
    return st;
}

static status feed_averages(const gmsh_reading *r) {
    status st = ST_OK;
    for (uint32_t k = 0; st == ST_OK && k < r->count; k++)
        if (r->fields[k].average.m)
            st = mesh_average_feed(&r->fields[k].average, r->feed, k);
    return st;
}

static status begin_fields(gmsh_reading *r, const gmsh_state *s) {
    mem *m = s->file.m;
    r->fields = mem_array(m, s->count ? s->count : 1, sizeof *r->fields);
    if (!r->fields)
        return ST_NOMEM;
    for (r->count = 0; r->count < s->count; r->count++)
        r->fields[r->count] = (gmsh_field){
            .array = s->taken[r->count], .number = r->count, .rows.m = m, .values.m = m};
    return ST_OK;
}

static void release(gmsh_reading *r, mem *m) {
    for (uint32_t k = 0; k < r->count; k++) {
        gmsh_field *f = &r->fields[k];
        mesh_average_release(&f->average);
        id_map_release(&f->rows);
        mem_free(m, f->values.items);
        mem_free(m, f->starts);
    }
    mem_free(m, r->fields);
    id_map_release(&r->nodes);
}

static status gmsh_read(void *state, mesh_feed *feed) {
    const gmsh_state *s = state;
    mem *m = s->file.m;
    gmsh_reading r = {.file = &s->file,
                      .feed = feed,
                      .by_corners = s->hints->by_corners,
                      .component = s->hints->component,
                      .nodes.m = m};
    if (s->count > 0)
        strcpy(feed->report->field, s->taken[0]->name);
    status st = begin_fields(&r, s);
    if (st == ST_OK)
        st = read_nodes(&r);
    if (st == ST_OK)
        st = read_fields(&r);
    if (st == ST_OK)
        st = read_elements(&r);
    if (st == ST_OK)
        st = feed_averages(&r);
    release(&r, m);
    return st;
}

static void gmsh_fields(const void *state, mesh_field_taker *take, void *ctx) {
    const gmsh_state *s = state;
    for (size_t i = 0; i < s->file.count; i++)
        if ((s->file.arrays[i].owner == GMSH_ELEMENTS) == s->hints->cells_to_points)
            take(ctx, s->file.arrays[i].name, s->file.arrays[i].components);
}

const mesh_reader mesh_gmsh_reader = {.format = "Gmsh",
                                      .known = gmsh_known,
                                      .open = gmsh_open,
                                      .read = gmsh_read,
                                      .close = gmsh_close,
                                      .take = gmsh_take,
                                      .fields = gmsh_fields,
                                      .steps = gmsh_steps};
