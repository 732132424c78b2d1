#include "prep/import/cgns/cgns_file.h"

#include <string.h>

#include "formats/mesh/mesh_sink.h"
#include "prep/import/hdf5/hdf5_storage.h"

enum { AXES = 3, READ_NUMBERS = 2048 };

status cgns_file_failed(const cgns_file *f, const char *what) {
    const status st = hdf5_storage_denied();
    return st == ST_OK
               ? status_describe(ST_CORRUPT, "%s: %s: libcgns: %s", f->path, what, cg_get_error())
               : st;
}

/* ---- opening ---- */

static status open_library(cgns_file *f, const import_request *q) {
    status st = file_open(f->m, f->path, &f->guard);
    if (st == ST_OK)
        st = netcdf_storage_look(f->m, f->path, &q->trust, &f->storage);
    if (st == ST_OK && f->storage.count > 0 && !q->trust.allow_missing)
        st = status_describe(ST_CORRUPT,
                             "%s: parts of %s were never written (--allow-missing takes zeros)",
                             f->path, f->storage.lacks[0].path);
    if (st != ST_OK)
        return st;
    if (cg_open(f->path, CG_MODE_READ, &f->id) == CG_OK)
        return ST_OK;
    f->id = -1;
    return cgns_file_failed(f, "opening");
}

static status find_base(cgns_file *f) {
    int bases = 0;
    if (cg_nbases(f->id, &bases) != CG_OK)
        return cgns_file_failed(f, "bases");
    for (int b = 1; b <= bases && f->base == 0; b++) {
        char name[CGNS_NAME];
        int cell_axes, axes;
        if (cg_base_read(f->id, b, name, &cell_axes, &axes) != CG_OK)
            return cgns_file_failed(f, "a base");
        f->base = cell_axes == AXES && axes == AXES ? b : 0;
    }
    return f->base
               ? ST_OK
               : status_describe(ST_UNSUPPORTED, "%s: none of %d bases has cells of 3 dimensions",
                                 f->path, bases);
}

/* sizes: as the library gives them: nodes, cells, and what is no use here, each along i, j, k. */
static status take_sizes(cgns_file *f, cgns_zone *z, const cgsize_t sizes[9]) {
    const int axes = z->structured ? AXES : 1;
    const uint64_t most = MESH_POINTS_MAX - f->nodes;
    z->nodes = 1;
    z->first = f->nodes;
    for (int a = 0; a < AXES; a++) {
        const cgsize_t nodes = a < axes ? sizes[a] : 1, cells = a < axes ? sizes[axes + a] : 1;
        if (nodes < 0 || cells < 0 || (z->structured && cells != nodes - 1))
            return status_describe(ST_CORRUPT, "%s: zone %d has %lld nodes and %lld cells", f->path,
                                   f->zone_count + 1, (long long)nodes, (long long)cells);
        z->dims[a] = (uint64_t)nodes;
        z->cells[a] = (uint64_t)cells;
        if (z->nodes > 0 && z->dims[a] > most / z->nodes)
            return status_describe(ST_UNSUPPORTED, "%s: more than %llu nodes", f->path,
                                   (unsigned long long)MESH_POINTS_MAX);
        z->nodes *= z->dims[a];
    }
    f->nodes += z->nodes;
    f->zone_count++;
    return ST_OK;
}

/* Refuse another step than the first of nodes that move: the library reads only one grid's. */
static status check_grids(const cgns_file *f, int number, uint32_t step) {
    int grids = 0;
    if (cg_ngrids(f->id, f->base, number, &grids) != CG_OK)
        return cgns_file_failed(f, "grids");
    return grids <= 1 || step == 0
               ? ST_OK
               : status_describe(ST_UNSUPPORTED,
                                 "%s: zone %d has %d grids: nodes that move are read at step 0 "
                                 "alone",
                                 f->path, number, grids);
}

static status read_zone(cgns_file *f, cgns_zone *z, uint32_t step) {
    char name[CGNS_NAME];
    cgsize_t sizes[9] = {0};
    CGNS_ENUMT(ZoneType_t) type;
    const int number = f->zone_count + 1;
    if (cg_zone_type(f->id, f->base, number, &type) != CG_OK ||
        cg_zone_read(f->id, f->base, number, name, sizes) != CG_OK)
        return cgns_file_failed(f, "a zone");
    z->structured = type == CGNS_ENUMV(Structured);
    if (!z->structured && type != CGNS_ENUMV(Unstructured))
        return status_describe(ST_UNSUPPORTED, "%s: zone %d is of a type that is not known",
                               f->path, number);
    const status st = check_grids(f, number, step);
    return st == ST_OK ? take_sizes(f, z, sizes) : st;
}

static status read_zones(cgns_file *f, uint32_t step) {
    int zones = 0;
    if (cg_nzones(f->id, f->base, &zones) != CG_OK)
        return cgns_file_failed(f, "zones");
    f->zones = mem_array(f->m, (size_t)zones + 1, sizeof *f->zones);
    status st = f->zones ? ST_OK : ST_NOMEM;
    while (st == ST_OK && f->zone_count < zones)
        st = read_zone(f, &f->zones[f->zone_count], step);
    return st;
}

status cgns_file_open(mem *m, const import_request *q, cgns_file *f) {
    *f = (cgns_file){.m = m, .path = q->paths[0], .id = -1};
    status st = open_library(f, q);
    if (st == ST_OK)
        st = find_base(f);
    return st == ST_OK ? read_zones(f, q->step) : st;
}

void cgns_file_close(cgns_file *f) {
    mem_free(f->m, f->zones);
    if (f->id >= 0)
        cg_close(f->id);
    file_close(f->guard);
    netcdf_storage_release(&f->storage);
}

/* ---- reading ---- */

/* Find the largest box that begins at an index of an array and holds at most `most` of what follows
 * there: a part of a row, rows, or planes. Returns how much it holds. */
static uint64_t find_box(const uint64_t dims[3], uint64_t at, uint64_t most, cgsize_t lo[3],
                         cgsize_t hi[3]) {
    const uint64_t row = dims[0], plane = row * dims[1];
    const uint64_t from[3] = {at % row, at / row % dims[1], at / plane};
    uint64_t size[3] = {1, 1, 1};
    if (from[0] > 0 || most < row) {
        size[0] = most < row - from[0] ? most : row - from[0];
    } else if (from[1] > 0 || most < plane) {
        size[0] = row;
        size[1] = most / row < dims[1] - from[1] ? most / row : dims[1] - from[1];
    } else {
        size[0] = row;
        size[1] = dims[1];
        size[2] = most / plane;
    }
    for (int a = 0; a < AXES; a++) {
        lo[a] = (cgsize_t)from[a] + 1;
        hi[a] = (cgsize_t)(from[a] + size[a]);
    }
    return size[0] * size[1] * size[2];
}

status cgns_file_boxes(const uint64_t dims[3], uint64_t first, size_t count, cgns_box_reader *read,
                       void *ctx, double *to) {
    status st = ST_OK;
    for (size_t done = 0; done < count && st == ST_OK;) {
        cgsize_t lo[3], hi[3];
        const uint64_t some = find_box(dims, first + done, count - done, lo, hi);
        st = read(ctx, lo, hi, to + done);
        done += (size_t)some;
    }
    return st;
}

typedef struct coordinate {
    const cgns_file *f;
    int zone, axis;
} coordinate;

static status read_coordinate(void *ctx, const cgsize_t lo[3], const cgsize_t hi[3], double *to) {
    static const char *const names[AXES] = {"CoordinateX", "CoordinateY", "CoordinateZ"};
    const coordinate *c = ctx;
    const int error = cg_coord_read(c->f->id, c->f->base, c->zone + 1, names[c->axis],
                                    CGNS_ENUMV(RealDouble), lo, hi, to);
    if (error == CG_NODE_NOT_FOUND)
        return status_describe(ST_UNSUPPORTED, "%s: zone %d (counted from 1) has no %s", c->f->path,
                               c->zone + 1, names[c->axis]);
    return error == CG_OK ? ST_OK : cgns_file_failed(c->f, names[c->axis]);
}

int cgns_file_zone(const cgns_file *f, uint64_t node) {
    int z = 0;
    while (node - f->zones[z].first >= f->zones[z].nodes)
        z++;
    return z;
}

status cgns_file_points(const cgns_file *f, uint64_t first, size_t count, float (*xyz)[3]) {
    double numbers[READ_NUMBERS];
    status st = ST_OK;
    for (size_t i = 0, some; i < count && st == ST_OK; i += some) {
        const int zone = cgns_file_zone(f, first + i);
        const cgns_zone *z = &f->zones[zone];
        const uint64_t at = first + i - z->first, left = z->nodes - at;
        some = count - i < READ_NUMBERS ? count - i : READ_NUMBERS;
        some = left < some ? (size_t)left : some;
        for (int a = 0; a < AXES && st == ST_OK; a++) {
            st = cgns_file_boxes(z->dims, at, some, read_coordinate, &(coordinate){f, zone, a},
                                 numbers);
            for (size_t k = 0; k < some && st == ST_OK; k++)
                xyz[i + k][a] = (float)numbers[k];
        }
    }
    return st;
}
