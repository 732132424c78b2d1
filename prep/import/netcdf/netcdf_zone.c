#include "prep/import/netcdf/netcdf_zone.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/text.h"
#include "formats/curvilinear/curvilinear_source.h"
#include "formats/leaf/curvilinear_zones.h"
#include "prep/import/netcdf/netcdf_columns.h"
#include "prep/import/netcdf/netcdf_heights.h"
#include "prep/import/netcdf/netcdf_slices.h"

typedef char field_name[MESH_NAME_MAX + 1];

typedef struct zone {
    mem *m;
    import_request q; /* its fields are those that are taken, at least one */
    const char *first[1];
    netcdf_file file;
    netcdf_frame frame;
    netcdf_columns columns;
    netcdf_heights heights;
    uint32_t nodes[1][3]; /* of the zone: a column more along x where it closes */
    field_name *names;
    const char **further;
    /* The field that is read: */
    uint32_t field; /* from 1; 0: none */
    slice_source source;
    absent_parts absent;    /* of the fields so far */
    uint32_t next;          /* its next plane */
    void *raw;              /* a plane as it is stored */
    double *plane;          /* and as numbers */
    char path[NETCDF_PATH]; /* of the variable that the frame is of */
} zone;

static void close_zone(void *ctx) {
    zone *z = ctx;
    mem *m = z->m;
    slice_source_close(&z->source);
    netcdf_heights_release(&z->heights);
    netcdf_columns_release(&z->columns);
    netcdf_file_close(&z->file);
    mem_free(m, z->names);
    mem_free(m, z->further);
    mem_free(m, z->raw);
    mem_free(m, z->plane);
    mem_free(m, z);
}

/* ---- nodes ---- */

/* Node n of the zone: its column in the frame, and its level. */
typedef struct node {
    uint32_t i, j, k;
    size_t column;
} node;

static node node_of(const zone *z, uint64_t n) {
    const uint32_t *size = z->nodes[0];
    node x = {.i = (uint32_t)(n % size[0]),
              .j = (uint32_t)(n / size[0] % size[1]),
              .k = (uint32_t)(n / size[0] / size[1])};
    x.column = (size_t)x.j * z->frame.n[0] + (x.i == z->frame.n[0] ? 0 : x.i);
    return x;
}

/* Find a node's place. Returns whether it has one. */
static bool find_place(const zone *z, const node *x, float p[3]) {
    double at[3];
    const double height = netcdf_heights_at(&z->heights, x->column, x->k) * z->q.exaggerate;
    netcdf_columns_place(&z->columns, x->column, height, at);
    bool is = true;
    for (int a = 0; a < 3; a++) {
        p[a] = (float)at[a];
        is = is && isfinite(p[a]);
    }
    return is;
}

/* Refuse a globe that is turned inside out. */
static status check_depth(const zone *z, const node *x) {
    const double height = netcdf_heights_at(&z->heights, x->column, x->k);
    if (!z->columns.sphere || !(height * z->q.exaggerate <= -NETCDF_EARTH))
        return ST_OK;
    return status_describe(ST_USAGE,
                           "%s: --exaggerate %g: a height of %g m would lie behind the centre of "
                           "the globe",
                           file_path(z->file.guard), z->q.exaggerate, height);
}

static status give_points(void *ctx, uint64_t first, size_t count, float (*xyz)[3]) {
    zone *z = ctx;
    status st = ST_OK;
    for (size_t i = 0; i < count && st == ST_OK; i++) {
        const node x = node_of(z, first + i);
        st = netcdf_heights_turn(&z->heights, x.k);
        if (st == ST_OK)
            st = check_depth(z, &x);
        if (st == ST_OK && !find_place(z, &x, xyz[i]))
            memset(xyz[i], 0, sizeof xyz[i]);
    }
    return st;
}

/* Whether the cell that begins at a node would reach across the plane. */
static bool is_torn(const zone *z, const node *x) {
    const netcdf_columns *c = &z->columns;
    const size_t row = z->frame.n[0], n = x->column;
    if (!c->seam || x->i + 1 >= z->frame.n[0] || x->j + 1 >= z->frame.n[1])
        return false;
    return netcdf_columns_is_torn(c, n, n + 1) || netcdf_columns_is_torn(c, n, n + row) ||
           netcdf_columns_is_torn(c, n, n + row + 1);
}

static status give_blanks(void *ctx, uint64_t first, size_t count, uint8_t *to) {
    zone *z = ctx;
    status st = ST_OK;
    for (size_t i = 0; i < count && st == ST_OK; i++) {
        float p[3];
        const node x = node_of(z, first + i);
        st = netcdf_heights_turn(&z->heights, x.k);
        if (st == ST_OK)
            to[i] = !find_place(z, &x, p) ? 0
                    : is_torn(z, &x)      ? CURVILINEAR_NODE | CURVILINEAR_HIDDEN
                                          : CURVILINEAR_NODE;
    }
    return st;
}

/* ---- values ---- */

static status begin_field(zone *z, uint32_t field) {
    const netcdf_wish wish = {.indices = true};
    import_request one = z->q;
    one.field = z->q.fields[field];
    slice_source_close(&z->source);
    z->field = field + 1;
    z->next = 0;
    const status st = netcdf_slices_open_in(&z->file, &one, &wish, &z->source);
    if (st == ST_OK)
        absent_add(&z->absent, &z->source.g.absent);
    return st;
}

static status next_plane(zone *z) {
    const status st = z->source.read(z->source.ctx, z->next, 1, z->raw);
    if (st == ST_OK)
        (void)sample_to_doubles(z->source.g.type, z->raw, z->plane, z->frame.columns);
    z->next++;
    return st;
}

static status give_values(void *ctx, uint32_t field, uint64_t first, size_t count, float *to) {
    zone *z = ctx;
    status st = z->field == field + 1 ? ST_OK : begin_field(z, field);
    for (size_t i = 0; i < count && st == ST_OK; i++) {
        const node x = node_of(z, first + i);
        if (x.k == z->next)
            st = next_plane(z);
        to[i] = (float)z->plane[x.column];
    }
    return st;
}

/* ---- opening ---- */

/* Whether two variables lie on the same nodes, at the same steps. */
static bool are_alike(const netcdf_variable *a, const netcdf_variable *b) {
    return a->rank == b->rank && memcmp(a->dim, b->dim, (size_t)a->rank * sizeof *a->dim) == 0;
}

static void judge(const netcdf_variable *taken, netcdf_variable *v) {
    if (!are_alike(taken, v))
        snprintf(v->refuse, sizeof v->refuse, "it lies on other nodes than %.100s, which is taken",
                 taken->path);
}

static status check_nodes(zone *z) {
    netcdf_frame *fr = &z->frame;
    for (int a = 0; a < 3; a++) {
        const size_t n = fr->v.count[fr->v.rank - 1 - a];
        if (n < 2 || n > CURVILINEAR_NODES_MAX)
            return status_describe(ST_UNSUPPORTED, "%s: %s: %zu nodes along %c, expected 2 to %d",
                                   file_path(z->file.guard), fr->v.path, n, "xyz"[a],
                                   CURVILINEAR_NODES_MAX);
        fr->n[a] = (uint32_t)n;
    }
    fr->columns = (size_t)fr->n[0] * fr->n[1];
    return ST_OK;
}

/* The first variable, or the one that is found, is the frame's. */
static status find_frame(zone *z, const netcdf_wish *wish) {
    import_request first = z->q;
    first.field = z->q.field_count ? z->q.fields[0] : NULL;
    z->frame.f = &z->file;
    status st = netcdf_choice_find(&z->file, &first, wish, &z->frame.v);
    if (st == ST_OK)
        st = netcdf_choice_start(&z->q, &z->frame.v, z->frame.start);
    if (st == ST_OK && z->q.field_count == 0) {
        memcpy(z->path, z->frame.v.path, sizeof z->path);
        z->first[0] = z->path;
        z->q.fields = z->first;
        z->q.field_count = 1;
    }
    return st == ST_OK ? check_nodes(z) : st;
}

/* See that all variables lie on the frame's nodes, and note their names. */
static status check_fields(zone *z, const netcdf_wish *wish) {
    const uint32_t count = z->q.field_count;
    netcdf_variable *v = mem_alloc(z->m, sizeof *v);
    z->names = mem_array(z->m, count, sizeof *z->names);
    z->further = mem_array(z->m, count, sizeof *z->further);
    status st = v && z->names && z->further ? ST_OK : ST_NOMEM;
    for (uint32_t i = 0; i < count && st == ST_OK; i++) {
        import_request one = z->q;
        one.field = z->q.fields[i];
        st = netcdf_choice_find(&z->file, &one, wish, v);
        if (st == ST_OK && !are_alike(&z->frame.v, v))
            st = status_describe(ST_USAGE, "%s: %s lies on other nodes than %s",
                                 file_path(z->file.guard), v->path, z->frame.v.path);
        text_name(z->names[i], sizeof *z->names, z->q.fields[i]);
        for (uint32_t k = 0; k < i && st == ST_OK; k++)
            if (strcmp(z->names[k], z->names[i]) == 0)
                st = status_describe(ST_USAGE,
                                     "--field %s: each field is taken once, by the first %d bytes "
                                     "of its name",
                                     z->q.fields[i], MESH_NAME_MAX);
        if (i > 0)
            z->further[i - 1] = z->names[i];
    }
    mem_free(z->m, v);
    return st;
}

static status open_zone(zone *z, const netcdf_wish *wish) {
    status st = netcdf_file_open(z->m, &z->q, &z->file);
    if (st == ST_OK)
        st = find_frame(z, wish);
    if (st == ST_OK)
        st = check_fields(z, wish);
    if (st == ST_OK)
        st = netcdf_columns_find(&z->frame, strcmp(z->q.to, "sphere") == 0, &z->columns);
    if (st == ST_OK)
        st = netcdf_heights_find(&z->frame, &z->q, &z->heights);
    if (st != ST_OK)
        return st;
    for (int a = 0; a < 3; a++)
        z->nodes[0][a] = z->frame.n[a] + (a == 0 && z->columns.closes ? 1 : 0);
    z->raw = mem_array(z->m, z->frame.columns, sizeof(double));
    z->plane = mem_array(z->m, z->frame.columns, sizeof *z->plane);
    return z->raw && z->plane ? ST_OK : ST_NOMEM;
}

static void describe(zone *z, import_mesh *out) {
    const uint32_t *n = z->nodes[0];
    *out = (import_mesh){.ctx = z,
                         .points = give_points,
                         .values = give_values,
                         .close = close_zone,
                         .zones = (const uint32_t(*)[3])z->nodes,
                         .zone_count = 1,
                         .absent = &z->absent,
                         .blanks = give_blanks, /* other steps may have other gaps */
                         .still = !z->columns.moves && !z->heights.moves};
    out->header.points = (uint64_t)n[0] * n[1] * n[2];
    strcpy(out->header.field, z->names[0]);
    out->header.fields = z->further;
    out->header.field_count = z->q.field_count - 1;
}

status netcdf_zone_open(mem *m, const import_request *q, const netcdf_wish *wish,
                        import_mesh *out) {
    zone *z = mem_zalloc(m, sizeof *z);
    if (!z)
        return ST_NOMEM;
    z->m = m;
    z->q = *q;
    z->file.id = -1;
    const status st =
        wish->indices ? status_describe(ST_USAGE, "--indices leaves places aside, and --to asks "
                                                  "for them")
                      : open_zone(z, wish);
    if (st == ST_OK)
        describe(z, out);
    else
        close_zone(z);
    return st;
}

status netcdf_zone_list(mem *m, const import_request *q, const netcdf_wish *wish,
                        const import_list *to) {
    import_mesh x = {0};
    status st = to->grid ? netcdf_zone_open(m, q, wish, &x) : ST_OK;
    if (st == ST_OK && to->grid)
        st = to->grid(to->ctx, &x);
    import_mesh_close(&x);
    netcdf_file f = {.id = -1};
    if (st == ST_OK)
        st = netcdf_file_open(m, q, &f);
    if (st == ST_OK)
        st = netcdf_choice_list(&f, q, wish, judge, to);
    netcdf_file_close(&f);
    return st;
}
