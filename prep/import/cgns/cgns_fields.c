#include "prep/import/cgns/cgns_fields.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/text.h"

enum { READ_NUMBERS = 2048, STEPS_MAX = 1 << 20 };

/* ---- names ---- */

/* Find whose fields a solution has: IMPORT_OWNERS: neither's, or only some nodes' or cells', which
 * it lists. name: of the solution. */
static status find_owner(const cgns_file *f, int zone, int solution, char name[CGNS_NAME],
                         import_owner *owner) {
    CGNS_ENUMT(GridLocation_t) location;
    CGNS_ENUMT(PointSetType_t) listed = CGNS_ENUMV(PointSetTypeNull);
    cgsize_t points = 0;
    if (cg_sol_info(f->id, f->base, zone + 1, solution, name, &location) != CG_OK ||
        cg_sol_ptset_info(f->id, f->base, zone + 1, solution, &listed, &points) != CG_OK)
        return cgns_file_failed(f, "a solution");
    *owner = listed != CGNS_ENUMV(PointSetTypeNull) ? IMPORT_OWNERS
             : location == CGNS_ENUMV(Vertex)       ? IMPORT_POINTS
             : location == CGNS_ENUMV(CellCenter)   ? IMPORT_CELLS
                                                    : IMPORT_OWNERS;
    return ST_OK;
}

static status add_solution(cgns_fields *x, int zone, int solution) {
    const cgns_file *f = x->f;
    char name[CGNS_NAME];
    CGNS_ENUMT(DataType_t) type;
    import_owner owner;
    int fields = 0;
    status st = find_owner(f, zone, solution, name, &owner);
    if (st == ST_OK && cg_nfields(f->id, f->base, zone + 1, solution, &fields) != CG_OK)
        st = cgns_file_failed(f, name);
    for (int i = 1; i <= fields && owner != IMPORT_OWNERS && st == ST_OK; i++) {
        if (cg_field_info(f->id, f->base, zone + 1, solution, i, &type, name) != CG_OK)
            return cgns_file_failed(f, "a field");
        if (!import_fields_has(&x->all, owner, name))
            st = import_fields_add(&x->all, owner, name);
    }
    return st;
}

static status add_zone(cgns_fields *x, int zone) {
    int solutions = 0;
    if (cg_nsols(x->f->id, x->f->base, zone + 1, &solutions) != CG_OK)
        return cgns_file_failed(x->f, "solutions");
    status st = ST_OK;
    for (int s = 1; s <= solutions && st == ST_OK; s++)
        st = add_solution(x, zone, s);
    return st;
}

/* Find a field in a solution by what it is called; *name: as the file spells it. */
static bool has_field(const cgns_file *f, int zone, int solution, const char *called,
                      char name[CGNS_NAME]) {
    int fields = 0;
    char other[CGNS_NAME];
    CGNS_ENUMT(DataType_t) type;
    if (cg_nfields(f->id, f->base, zone + 1, solution, &fields) != CG_OK)
        return false;
    for (int i = 1; i <= fields; i++)
        if (cg_field_info(f->id, f->base, zone + 1, solution, i, &type, other) == CG_OK &&
            text_same_name(other, called, MESH_NAME_MAX + 1)) {
            strcpy(name, other);
            return true;
        }
    return false;
}

/* ---- steps ---- */

/* An array of the node that cg_goto() has gone to. */
typedef struct array {
    int number;
    char name[CGNS_NAME];
    CGNS_ENUMT(DataType_t) type;
    uint64_t dims[2]; /* 1 of those that there are not */
} array;

/* Go through the arrays there: *a is the next one behind a->number; false: there is none. */
static bool next_array(array *a) {
    int count = 0, rank = 0;
    cgsize_t dims[12] = {0};
    if (cg_narrays(&count) != CG_OK || a->number >= count ||
        cg_array_info(++a->number, a->name, &a->type, &rank, dims) != CG_OK)
        return false;
    a->dims[0] = rank >= 1 && rank <= 2 && dims[0] > 0 ? (uint64_t)dims[0] : 0;
    a->dims[1] = rank == 2 && dims[1] > 0 ? (uint64_t)dims[1] : 1;
    return true;
}

static status read_steps(cgns_fields *x) {
    const cgns_file *f = x->f;
    char name[CGNS_NAME];
    int steps = 0;
    array a = {0};
    x->all.steps = 1;
    if (cg_biter_read(f->id, f->base, name, &steps) != CG_OK || steps < 1 || steps > STEPS_MAX)
        return ST_OK;
    x->all.steps = (uint32_t)steps;
    x->told = true;
    if (cg_goto(f->id, f->base, "BaseIterativeData_t", 1, "end") != CG_OK)
        return ST_OK;
    while (next_array(&a) && !x->all.times) {
        if (strcmp(a.name, "TimeValues") != 0 || a.dims[0] * a.dims[1] != x->all.steps)
            continue;
        double *times = x->all.times = mem_array(f->m, x->all.steps, sizeof *times);
        if (!times)
            return ST_NOMEM;
        if (cg_array_read_as(a.number, CGNS_ENUMV(RealDouble), times) != CG_OK)
            return cgns_file_failed(f, "TimeValues");
    }
    return ST_OK;
}

/* Count a zone's solutions that have a field of their first one: steps, where nothing is said of
 * any.
 */
static status count_solutions(const cgns_fields *x, int zone, uint64_t *count) {
    const cgns_file *f = x->f;
    char name[CGNS_NAME], field[CGNS_NAME], other[CGNS_NAME];
    CGNS_ENUMT(DataType_t) type;
    import_owner first, owner;
    int solutions = 0, fields = 0;
    *count = 0;
    if (cg_nsols(f->id, f->base, zone + 1, &solutions) != CG_OK)
        return cgns_file_failed(f, "solutions");
    if (solutions < 2)
        return ST_OK;
    status st = find_owner(f, zone, 1, name, &first);
    if (st != ST_OK || cg_nfields(f->id, f->base, zone + 1, 1, &fields) != CG_OK || fields < 1 ||
        cg_field_info(f->id, f->base, zone + 1, 1, 1, &type, field) != CG_OK)
        return st;
    for (int s = 1; s <= solutions && st == ST_OK; s++) {
        st = find_owner(f, zone, s, name, &owner);
        *count += st == ST_OK && owner == first && has_field(f, zone, s, field, other);
    }
    return st;
}

static status count_steps(cgns_fields *x) {
    status st = ST_OK;
    for (int z = 0; z < x->f->zone_count && st == ST_OK && !x->told; z++) {
        uint64_t count;
        st = count_solutions(x, z, &count);
        x->all.steps = count > x->all.steps ? count : x->all.steps;
    }
    return st;
}

status cgns_fields_open(const cgns_file *f, cgns_fields *x) {
    *x = (cgns_fields){.f = f, .all = {.m = f->m, .path = f->path}};
    x->all.of[IMPORT_POINTS] = "of the nodes";
    x->all.of[IMPORT_CELLS] = "of the cells";
    x->solutions = mem_array(f->m, (size_t)f->zone_count + 1, sizeof *x->solutions);
    status st = x->solutions ? read_steps(x) : ST_NOMEM;
    for (int z = 0; z < f->zone_count && st == ST_OK; z++)
        st = add_zone(x, z);
    return st == ST_OK ? count_steps(x) : st;
}

void cgns_fields_release(cgns_fields *x) {
    if (!x->f)
        return;
    import_fields_release(&x->all);
    mem_free(x->f->m, x->solutions);
    mesh_average_release(&x->sums);
    if (x->room.m)
        mesh_polyhedron_release(&x->room);
}

/* ---- a field at a step ---- */

enum { POINTER = 32, POINTERS_MAX = 16 * (POINTER + 3) }; /* a solution's name has no NUL */

/* The arrays that name the solutions of each step: FlowSolutionPointers, and what others call those
 * of nodes and cells. */
static bool points_to_solutions(const array *a, uint64_t steps) {
    const size_t length = strlen(a->name);
    return strncmp(a->name, "Flow", 4) == 0 && length > 8 &&
           strcmp(a->name + length - 8, "Pointers") == 0 && a->type == CGNS_ENUMV(Character) &&
           a->dims[0] == POINTER && a->dims[1] == steps;
}

/* Read the names of a zone's solutions at a step, each with a slash behind it; "": none are named.
 */
static status read_pointers(const cgns_fields *x, int zone, char *to, size_t room) {
    const cgns_file *f = x->f;
    array a = {0};
    char name[CGNS_NAME];
    *to = 0;
    if (cg_ziter_read(f->id, f->base, zone + 1, name) != CG_OK ||
        cg_goto(f->id, f->base, "Zone_t", zone + 1, "ZoneIterativeData_t", 1, "end") != CG_OK)
        return ST_OK;
    while (next_array(&a)) {
        if (!points_to_solutions(&a, x->all.steps))
            continue;
        char *all = mem_alloc(f->m, (size_t)POINTER * (size_t)x->all.steps);
        if (!all)
            return ST_NOMEM;
        const int error = cg_array_read(a.number, all);
        int length = POINTER;
        const char *at = all + (size_t)x->all.step * POINTER;
        while (length > 0 && (at[length - 1] == ' ' || at[length - 1] == 0))
            length--;
        if (error == CG_OK && strlen(to) + POINTER + 3 <= room)
            text_add(to, room, "/%.*s/", length, at);
        mem_free(f->m, all);
        if (error != CG_OK)
            return cgns_file_failed(f, a.name);
    }
    return ST_OK;
}

/* Find a zone's solution that has the field at the step. Where nothing says which solutions are a
 * step's, one that is alone is all steps', and of as many as there are steps each is one's. */
static status find_solution(cgns_fields *x, const char *called, int zone, int *found) {
    const cgns_file *f = x->f;
    char pointers[POINTERS_MAX], name[CGNS_NAME], quoted[CGNS_NAME + 2];
    int solutions = 0, count = 0;
    *found = 0;
    status st = read_pointers(x, zone, pointers, sizeof pointers);
    if (st == ST_OK && cg_nsols(f->id, f->base, zone + 1, &solutions) != CG_OK)
        st = cgns_file_failed(f, "solutions");
    for (int s = 1; s <= solutions && st == ST_OK; s++) {
        import_owner owner;
        st = find_owner(f, zone, s, name, &owner);
        snprintf(quoted, sizeof quoted, "/%s/", name);
        if (st != ST_OK || owner != x->all.owner || (*pointers && !strstr(pointers, quoted)) ||
            !has_field(f, zone, s, called, x->name))
            continue;
        if (count == 0 || (!*pointers && (uint64_t)count == x->all.step))
            *found = s;
        count++;
    }
    if (st == ST_OK && !*pointers && count > 1 && (uint64_t)count != x->all.steps)
        st = status_describe(ST_UNSUPPORTED,
                             "%s: zone %d has %s in %d solutions, of %llu steps, and nothing says "
                             "which is a step's",
                             f->path, zone + 1, called, count, (unsigned long long)x->all.steps);
    return st;
}

static status turn_to(cgns_fields *x, uint32_t k) {
    status st = ST_OK;
    const char *called = import_fields_taken(&x->all, k);
    x->turned = k + 1;
    for (int z = 0; z < x->f->zone_count && st == ST_OK; z++)
        st = find_solution(x, called, z, &x->solutions[z]);
    mesh_average_release(&x->sums);
    x->sums = (mesh_average){0};
    return st;
}

/* ---- values ---- */

typedef struct place {
    const cgns_fields *x;
    int zone;
} place;

static status read_box(void *ctx, const cgsize_t lo[3], const cgsize_t hi[3], double *to) {
    const place *p = ctx;
    const cgns_fields *x = p->x;
    return cg_field_read(x->f->id, x->f->base, p->zone + 1, x->solutions[p->zone], x->name,
                         CGNS_ENUMV(RealDouble), lo, hi, to) == CG_OK
               ? ST_OK
               : cgns_file_failed(x->f, x->name);
}

static status read_nodes(cgns_fields *x, uint64_t first, size_t count, float *to) {
    double numbers[READ_NUMBERS];
    status st = ST_OK;
    for (size_t i = 0, some; i < count && st == ST_OK; i += some) {
        const int zone = cgns_file_zone(x->f, first + i);
        const cgns_zone *z = &x->f->zones[zone];
        const uint64_t at = first + i - z->first, left = z->nodes - at;
        some = count - i < READ_NUMBERS ? count - i : READ_NUMBERS;
        some = left < some ? (size_t)left : some;
        if (x->solutions[zone] > 0)
            st = cgns_file_boxes(z->dims, at, some, read_box, &(place){x, zone}, numbers);
        for (size_t k = 0; k < some && st == ST_OK; k++)
            to[i + k] = x->solutions[zone] > 0 ? (float)numbers[k] : NAN;
    }
    return st;
}

/* Values of a zone's cells, in order. */
typedef struct cell_values {
    int zone;
    uint64_t at, begun;
    size_t held;
    double numbers[READ_NUMBERS];
} cell_values;

static status next_value(const cgns_fields *x, cell_values *v, double *value) {
    const cgns_zone *z = &x->f->zones[v->zone];
    const uint64_t all = z->cells[0] * z->cells[1] * z->cells[2], i = v->at++;
    status st = ST_OK;
    if (v->held == 0 || i - v->begun >= v->held) {
        v->begun = i;
        v->held = all - i < READ_NUMBERS ? (size_t)(all - i) : READ_NUMBERS;
        st = cgns_file_boxes(z->cells, i, v->held, read_box, &(place){x, v->zone}, v->numbers);
    }
    *value = v->numbers[i - v->begun];
    return st;
}

static status add_polyhedron(cgns_fields *x, const mesh_polyhedron *p, double value) {
    x->room.m = x->f->m;
    const status st = mesh_polyhedron_reserve(&x->room, p);
    if (st == ST_OK)
        mesh_average_add_points(&x->sums, 0, x->room.ids, mesh_polyhedron_ids(p, x->room.ids),
                                value);
    return st;
}

static status add_cell(cgns_fields *x, const cgns_cell *cell, cell_values *v) {
    double value = 0;
    uint64_t wide[CELL_VERTICES_MAX];
    if (cell->zone != v->zone) {
        v->zone = cell->zone;
        v->at = 0;
        v->held = 0;
    }
    if (x->solutions[cell->zone] == 0)
        return ST_OK;
    status st = next_value(x, v, &value);
    if (st == ST_OK && cell->polyhedron.faces)
        return add_polyhedron(x, &cell->polyhedron, value);
    for (int i = 0; st == ST_OK && i < cell_shape_vertices(cell->shape); i++)
        wide[i] = cell->ids[i];
    if (st == ST_OK)
        mesh_average_add(&x->sums, 0, cell->shape, wide, value);
    return st;
}

/* Add all cells' values to the window of nodes. */
static status add_cells(cgns_fields *x, cgns_cells *cells) {
    cgns_walk *w = mem_alloc(x->f->m, sizeof *w);
    cell_values *v = mem_zalloc(x->f->m, sizeof *v);
    status st = w && v ? ST_OK : ST_NOMEM;
    bool more = st == ST_OK;
    if (more) {
        cgns_walk_begin(w, cells, CGNS_ALL);
        v->zone = -1;
    }
    while (st == ST_OK && more) {
        cgns_cell cell;
        st = cgns_walk_next(w, &cell, &more);
        if (st == ST_OK && more)
            st = add_cell(x, &cell, v);
    }
    mem_free(x->f->m, w);
    mem_free(x->f->m, v);
    return st;
}

/* Refuse a zone of which it is not clear whose values its solution has. */
static status check_counts(const cgns_fields *x, const cgns_cells *cells) {
    for (int i = 0; i < x->f->zone_count; i++) {
        const cgns_zone *z = &x->f->zones[i];
        const uint64_t told = z->cells[0] * z->cells[1] * z->cells[2];
        if (x->solutions[i] > 0 && told != cells->in_zone[i])
            return status_describe(ST_UNSUPPORTED,
                                   "%s: zone %d tells of %llu cells and has %llu: whose values a "
                                   "field of cells has is not clear",
                                   x->f->path, i + 1, (unsigned long long)told,
                                   (unsigned long long)cells->in_zone[i]);
    }
    return ST_OK;
}

static status read_means(cgns_fields *x, cgns_cells *cells, uint64_t first, size_t count,
                         float *to) {
    status st = ST_OK;
    for (size_t i = 0; i < count && st == ST_OK; i++) {
        const uint64_t node = first + i;
        const bool begins = !x->sums.m;
        if (begins)
            st = check_counts(x, cells);
        if (begins && st == ST_OK)
            st = mesh_average_begin_rounds(&x->sums, x->f->m, x->f->nodes, 1);
        if (st == ST_OK &&
            (begins || (node >= x->sums.first + x->sums.count && mesh_average_next(&x->sums))))
            st = add_cells(x, cells);
        if (st == ST_OK)
            to[i] = (float)mesh_average_value(&x->sums, 0, (size_t)(node - x->sums.first));
    }
    return st;
}

status cgns_fields_read(cgns_fields *x, cgns_cells *cells, uint32_t k, uint64_t first, size_t count,
                        float *to) {
    const status st = x->turned == k + 1 ? ST_OK : turn_to(x, k);
    if (st != ST_OK)
        return st;
    return x->all.owner == IMPORT_CELLS ? read_means(x, cells, first, count, to)
                                        : read_nodes(x, first, count, to);
}
