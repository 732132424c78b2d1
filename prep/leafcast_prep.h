/* leafcast_prep.h - the public interface, second part: make a treelet file from a file, from slices
 * that a function delivers, from an array, or from tetrahedra in memory.
 *
 *     leafcast_grid grid = {sizeof grid, {256, 256, 128}, LEAFCAST_U8};
 *     if (leafcast_convert_array(&grid, samples, NULL, "engine.leaf", NULL) != LEAFCAST_OK)
 *         return complain(leafcast_error_text());
 *     leafcast_open("engine.leaf", NULL, &volume);
 *
 * Statuses, struct sizes, enumerations and arguments are as in leafcast.h: every field is checked,
 * used or not; a wrong one is LEAFCAST_USAGE, and the text names it. The same samples and
 * parameters give the same bytes as `leafcast convert` does, whatever the threads and the memory.
 *
 * Outputs. A file appears under its name when it is complete and on the disk. Until then, and after
 * any failure or cancel, no such file exists. It is written as OUT.partial-1. What does not fit
 * into memory goes through nameless files beside it. A process that limits its files' sizes
 * (RLIMIT_FSIZE) must ignore SIGXFSZ, to get LEAFCAST_NOSPACE and not a signal.
 *
 * Threads. Calls are independent of each other, and several threads may make them at once. A call
 * uses threads of its own, which end with it and have the caller's signal mask. They run only those
 * functions of the caller that are named here.
 *
 * One library with the viewing half: separate ones would both contain the readers and writers of
 * treelet files. The viewing half pays with 330 KB of code that is not loaded until used, and with
 * zlib, jansson and expat, which take 0.1 ms of a program's start.
 */
#ifndef PREP_LEAFCAST_PREP_H
#define PREP_LEAFCAST_PREP_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <leafcast_grid.h>
#include <leafcast_status.h>

#ifdef __cplusplus
extern "C" {
#endif

/* All zero but `size` gives the defaults of `leafcast convert`. Options for grids do not affect
 * meshes, nor those for meshes grids. Surfaces of triangles go with the options for meshes, but for
 * gradients, coarse, leaf_tets and whole_cells: LEAFCAST_USAGE. */
/* Where the normals of a surface's vertices come from: from the file, if it has any, or else there
 * are none; made of the triangles around each, those weighted by their areas; or there are none. */
typedef enum leafcast_surface_normals {
    LEAFCAST_NORMALS_FILE,
    LEAFCAST_NORMALS_SMOOTH,
    LEAFCAST_NORMALS_FLAT
} leafcast_surface_normals;

typedef struct leafcast_convert_options {
    size_t size;
    uint64_t memory;  /* in bytes, not counting the caller's own; 0: 2 GiB */
    int threads;      /* to LEAFCAST_THREADS_MAX; 0: the CPUs this process may use */
    bool replace;     /* replace an existing output if it is a treelet file or empty. Nothing else
                         is ever replaced. An output that is an input, by any name, or that an input
                         leads to (slices of a folder, samples beside a header), is
                         LEAFCAST_USAGE */
    int zstd_level;   /* compress payloads: 1 to 22; 0: not at all */
    bool allow_empty; /* convert data without any finite value, too; else LEAFCAST_UNSUPPORTED */
    const char *name; /* of the data set; NULL: as the input says */

    /* Told how far the job is: the phase, the share of the whole job done. If it returns false, the
     * job soon ends with LEAFCAST_STOPPED. One call at a time, from any thread. NULL: not told. */
    bool (*watch)(void *ctx, const char *phase, double done);
    void *watch_ctx;

    /* Grids. */
    uint32_t treelet_cells; /* cells per axis of a treelet: 16, 32 or 64; 0: 32 */
    bool without_halo;      /* store no samples around treelets: normals need the neighbours'
                               treelets */
    bool has_missing;
    double missing; /* the value that stands for no data, any value; integers are then kept as
                       f32 */

    /* Meshes. */
    bool gradients;        /* store the gradient at each vertex, too, for smooth normals */
    bool coarse;           /* store a grid of the values, too, for previews, */
    uint32_t coarse_dims;  /* with so many nodes along the longest edge, 2 to 2^20; 0: as suits the
                              mesh; of a curvilinear grid its own with fewer nodes, too */
    uint32_t treelet_tets; /* at most in a treelet, to 16384; 0: 4096 */
    uint32_t leaf_tets;    /* at most in a leaf of a treelet's tree, to 64; 0: 12 */

    /* Meshes in files: names of the arrays to take; none: the first of the points. */
    const char *const *fields;
    uint32_t field_count; /* to 65536 */
    int component;        /* of vector arrays: 1, 2, ..; 0: the magnitude */
    bool cells_to_points; /* take arrays of cells, averaged to the points */

    /* Grids in files. Unless these are set, such files are refused: */
    bool follow_links;  /* files that name files outside of their folder */
    bool allow_missing; /* files that lack parts, whose samples may all be the fill value */

    /* Grids: factor for the world's z, where degrees stand beside metres: 1e-100 to 1e100; 0: 1. */
    double exaggerate;

    /* Grids: store no samples of coarse levels of detail. Exact pictures need none. */
    bool without_levels;

    /* Meshes: keep hexahedra, wedges and pyramids as they are, each with its own interpolant; else
     * they are split into tets. Without gradients and leaf_tets, and with
     * treelet_tets to 6553; else LEAFCAST_USAGE. */
    bool whole_cells;

    /* Meshes in files: take cells of higher order as linear ones of their corners, without what
     * they hold in between; else they are refused. */
    bool by_corners;

    /* Surfaces: normals at the vertices, by which triangles are shaded. Where vertices move, of
     * each step. */
    leafcast_surface_normals normals;
} leafcast_convert_options;

/* ---- From files ---- */

/* leafcast_convert_path() - converts a file as `leafcast convert` takes it. Grids: NRRD, MetaImage,
 * NIfTI, VTK, NumPy, MRC, FreeSurfer, PVM, SLC, XDMF, a Zarr folder, raw samples with their
 * dimensions in the name or in a JSON beside them. Meshes: TetGen, VTK, Gmsh, a mesh stream.
 * Curvilinear grids: VTK. Surfaces: PLY, STL, OBJ, OFF, VTK, glTF. Of several steps the first.
 * Waits for a named pipe's writer, whatever watch() says; refuses standard input.
 * leafcast_convert_steps() - converts several meshes of the same tets, surfaces of the same
 * triangles, or curvilinear grids of the same numbers of nodes, whose points may move, as the steps
 * of a time series. times: ascending; NULL: 0, 1, .. options may be NULL. */
LEAFCAST_API leafcast_status leafcast_convert_path(const char *in, const char *out,
                                                   const leafcast_convert_options *options);
LEAFCAST_API leafcast_status leafcast_convert_steps(const char *const *in, uint32_t steps,
                                                    const double *times, const char *out,
                                                    const leafcast_convert_options *options);

/* ---- Grids: leafcast_grid.h describes them ---- */

/* leafcast_convert_slices() - calls slice for z = 0, 1, .. dims[2] - 1, each once and in order,
 * from one thread, which is none of the caller's. slice fills dims[0] * dims[1] samples, x fastest.
 * If it returns anything but LEAFCAST_OK, the conversion ends with that status. A conversion that
 * ends for another reason first waits for a call of slice under way. */
typedef leafcast_status (*leafcast_slice)(void *ctx, uint32_t z, void *samples);
LEAFCAST_API leafcast_status leafcast_convert_slices(const leafcast_grid *grid,
                                                     leafcast_slice slice, void *ctx,
                                                     const char *out,
                                                     const leafcast_convert_options *options);

/* leafcast_convert_array() - samples: address of node (0, 0, 0). strides: bytes from a node to the
 * next along x, y and z, of any sign; NULL: no gaps, x fastest. */
LEAFCAST_API leafcast_status leafcast_convert_array(const leafcast_grid *grid, const void *samples,
                                                    const ptrdiff_t strides[3], const char *out,
                                                    const leafcast_convert_options *options);

/* ---- Tetrahedra ---- */

typedef struct leafcast_tets {
    size_t size;
    uint64_t vertex_count, tet_count; /* vertices below 2^32 - 1; tets to 2^56 */
    const float (*vertices)[3];       /* finite */
    const float *values;              /* one per vertex */
    /* Of either orientation. Tets with a vertex twice, or with a vertex that does not exist, are
     * left out. */
    const uint32_t (*tets)[4];
    const char *field; /* name of the values; may be NULL */
} leafcast_tets;

LEAFCAST_API leafcast_status leafcast_convert_tets(const leafcast_tets *tets, const char *out,
                                                   const leafcast_convert_options *options);

#ifdef __cplusplus
}
#endif

#endif
