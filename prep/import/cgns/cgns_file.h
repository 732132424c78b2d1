/* cgns_file.h - the zones of a CGNS file, HDF5 or ADF: of its first base of three dimensions.
 *
 * A zone's nodes follow those of the zones before it. Nodes that zones share come twice. Structured
 * zones are read by boxes, unstructured ones by runs.
 */
#ifndef PREP_IMPORT_CGNS_CGNS_FILE_H
#define PREP_IMPORT_CGNS_CGNS_FILE_H

#include <cgnslib.h>
#include <stdbool.h>
#include <stdint.h>

#include "formats/base/file.h"
#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "prep/import/importer.h"
#include "prep/import/netcdf/netcdf_storage.h"

enum { CGNS_NAME = 33 };

typedef struct cgns_zone {
    bool structured;
    uint64_t dims[3];      /* nodes along i, j, k; of an unstructured one: all, 1, 1 */
    uint64_t cells[3];     /* likewise; of an unstructured one: those of three dimensions */
    uint64_t nodes, first; /* their number; and of its first node in the mesh */
} cgns_zone;

typedef struct cgns_file {
    mem *m;
    const char *path;
    int id, base; /* the library's; id -1: it is not open */
    netcdf_storage storage;
    file *guard;      /* the same file, opened so that the guard knows it as an input */
    cgns_zone *zones; /* the library counts from 1 */
    int zone_count;
    uint64_t nodes; /* of all zones */
} cgns_file;

/* cgns_file_open() - ST_UNSUPPORTED: no base has three dimensions. cgns_file_close() - also if that
 * failed. cgns_file_failed() - what the library said. */
CHECKED status cgns_file_open(mem *m, const import_request *q, cgns_file *f);
void cgns_file_close(cgns_file *f);
CHECKED status cgns_file_failed(const cgns_file *f, const char *what);

/* Read numbers of a box of a zone's array; its corners count from 1, and are part of it. */
typedef status cgns_box_reader(void *ctx, const cgsize_t lo[3], const cgsize_t hi[3], double *to);

/* cgns_file_boxes() - read `count` numbers from `first` on of an array of `dims`, the first
 * fastest, as boxes. */
CHECKED status cgns_file_boxes(const uint64_t dims[3], uint64_t first, size_t count,
                               cgns_box_reader *read, void *ctx, double *to);

/* cgns_file_points() - positions of `count` nodes of the mesh from `first` on. */
CHECKED status cgns_file_points(const cgns_file *f, uint64_t first, size_t count, float (*xyz)[3]);

/* cgns_file_zone() - the zone of a node of the mesh, from 0 on. */
int cgns_file_zone(const cgns_file *f, uint64_t node);

#endif
