/* leafcast_experimental.h - what leafcast.h can do for experiments and tests alone. It may change
 * in any version, also in ways other than growing structs.
 *
 *     leafcast_experiments by_packets = {.size = sizeof by_packets, .packets = 8};
 *     leafcast_options options = {.size = sizeof options, .experiments = &by_packets};
 *
 * A field that is 0 changes nothing. Sizes and values are checked as those of leafcast.h. The
 * library that is installed has no packets, kept isopolygons, approximate intersectors or media in
 * steps: asking for them is LEAFCAST_USAGE.
 */
#ifndef RENDER_LEAFCAST_EXPERIMENTAL_H
#define RENDER_LEAFCAST_EXPERIMENTAL_H

#include <leafcast.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- For a volume ---- */

/* How another time step of a mesh is brought in. The pictures are the same. */
typedef enum leafcast_schema {
    LEAFCAST_SCHEMA_AUTO = 0, /* trees, if all steps fit into half the budget or an eighth of the
                                 machine's memory; else refit */
    /* W07 6.1: every step's trees are read with its vertices, and stay as long as memory allows. */
    LEAFCAST_SCHEMA_TREES = 1,
    /* W07 6.2: one tree for all steps; only vertices are read, and the tree is refit. */
    LEAFCAST_SCHEMA_REFIT = 2
} leafcast_schema;

/* Which of a mesh's isopolygons stay in memory, inside the budget: none; or those of up to a third
 * of each treelet's tets, all made at once, or each when rays first come to it. The pictures are
 * the same. */
typedef enum leafcast_isopolygons {
    LEAFCAST_ISOPOLYGONS_ONTHEFLY = 0,
    LEAFCAST_ISOPOLYGONS_PRECOMPUTE,
    LEAFCAST_ISOPOLYGONS_CACHE
} leafcast_isopolygons;

/* leafcast_options.experiments: read only during the call. Ignored for devices. */
typedef struct leafcast_experiments {
    size_t size;
    uint32_t treelet_limit; /* at most so many treelets in memory at a time; 0: as memory allows */
    int packets; /* meshes: 0: tiles of rays; 2, 4, 8, 16: W07's packets with so many rays on a
                    side. The pictures are the same */
    leafcast_schema schema;
    leafcast_isopolygons isopolygons; /* not together with leafcast_options.neighbours */
} leafcast_experiments;

/* ---- For a scene ---- */

/* How to find where a ray meets the surface in a cell of a grid. With all but the first, rays go
 * one by one. */
typedef enum leafcast_intersector {
    LEAFCAST_MARMITT = 0, /* iterative root finding, converged: exact */
    LEAFCAST_MARMITT_3,   /* M08's fixed three steps */
    LEAFCAST_MIDPOINT,
    LEAFCAST_LINEAR,
    LEAFCAST_NEUBAUER,
    LEAFCAST_SCHWARZE
} leafcast_intersector;

/* How to sum up a medium's light along a ray. All but the first are for comparison: their error is
 * unknown, so image.error is +inf and all pixels are uncertified. They draw one volume without
 * surfaces, in steps of `step` times leafcast_info.cell_size, and end a ray at an opacity of
 * `opaque`. */
typedef enum leafcast_summing {
    LEAFCAST_CERTIFIED = 0,
    LEAFCAST_STEPS,        /* colour and extinction at the middle of each step */
    LEAFCAST_PREINTEGRATED /* from the values at both ends of each step, by a table */
} leafcast_summing;

#define LEAFCAST_STEP_LEAST 1e-4
#define LEAFCAST_STEP_MOST  1e4

/* leafcast_scene.experiments: read only during the call; frames copy it. */
typedef struct leafcast_scene_experiments {
    size_t size;
    leafcast_intersector intersector;
    /* Media in a grid, if above 0: nodes and treelets whose values differ by at most this are drawn
     * as if they had one value, their middle. M08 4.5 goes up to 1/512 of the volume's range.
     * leafcast_image.error includes the error of that. 0: only where the error asked for allows
     * it. */
    double homogeneous;
    leafcast_summing summing;
    double step;   /* LEAFCAST_STEP_LEAST to LEAFCAST_STEP_MOST */
    double opaque; /* above 0 to 1; 0: 0.9999 */
    int table;     /* LEAFCAST_PREINTEGRATED: entries a side, 16 to 2048; 0: 256 */
} leafcast_scene_experiments;

#ifdef __cplusplus
}
#endif

#endif
