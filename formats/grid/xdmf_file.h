/* xdmf_file.h - read from an XDMF file (.xdmf, .xmf) the sizes, places and times of its grids, and
 * the file with the samples of each attribute.
 *
 * It holds one uniform grid, or a temporal collection of such grids. All files that it names are
 * checked to be there, and count as inputs. All else is kept for one step alone.
 */
#ifndef FORMATS_GRID_XDMF_FILE_H
#define FORMATS_GRID_XDMF_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/sample.h"
#include "formats/base/status.h"
#include "formats/input/byte_stream.h"

enum { XDMF_RANK = 4 };

/* An attribute of the nodes, or of the cells between them. */
typedef struct xdmf_field {
    char *name;
    char *file;   /* its path */
    char *inside; /* HDF5: the data set's path in it; NULL: raw samples */
    bool cells;
    uint64_t dims[XDMF_RANK]; /* sizes in the file's order, the slowest axis first */
    int rank;
    sample_type type; /* raw: type of a number */
    bool big_endian;
    uint64_t seek; /* raw: bytes in front */
} xdmf_field;

typedef struct xdmf_file {
    mem *m;
    uint32_t steps;
    double *times; /* times of all steps; NULL: some have none */
    /* the step asked for: */
    uint32_t nodes[3]; /* along x, y, z */
    double origin[3], spacing[3];
    double *axis[3]; /* the nodes' coordinates; NULL: they are regular */
    xdmf_field *fields;
    size_t count;
} xdmf_file;

/* xdmf_file_read() - read the XDMF file `path`; data stands at its start. Release *out in any case.
 * ST_USAGE for a step that is not there; ST_UNSUPPORTED for anything but grids along the axes;
 * ST_IO for a missing file; ST_CORRUPT. All name file and line. */
CHECKED status xdmf_file_read(mem *m, const char *path, byte_stream *data, bool follow_links,
                              uint32_t step, xdmf_file *out);
void xdmf_file_release(xdmf_file *x);

#endif
