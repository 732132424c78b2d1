/* leafcast_prep.h - the public interface, second part: make a treelet file of a file, of slices
 * that a function delivers, of an array, or of tetrahedra in memory.
 *
 *     leafcast_grid grid = {sizeof grid, {256, 256, 128}, LEAFCAST_U8};
 *     if (leafcast_convert_array(&grid, samples, NULL, "engine.leaf", NULL) != LEAFCAST_OK)
 *         return complain(leafcast_error_text());
 *     leafcast_open("engine.leaf", NULL, &volume);
 *
 * Statuses, struct sizes and enumerations are as in leafcast.h, and so are arguments: every field
 * is looked at, used or not, and what is wrong is LEAFCAST_USAGE, whose text names it. The same
 * samples and parameters give the same bytes as `leafcast convert` does, whatever the threads and
 * the memory.
 *
 * Outputs. A file appears under its name when it is complete and on the disk; until then, and after
 * any failure or cancel, nothing is there. It is written as OUT.partial-1, and what does not fit
 * into memory goes through files beside it that have no name. A process that limits its files'
 * sizes (RLIMIT_FSIZE) ignores SIGXFSZ, to get LEAFCAST_NOSPACE and not a signal.
 *
 * Threads. Calls are independent of each other, and may be made by several threads at once. A call
 * uses threads of its own, which end with it and have the caller's signal mask. Of the caller's
 * code they run what is said here.
 *
 * One library with the viewing half: that half pays for this one with 330 KB of code that is not
 * loaded until it is used, and with zlib, jansson and expat, which are 0.1 ms of a program's start;
 * readers and writers of treelet files would be there twice otherwise.
 */
#ifndef PREP_LEAFCAST_PREP_H
#define PREP_LEAFCAST_PREP_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <leafcast_status.h>

#ifdef __cplusplus
extern "C" {
#endif

/* All zero but `size` is the default, as that of `leafcast convert`. What is of grids changes
 * nothing of a mesh, and the other way round. */
typedef struct leafcast_convert_options {
    size_t size;
    uint64_t memory;  /* bytes, without the caller's own; 0: 2 GiB */
    int threads;      /* to LEAFCAST_THREADS_MAX; 0: the CPUs this process may use */
    bool replace;     /* an output that is there, and is a treelet file or empty, gives way. Nothing
                         else ever does; one that is an input, by any name, or that an input leads
                         to (slices of a folder, samples beside a header), is LEAFCAST_USAGE */
    int zstd_level;   /* payloads: 1 to 22, or 0: as they are */
    bool allow_empty; /* convert what has no finite value, too; else LEAFCAST_UNSUPPORTED */
    const char *name; /* of the data set; NULL: as the input says */

    /* Told how far it is: the phase, the share of the whole job. False ends it with
     * LEAFCAST_STOPPED, soon. One call at a time, by any thread. NULL: not told. */
    bool (*watch)(void *ctx, const char *phase, double done);
    void *watch_ctx;

    /* Grids. */
    uint32_t treelet_cells; /* of a treelet, per axis: 16, 32 or 64; 0: 32 */
    bool without_halo;      /* no samples around treelets: normals need the neighbours' */
    bool has_missing;
    double missing; /* this value stands for no data; integers are then kept as f32. Any value */

    /* Meshes. */
    bool gradients;        /* store that of each vertex, too, for smooth normals */
    bool coarse;           /* with a grid of the values, for previews, */
    uint32_t coarse_dims;  /* of so many nodes along the longest edge, 2 to 2^20; 0: as suits the
                              mesh */
    uint32_t treelet_tets; /* in a treelet at most, to 16384; 0: 4096 */
    uint32_t leaf_tets;    /* in a leaf of its tree at most, to 64; 0: 12 */

    /* Meshes in files: arrays to take, by name; none: the first of the points. */
    const char *const *fields;
    uint32_t field_count; /* to 65536 */
    int component;        /* of vectors: 1, 2, ..; 0: their magnitude */
    bool cells_to_points; /* take arrays of the cells, averaged to the points */

    /* Grids in files. What they are refused for otherwise: */
    bool follow_links;  /* they may name files outside of their folder */
    bool allow_missing; /* parts that they lack may all be the fill value */

    /* Grids: factor on the world's z, where degrees stand beside metres: 1e-100 to 1e100; 0: 1. */
    double exaggerate;
} leafcast_convert_options;

/* ---- From files ---- */

/* leafcast_convert_path() - a file as `leafcast convert` takes it: NRRD, MetaImage, NIfTI,
 * NumPy, MRC, PVM, a Zarr folder, raw samples with their dimensions in the name or in a JSON beside
 * them; a mesh of TetGen, VTK, Gmsh, a mesh stream; of a file of several steps the first. A named
 * pipe's writer is waited for, whatever watch() says; standard input is refused.
 * leafcast_convert_steps() - several meshes of the same tets, whose points may move: the steps of a
 * time series. times: ascending; NULL: 0, 1, .. options
 * may be NULL. */
LEAFCAST_API leafcast_status leafcast_convert_path(const char *in, const char *out,
                                                   const leafcast_convert_options *options);
LEAFCAST_API leafcast_status leafcast_convert_steps(const char *const *in, uint32_t steps,
                                                    const double *times, const char *out,
                                                    const leafcast_convert_options *options);

/* ---- Grids ---- */

typedef enum leafcast_sample_type {
    LEAFCAST_U8 = 1,
    LEAFCAST_I8 = 2,
    LEAFCAST_U16 = 3,
    LEAFCAST_I16 = 4,
    LEAFCAST_F32 = 5,
    LEAFCAST_U32 = 6, /* this and the following are kept as f32 */
    LEAFCAST_I32 = 7,
    LEAFCAST_F64 = 8
} leafcast_sample_type;

/* Samples at the nodes of a grid, in the machine's own byte order; cells lie between eight nodes.
 * Node (i, j, k) is at to_world (i, j, k, 1), or at to_world (axis[0][i], axis[1][j], axis[2][k],
 * 1).
 */
typedef struct leafcast_grid {
    size_t size;
    uint32_t dims[3]; /* 2 to 2^20 on each axis */
    leafcast_sample_type type;
    double spacing[3]; /* of magnitude 1e-100 to 1e100; 0: 1 */
    double origin[3];  /* of node (0, 0, 0); within 1e100 */
    /* 12 numbers, 3 rows of 4, within 1e100: in place of spacing and origin. NULL: as those say. */
    const double *to_world;
    /* Of a rectilinear grid: coordinates, ascending or descending. NULL: 0, 1, 2, .. */
    const double *axis[3];
} leafcast_grid;

/* leafcast_convert_slices() - slice is called for z = 0, 1, .. dims[2] - 1, each once and in order,
 * by one thread, which is none of the caller's: it fills dims[0] * dims[1] samples, x fastest.
 * Another status than LEAFCAST_OK ends the conversion, and becomes its status. A conversion that
 * ends for another reason waits for the call that is under way. */
typedef leafcast_status (*leafcast_slice)(void *ctx, uint32_t z, void *samples);
LEAFCAST_API leafcast_status leafcast_convert_slices(const leafcast_grid *grid,
                                                     leafcast_slice slice, void *ctx,
                                                     const char *out,
                                                     const leafcast_convert_options *options);

/* leafcast_convert_array() - samples: node (0, 0, 0). strides: bytes from a node to the next along
 * x, y and z, of any sign; NULL: without gaps, x fastest. */
LEAFCAST_API leafcast_status leafcast_convert_array(const leafcast_grid *grid, const void *samples,
                                                    const ptrdiff_t strides[3], const char *out,
                                                    const leafcast_convert_options *options);

/* ---- Tetrahedra ---- */

typedef struct leafcast_tets {
    size_t size;
    uint64_t vertex_count, tet_count; /* below 2^32 - 1, and to 2^56 */
    const float (*vertices)[3];       /* finite */
    const float *values;              /* one a vertex */
    /* Of either orientation. Those with a vertex twice, or with one that is not there, are left
     * out. */
    const uint32_t (*tets)[4];
    const char *field; /* name of the values; may be NULL */
} leafcast_tets;

LEAFCAST_API leafcast_status leafcast_convert_tets(const leafcast_tets *tets, const char *out,
                                                   const leafcast_convert_options *options);

#ifdef __cplusplus
}
#endif

#endif
