/* leafcast.h - the public interface: open a treelet file, select isosurfaces, trace pictures,
 * close.
 *
 *     leafcast *volume;
 *     if (leafcast_open("engine.leaf", NULL, &volume) != LEAFCAST_OK)
 *         return complain(leafcast_error_text());
 *     leafcast_surface skin = leafcast_surface_default(80);
 *     leafcast_select(volume, &skin, 1);
 *     leafcast_trace(volume, &scene, &camera, &image, &stats, NULL, NULL);
 *     leafcast_close(volume);
 *
 * leafcast_look.h has scenes, cameras and suggestions; leafcast_dynamic.h triangles that move;
 * leafcast_prep.h makes such files. No globals, no output, no exit. Vectors are (x, y, z), in world
 * space unless said otherwise.
 *
 * Errors. Every call that can fail returns a leafcast_status; leafcast_error_text() then says more,
 * for the calling thread. A volume stays usable after any failure: the next call starts afresh.
 *
 * Arguments. Every call checks all its arguments before it does anything: pointers, and every field
 * of every struct, used or not, against the range given at its declaration. A wrong argument is
 * LEAFCAST_USAGE, and the text names the field. Numbers must be finite unless said otherwise. A
 * pointer may be NULL only where that is said, or where its array has no elements. All others must
 * point to as much memory as the call needs, which cannot be checked. A struct that is all zero
 * except `size` is valid, but for cameras, surfaces and slices.
 *
 * Sizes. A struct with a member `size` may grow at its end in later versions. Set the member to the
 * size of the struct before you pass it, whether you fill the struct or the library does
 * (`leafcast_image image = {sizeof image};`). Functions that return such a struct have set it. A
 * size that no version knows is LEAFCAST_USAGE, and so is a value outside an enumeration. Structs
 * without `size` never change.
 *
 * Devices. Volumes on one device share its threads and its memory budget. A volume opened without a
 * device has one of its own, which ends with it. A scene shows one volume or several.
 *
 * Threads. Any thread may call, several at a time: calls that draw or probe volumes of one device
 * take turns. But only one call may close a volume, device or frame, once no other uses it.
 * leafcast_select() and leafcast_select_set() change what all later calls see, from any thread;
 * threads that share a volume should list it in their scenes instead. The device's threads run no
 * code of the caller but watch(), which must not make calls for that device. Their signal mask is
 * that of the thread that made the device.
 *
 * Processes. A child of fork() cannot use its parent's volumes and frames: calls with them are
 * LEAFCAST_USAGE; closing, destroying and ending return without freeing anything. The child may
 * make devices and open volumes of its own. The parent goes on undisturbed.
 *
 * Colours are linear RGB in [0, 1]. Pictures hold colours premultiplied by alpha (a background of
 * alpha 0 adds nothing) and not clamped: light may exceed 1. To make bytes for a screen, the caller
 * divides by alpha where alpha is kept, then encodes as sRGB.
 */
#ifndef RENDER_LEAFCAST_H
#define RENDER_LEAFCAST_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <leafcast_dynamic.h>
#include <leafcast_grid.h>
#include <leafcast_look.h>
#include <leafcast_status.h>

#ifdef __cplusplus
extern "C" {
#endif

#define LEAFCAST_VERSION "0.1.0"

/* leafcast_version() - the version of the linked library: its LEAFCAST_VERSION, as text. */
LEAFCAST_API const char *leafcast_version(void);

/* ---- Opening ---- */

typedef struct leafcast_device leafcast_device;

typedef enum leafcast_backend {
    LEAFCAST_BACKEND_AUTO = 0, /* the arena; in leafcast's own programs, which handle SIGBUS, the
                                  mapping for uncompressed grids without a memory budget */
    /* The file is mapped. Uncompressed grids: treelets are checked and used there. Others are
     * copied from there, and decompressed. If somebody cuts the file short, SIGBUS is raised. */
    LEAFCAST_BACKEND_MAPPED,
    LEAFCAST_BACKEND_ARENA /* treelets are read (and decompressed) into the program's own memory */
} leafcast_backend;

/* Where the axes of the world point in a body. LPS (DICOM, ITK): x to the left, y to the back, z to
 * the head. RAS (NIfTI): x to the right, y to the front, z to the head. */
typedef enum leafcast_axes {
    LEAFCAST_AXES_FILE = 0, /* as the file says; in leafcast_info: the file does not say */
    LEAFCAST_AXES_LPS,
    LEAFCAST_AXES_RAS
} leafcast_axes;

typedef struct leafcast_options {
    size_t size;

    /* ---- For the device ---- */

    /* Budget for everything, in bytes: directories, treelets, rays. 0: as much as scenes need. */
    uint64_t memory;
    int threads; /* render threads, to LEAFCAST_THREADS_MAX. 0: the CPUs this process may use; 1:
                    the caller's thread alone */
    const char *isa; /* kernels by name, such as "scalar"; NULL or "auto": the best this CPU has */
    /* Lets the caller's own `threads` threads draw. run() calls work(arg, i) once for every i below
     * count, in parallel or in sequence, and returns when all these have returned. NULL: the device
     * makes its own threads. The threads that read files are always the device's own. */
    void (*run)(void *host, int count, void (*work)(void *arg, int index), void *arg);
    void *host;

    /* ---- For the volume ---- */

    leafcast_device *device; /* on this one, with the fields above 0; NULL: on one of its own */
    leafcast_backend backend;
    const struct leafcast_experiments *experiments; /* leafcast_experimental.h; NULL: none */
    /* Meshes: keep which tets are neighbours, some 17 bytes a tet inside the budget. Rays of media
     * and means then go from tet to tet (M08 6.3), with the same bits: mostly in two thirds of the
     * time, in more where a transfer function leaves most tets out. */
    bool neighbours;
    /* The world to place the volume in. If the file says it lies in the other one, the volume is
     * turned by half a turn about z. If the file does not say, the volume stays as it is. */
    leafcast_axes axes;
} leafcast_options;

/* leafcast_device_create() - options may be NULL for the defaults; volume options are ignored.
 * leafcast_device_destroy() - the device lives until its last volume is closed. NULL is fine. */
LEAFCAST_API leafcast_status leafcast_device_create(const leafcast_options *options,
                                                    leafcast_device **device);
LEAFCAST_API void leafcast_device_destroy(leafcast_device *device);

/* leafcast_open() - options may be NULL for the defaults. The file must not change while it is
 * open, but for steps that are added to it. Pictures and probes return LEAFCAST_CORRUPT once its
 * size or its modification time has changed, or its name leads to another file. */
LEAFCAST_API leafcast_status leafcast_open(const char *path, const leafcast_options *options,
                                           leafcast **volume);

/* leafcast_open_memory() - as leafcast_open(), for a file's bytes in memory. They stay the
 * caller's, and must exist unchanged until the volume is closed, which is not checked. Bytes that
 * are aligned to 64 and hold an uncompressed grid are used in place; otherwise treelets are copied.
 * The budget counts them either way. */
LEAFCAST_API leafcast_status leafcast_open_memory(const void *bytes, size_t size,
                                                  const leafcast_options *options,
                                                  leafcast **volume);
LEAFCAST_API void leafcast_close(leafcast *volume); /* NULL is fine */

/* leafcast_refresh() - takes in the time steps that were added to the volume's file since it was
 * opened or refreshed last (`leafcast convert --append` and `--watch`, formats/SERIES.md 4): from
 * then on there are more steps, with their times, ranges and histograms. Steps that were there keep
 * their numbers, what is in memory of them stays there (but for what lies between two steps), and
 * what is selected stays selected.
 *
 * steps: set to the number of steps that there are now; untouched on failure.
 *
 * Any thread. Costs two calls of the system where the file has not been written to since. Otherwise
 * waits for a picture or leafcast_frame_advance() under way; frames that have begun go on with what
 * they show. Of steps that have come, reads the directory, as opening does: then it takes the
 * memory for both directories from the budget, for which treelets make room if need be.
 *
 * LEAFCAST_CORRUPT where the file is no longer the one that was opened, with more steps or without,
 * or is damaged; LEAFCAST_NOMEM. The volume is then as it was. A live volume, or bytes in memory,
 * never have more steps. */
LEAFCAST_API leafcast_status leafcast_refresh(leafcast *volume, uint32_t *steps);

/* ---- Live volumes ----
 *
 * A grid whose samples a running program gives, step after step, while pictures are drawn of it: by
 * other threads, or between them. It can do all that a file of one field and one step can that was
 * converted with `--levels 1`, with the same bits, and is closed likewise.
 *
 *     leafcast_open_live(&grid, NULL, &volume);
 *     for (int step = 0; simulate(values); step++) {
 *         leafcast_update(volume, NULL, NULL, values, NULL);
 *         leafcast_commit(volume, step * 0.1);
 *         leafcast_trace(volume, &scene, &camera, &image, NULL, NULL, NULL);
 *     }
 *
 * The samples are in memory twice, of the device's budget: the step that pictures show, and the one
 * that is being made. A picture, a slice or a probe has one step from its beginning to its end, of
 * leafcast_frame_begin() and leafcast_frame_end() where it is drawn bit by bit: the one that was
 * committed last when it began. */

/* leafcast_open_live() - makes one; all samples are 0. grid: its axes and to_world are copied;
 * types behind LEAFCAST_F32 are kept as f32. options may be NULL for the defaults; `backend` does
 * not matter. Samples are copied by as many threads as the device draws with: by others, so that
 * they need not wait for a picture. Previews read only while they are drawn. LEAFCAST_USAGE: the
 * grid lies in no sound place. LEAFCAST_NOMEM: the budget has no room for two steps. */
LEAFCAST_API leafcast_status leafcast_open_live(const leafcast_grid *grid,
                                                const leafcast_options *options, leafcast **volume);

/* leafcast_update() - copies samples of the next step. Those that are not given stay as they are.
 *
 * first, size: the nodes [first, first + size) on each axis; size may be 0. Both NULL: all nodes.
 * samples: of node `first`, of the grid's type, in the machine's byte order.
 * strides: bytes from a node to the next along x, y and z, of any sign; NULL: no gaps, x fastest.
 *
 * Any thread; one update or commit goes on at a time, others wait. Waits, too, until nothing shows
 * the step before the current one any more: LEAFCAST_USAGE where that is a frame which this thread
 * itself has begun and not ended. After a failure nothing has changed. */
LEAFCAST_API leafcast_status leafcast_update(leafcast *volume, const uint32_t first[3],
                                             const uint32_t size[3], const void *samples,
                                             const ptrdiff_t strides[3]);

/* leafcast_commit() - makes the step that updates gave the current one, which whatever begins from
 * now on shows: does not wait for pictures of the current one, but otherwise as leafcast_update()
 * does. Treelets in memory stay there where their samples are the same. time: any finite one, for
 * leafcast_step_time(). */
LEAFCAST_API leafcast_status leafcast_commit(leafcast *volume, double time);

/* What only some kinds of geometry can do: bits of leafcast_info.abilities. */
typedef enum leafcast_ability {
    LEAFCAST_ABILITY_LEVELS = 1,           /* coarse levels of detail, beyond those of previews,
                                              where the file has them: leafcast_info.levels */
    LEAFCAST_ABILITY_LAYERS = 2,           /* planes of nodes: leafcast_layer_slice() */
    LEAFCAST_ABILITY_ANALYTIC_NORMALS = 4, /* leafcast_scene.analytic_normals */
    LEAFCAST_ABILITY_SMOOTH_NORMALS = 8,   /* leafcast_scene.smooth_normals, if the file has
                                              gradients */
    LEAFCAST_ABILITY_INTERSECTORS = 16,    /* experiments: a choice of intersectors */
    LEAFCAST_ABILITY_PACKETS = 32,         /* experiments: packets, isopolygons, schemas */
    LEAFCAST_ABILITY_GIVEN = 64            /* it is a surface itself, whatever its values, and no
                                              isosurfaces, media, projections or slices are made of
                                              it. Of its surfaces, which are selected as any, the
                                              first says how it looks */
} leafcast_ability;

typedef struct leafcast_info {
    size_t size;
    const char *kind;   /* of geometry: "grid" or "mesh"; later versions may add others */
    const char *cell;   /* what a cell is called: "cell", "tet" */
    uint64_t cells;     /* at full resolution; their numbers begin at 0 */
    uint64_t nodes;     /* with a value each; a mesh's vertices */
    uint32_t dims[3];   /* nodes per axis at level 0; 0: the nodes form no lattice */
    unsigned abilities; /* of leafcast_ability */
    uint32_t fields, steps;
    bool moving;       /* whether nodes move from step to step */
    uint32_t levels;   /* of detail, whose samples the file has: of a grid 1 if it was converted
                          with `--levels 1` */
    uint32_t treelets; /* on all levels */
    const char *sample_type; /* "u8" ... */
    const char *name;
    double value_min, value_max; /* over all fields and steps; of a live volume, now */
    double bounds[2][3]; /* axis-aligned box of the volume in world space: minimum, maximum; if
                            nodes move, over all steps */
    double cell_size;    /* geometric mean edge of a cell, world units; without dims an estimate */
    uint64_t file_bytes, payload_bytes; /* of a live volume: of one step's samples */
    uint32_t preview_levels; /* levels of detail that a preview may draw. As `levels`, but with a
                                coarse grid: the cells themselves, then the grid's levels, and
                                those of the one inside it */
    uint32_t cell_levels;    /* how many of these, from level 0 on, are of cells of the volume's
                                kind; the others are of a regular grid. 1 to preview_levels; with
                                neither coarse levels nor a coarse grid 1 */
    bool gradients;          /* stored at the nodes, for leafcast_scene.smooth_normals */
    leafcast_axes axes;      /* of the world that the volume lies in */
    const char *units[3];    /* of lengths along x, y, z, such as "mm"; "": the file does not say */
    const char *time_unit;   /* of leafcast_step_time(), such as "s"; "": the file does not say */
} leafcast_info;

/* leafcast_get_info(), leafcast_describe() - facts about a volume. Pointers live as long as the
 * volume. For no volume (NULL) all fields but size are 0. */
LEAFCAST_API leafcast_status leafcast_get_info(const leafcast *volume, leafcast_info *info);

static inline leafcast_info leafcast_describe(const leafcast *of) {
    leafcast_info info;
    info.size = sizeof info;
    (void)leafcast_get_info(of, &info);
    return info;
}

/* ---- What is selected, and where it lies ---- */

/* leafcast_select() - set the isosurfaces that the next pictures show, unless their scenes list
 * volumes. count 1 .. LEAFCAST_SURFACES_MAX, isovalues finite. */
LEAFCAST_API leafcast_status leafcast_select(leafcast *volume, const leafcast_surface *surfaces,
                                             int count);

/* leafcast_select_set() - set the field and time step that the next pictures and probes see; at
 * first these are 0 and 0. The isosurfaces stay selected. */
LEAFCAST_API leafcast_status leafcast_select_set(leafcast *volume, uint32_t field, uint32_t step);

/* leafcast_select_between() - the same at a time between two steps: `between`, 0 or more and below
 * 1, of the way from `step` to the next. Pictures, slices and probes then see the field whose
 * samples are linear in time: with a and b those of both steps, in doubles (1 - between) a +
 * between b, rounded to f32; NaN where either is. 0: those of the step, as leafcast_select_set()
 * selects them. The surface is as exact as any step's; so are coarse levels, up to the rounding of
 * their samples.
 *
 * In a mesh likewise values at vertices; where these move, their coordinates; and stored gradients
 * and normals (those of the blended mesh would be others where it moves). A tet that turns inside
 * out on the way is drawn like one in a step: where tets overlap, surfaces of all are there. A
 * hexahedron is folded, or is not, as its nodes between say; it is blanked where it is at one of
 * both steps.
 *
 * Both steps are in memory, beside what lies between: another time between them reads nothing that
 * is still there. leafcast_range(), leafcast_fit_view() and what else takes a step tell of that
 * step alone, as the file does: all values between lie within the ranges of both steps, but a
 * histogram, or the box of a surface, does not follow from those of the steps. LEAFCAST_USAGE where
 * there is no next step; LEAFCAST_UNSUPPORTED of a file with too many treelets.
 *
 * leafcast_find_time() - the step and the share of the way to the next one of a time, in the units
 * of leafcast_step_time(): *between = (time - t0) / (t1 - t0). LEAFCAST_USAGE: no two steps are on
 * both sides of it. */
LEAFCAST_API leafcast_status leafcast_select_between(leafcast *volume, uint32_t field,
                                                     uint32_t step, double between);
LEAFCAST_API leafcast_status leafcast_find_time(const leafcast *volume, double time, uint32_t *step,
                                                double *between);

/* leafcast_expect_set() - say which field and time step are shown next, before the picture of those
 * before: for a program that plays steps. When such a picture is complete, what its rays saw is
 * read in the background, as it is in that step, until the next call that draws or selects: so the
 * program's own time between two pictures is used. Changes no picture, and never takes more than
 * the memory budget; only treelets that are not shown make room. Holds until that set is shown, or
 * another one is expected. What is read so counts in that set's statistics, but for load_s. */
LEAFCAST_API leafcast_status leafcast_expect_set(leafcast *volume, uint32_t field, uint32_t step);

/* leafcast_expect_between() - the same of a time between two steps, which should lie between others
 * than the next picture's: another time between the same two reads nothing. What is read is that
 * step of both which is not in memory. Only where a time between steps was drawn before. Times
 * between and steps share no memory, so both may be expected, each its own; without a memory budget
 * both are read behind pictures of either, within one what belongs to the picture. `between` 0:
 * leafcast_expect_set(). Fails as leafcast_select_between().
 */
LEAFCAST_API leafcast_status leafcast_expect_between(leafcast *volume, uint32_t field,
                                                     uint32_t step, double between);

/* leafcast_field_name() - the name, or "" if the file has none; lives as long as the volume.
 * leafcast_find_field() - by name, or by number if no field has that name; LEAFCAST_USAGE lists the
 * fields. leafcast_step_time() - as in the file, or else the step's number; of a
 * live volume, as committed. */
LEAFCAST_API const char *leafcast_field_name(const leafcast *volume, uint32_t field);
LEAFCAST_API leafcast_status leafcast_find_field(const leafcast *volume, const char *name,
                                                 uint32_t *field);
LEAFCAST_API double leafcast_step_time(const leafcast *volume, uint32_t step);

/* leafcast_stop_reading() - drop all reads that pictures asked for, or that a preview would still
 * make in the background: for a program that nobody looks at any more. Pictures under way ask
 * again. */
LEAFCAST_API void leafcast_stop_reading(leafcast *volume);

enum { LEAFCAST_BLOCKS_MAX = 64 }; /* of a map, along an axis */

/* The treelets of one level that reach into a block of a map. wanted: those with values that the
 * last picture asks for; resident: the wanted ones in memory; seen: the resident ones that one of
 * its rays walked. */
typedef struct leafcast_block {
    uint32_t treelets, wanted, resident, seen;
} leafcast_block;

/* leafcast_map_treelets() - counts the treelets of one level of detail by place. Cuts the volume
 * into blocks[0] x blocks[1] x blocks[2] blocks (1 .. LEAFCAST_BLOCKS_MAX each) along its own axes;
 * map gets one leafcast_block for each, x fastest. LEAFCAST_USAGE if there is no such level, or for
 * too many blocks. Any thread; waits for a picture or leafcast_frame_advance() under way. Costs a
 * pass over the level's part of the directory. */
LEAFCAST_API leafcast_status leafcast_map_treelets(leafcast *volume, uint32_t level,
                                                   const uint32_t blocks[3], leafcast_block *map);

/* Of the treelets that the last picture's rays walked, those with values at another step that it
 * asks for; resident: those of them in memory. */
typedef struct leafcast_holding {
    uint32_t wanted, resident;
} leafcast_holding;

/* leafcast_map_steps() - counts, for a field at each of the first `steps` steps, what a picture
 * like the last one would need, and how much of that is in memory. A step of which all that is
 * wanted is resident is drawn without reading, as far as rays see there what they saw. The last
 * one may be of a time between steps; what is in memory for such times alone does not count, since
 * steps are drawn without it.
 *
 * holdings: gets one for each step. LEAFCAST_USAGE if there is no such field, or there are fewer
 * steps, or steps is 0. Any thread; waits for a picture or leafcast_frame_advance() under way.
 * Costs at most some two million looks at the directory: where treelets that were seen, times
 * steps, are more than a million, it counts evenly chosen ones, and may overlook some that are in
 * memory for another step and the same in this one. */
LEAFCAST_API leafcast_status leafcast_map_steps(leafcast *volume, uint32_t field, uint32_t steps,
                                                leafcast_holding *holdings);

/* leafcast_range() - sets range[0], range[1] to the smallest and the largest finite value of a
 * field at a step, at full resolution; range[0] > range[1] if none is finite. An isovalue v has a
 * surface only if range[0] < v && v <= range[1]. LEAFCAST_USAGE if there is no such field or step.
 * Costs a pass over the directory. */
LEAFCAST_API leafcast_status leafcast_range(const leafcast *volume, uint32_t field, uint32_t step,
                                            double range[2]);

/* leafcast_find_steps() - finds the steps at which a field may have an isosurface: of any value
 * from lo to hi, lo <= hi; of one isovalue where they are equal. By the directory alone, no treelet
 * is read: a step has it if some treelet of level 0 has a range [min, max] with min < hi and lo <=
 * max. So no step that has a surface is left out. One that has none may be told where that is
 * narrow: a treelet's samples may all be equal, or lie on both sides of data that are missing
 * (NaN). Nothing follows for times between two steps that do not have it: all values may pass lo on
 * the way.
 *
 * steps: looks at the first so many; 1 or more.
 * has: gets 1 or 0 for each of them. NULL: the first step with it is enough.
 * first: set to the first step that has it; to `steps` if none has.
 *
 * LEAFCAST_USAGE if there is no such field, there are fewer steps, or lo > hi. Any thread; waits
 * for no picture. Nothing is kept, and a grid's treelets are looked at only below coarser ones that
 * may have the value (M08 4.4; why no tree over the steps, M08 5.1.3, is made for it:
 * tests/measurements/loading.md). */
LEAFCAST_API leafcast_status leafcast_find_steps(const leafcast *volume, uint32_t field, double lo,
                                                 double hi, uint32_t steps, uint8_t *has,
                                                 uint32_t *first);

/* ---- Pictures ---- */

/* Planes of values, row by row from the top. The caller owns them; any may be NULL. */
typedef struct leafcast_image {
    size_t size;
    float *r, *g, *b, *a;
    double *z;        /* distance along the unit ray to the nearest surface, or as leafcast_project
                         says; +inf on a miss */
    float *normal[3]; /* unit, towards lower values; 0 on a miss */
    int32_t *id;      /* index of the nearest surface, numbered through over the volumes of the
                         scene; -1 on a miss */
    uint8_t *provisional; /* 1: a preview drew something coarser than asked for, or not everything
                             yet; or a treelet is lost */
    uint8_t *rgba8; /* 4 bytes a pixel for a screen: sRGB, not premultiplied. Uses extra memory
                       for each of r, g, b, a that is NULL */
    /* The part of the camera's picture that is drawn into the planes: its upper left pixel and its
     * size. Width 0: the whole picture. */
    uint32_t x, y, width, height;
    size_t stride; /* values from one row to the next, in all planes, at least width; 0: width */
    double *rgba;  /* 4 values a pixel: colour and alpha as in r, g, b, a, but unrounded */
    double *error; /* media: a bound of the error of each channel of rgba; of a provisional pixel,
                      against the picture of all data. Projections: 0, or +inf where coarse or
                      provisional */
    double *value; /* of the projection; NaN where the ray meets no data */
} leafcast_image;

typedef struct leafcast_stats {
    size_t size;
    /* In wall-clock seconds; load_s: summed over the loader's threads. */
    double open_s, first_image_s, load_s, render_s;
    uint64_t rays, primary_rays, shadow_rays; /* rays: all of them */
    uint64_t occlusion_rays, mirrored_rays, refracted_rays;
    /* treelets_loaded and bytes_read: since the isovalues or the step were selected; a treelet that
     * is read twice counts twice. */
    uint64_t treelets_total, treelets_active, treelets_loaded;
    uint64_t bytes_file, bytes_active, bytes_visible, bytes_read;
    uint64_t treelets_lost; /* those that allow_missing goes without, of all that were asked for; */
    const char *lost_why;   /* why the first one is lost, until the next picture; NULL: none is */
    uint64_t bytes_resident; /* of treelets, also for other isovalues and steps */
    uint64_t bytes_peak;     /* most of the memory budget in use so far */
    /* Traversal steps; cells given to the intersector; hits that it found. */
    uint64_t nodes, cells, roots;
    uint64_t covered_pixels; /* pixels that show a surface */
    uint64_t provisional_pixels, ill_conditioned;
    uint64_t uncertified_pixels; /* media: pixels where scene.error is less than rounding allows, or
                                    coarse levels are drawn; without provisional ones */
    uint64_t passes; /* 1, plus 1 whenever all rays waited for treelets to replace others */
    /* Packets through a mesh (W07 table 4). Tests of single rays against boxes and against
     * isopolygons; tests of packets against boxes by intervals, and against isoranges; isopolygons
     * made or reused. */
    uint64_t box_tests, polygon_tests, interval_tests, isorange_tests, isopolygons;
    int threads;
    const char *isa;
    /* Media: how far the provisional pixels may be off, by image.error. 0: there are no such
     * pixels. */
    double provisional_error_mean, provisional_error_most;
    /* Of leafcast_options.neighbours: tets passed from tet to tet, and Pluecker tests. */
    uint64_t passed_tets, edge_tests;
    uint64_t bytes_read_ever; /* for treelets, since the volumes were opened */
    uint64_t objects; /* questions that rays asked of an object, alone or in batches: from the eye,
                         but for whole tiles, and to lights. A ray that waited asks anew */
} leafcast_stats;

/* leafcast_check_room() - whether the memory budget has room for this picture. No plane need exist
 * yet: any pointer that is not NULL counts as one. `beside`: bytes of the caller's own (to 2^60) to
 * count as well, for this picture and the following ones. The text of LEAFCAST_NOMEM names the
 * smallest budget that would do. */
LEAFCAST_API leafcast_status leafcast_check_room(leafcast *volume, const leafcast_scene *scene,
                                                 const leafcast_camera *camera,
                                                 const leafcast_image *planes, uint64_t beside);

/* leafcast_trace() - draw one picture. stats may be NULL. watch, if not NULL, is told now and then,
 * by any render thread, the share of pixels done; false ends the picture with LEAFCAST_STOPPED. */
LEAFCAST_API leafcast_status leafcast_trace(leafcast *volume, const leafcast_scene *scene,
                                            const leafcast_camera *camera,
                                            const leafcast_image *image, leafcast_stats *stats,
                                            bool (*watch)(void *ctx, double done), void *watch_ctx);

/* A picture that is drawn bit by bit, while the program does other things.
 *
 * leafcast_frame_begin() - copies its arguments, but not the planes, which the caller keeps. The
 * volumes must stay open, and memory is reserved, until leafcast_frame_end(). Calls on one frame
 * must come from one thread at a time, except leafcast_frame_cancel(). */
typedef struct leafcast_frame leafcast_frame;

LEAFCAST_API leafcast_status leafcast_frame_begin(leafcast *volume, const leafcast_scene *scene,
                                                  const leafcast_camera *camera,
                                                  const leafcast_image *image,
                                                  leafcast_frame **frame);

/* leafcast_frame_advance() - draw for about so many seconds (INFINITY: to the end; no NaN), but at
 * least some tiles, then return with the picture so far. *done: it is complete. The next call goes
 * on where this one stopped, whatever was drawn in between: the picture has the same bits. stats
 * may be NULL; they cover all calls so far, but count rays and cells only when all is done. After a
 * failure the frame may only be ended. */
LEAFCAST_API leafcast_status leafcast_frame_advance(leafcast_frame *frame, double seconds,
                                                    bool *done, leafcast_stats *stats);

/* leafcast_frame_cancel() - callable from any thread. A running leafcast_frame_advance() soon
 * returns LEAFCAST_STOPPED, and so does every later one. */
LEAFCAST_API void leafcast_frame_cancel(leafcast_frame *frame);
LEAFCAST_API void leafcast_frame_end(leafcast_frame *frame); /* NULL is fine */

/* ---- Single rays and points ---- */

/* Cells. A cell has a number, from 0 on: the same in hits, pieces, samples and leafcast_ray_hit.
 * Each level of detail numbers its own. What a number stands for depends on the kind of geometry:
 * in a grid cell i, j, k is number i + cells_x (j + cells_y k); tets are numbered in the file's
 * order. */
enum { LEAFCAST_CORNERS_MAX = 10 };

typedef struct leafcast_cell {
    size_t size;
    uint64_t cell;
    uint32_t level;
    int indices;       /* 3: index[] says where the cell is in rows, columns and slices. 0: cells
                          have numbers alone */
    uint32_t index[3]; /* i, j, k; of a curvilinear grid in the cell's zone */
    int corners;       /* 8 in a grid, 4 of a tet, 10 of a quadratic one: its nodes; 3 of a
                          triangle; 0: the cell has none, or is blanked */
    /* The corners in world space, and the values there. Corner (x, y, z) of a grid's cell, or of a
     * hexahedron, is at index x + 2y + 4z; those of a tet are in the order of the treelet file, of
     * a quadratic one corners first, then the nodes of edges 01, 12, 02, 03, 13, 23. */
    double position[LEAFCAST_CORNERS_MAX][3];
    float value[LEAFCAST_CORNERS_MAX];
} leafcast_cell;

/* leafcast_get_cell() - tells a cell's facts, with the values of the selected field and step. Reads
 * its treelet if that is not in memory. LEAFCAST_USAGE: there is no such level or cell.
 * leafcast_cell_indices() - sets index alone and returns leafcast_cell.indices, at no cost. 0 also
 * where there is no such level or cell. */
LEAFCAST_API leafcast_status leafcast_get_cell(leafcast *volume, uint32_t level, uint64_t number,
                                               leafcast_cell *cell);
LEAFCAST_API int leafcast_cell_indices(const leafcast *volume, uint32_t level, uint64_t number,
                                       uint32_t index[3]);

typedef struct leafcast_hit {
    double t, point[3];
    int surface;
    /* entering: the value goes from below the isovalue to above. flat: the cell has no volume,
     * or is a folded hexahedron, hence no two sides; then ignore `entering` and the gradient below.
     */
    bool entering, flat;
    uint32_t level; /* of detail, which numbers the cell */
    uint64_t cell;
    double at[3];       /* position inside a cell that has indices, [0, 1] on each axis; else 0 */
    double gradient[3]; /* of the cell's own interpolation; per world unit */
    double normal[3];   /* the shading normal */
    double error_bound; /* of t; INFINITY when the ray only grazes */
} leafcast_hit;

/* leafcast_probe_ray() - finds all hits of one ray with the selected surfaces, in order. Writes at
 * most max (0 or more); *count: how many were written. t is in lengths of direction. Origin and
 * direction as for a leafcast_ray. */
LEAFCAST_API leafcast_status leafcast_probe_ray(leafcast *volume, const leafcast_scene *scene,
                                                const double origin[3], const double direction[3],
                                                leafcast_hit *hits, int max, int *count);

/* The piece of a ray in one cell. There the value is a polynomial in t, exactly as in the cell. It
 * is in Bernstein form over [t0, t1]: control[0] is the value at t0, control[degree] the value at
 * t1. Where the ray enters the next cell, both pieces have the same bits. */
typedef struct leafcast_segment {
    double t0, t1; /* t0 < t1, in lengths of the direction */
    int degree;    /* 3 in a grid, 1 in a mesh */
    double control[4];
    double least, most, least_t, most_t; /* the extreme values and their t */
    uint32_t level;                      /* of detail, which numbers the cell */
    uint64_t cell;
} leafcast_segment;

/* leafcast_probe_segments() - finds the pieces of a ray, in order of t, whatever surfaces are
 * selected. Writes at most max; *count: how many were written. Cells without data (NaN, inf) and
 * cells without volume give none. Of the scene, only clipping and level of detail matter.
 * LEAFCAST_USAGE: the volume is a surface itself (LEAFCAST_ABILITY_GIVEN), which has no inside. */
LEAFCAST_API leafcast_status leafcast_probe_segments(leafcast *volume, const leafcast_scene *scene,
                                                     const double origin[3],
                                                     const double direction[3],
                                                     leafcast_segment *segments, int max,
                                                     int *count);

/* Rays of the caller's own, in world space. t is in lengths of direction. */
typedef struct leafcast_ray {
    double origin[3];    /* within LEAFCAST_PLACE_MOST */
    double direction[3]; /* the largest component LEAFCAST_DIRECTION_LEAST to LEAFCAST_PLACE_MOST */
    double t0, t1;       /* t0 <= t1; t1 may be INFINITY */
} leafcast_ray;

typedef struct leafcast_ray_hit {
    double t;           /* +inf: no hit */
    double error_bound; /* of t; INFINITY where the ray only grazes */
    double isovalue;
    uint64_t cell;   /* as in leafcast_cell */
    uint32_t object; /* numbered through over the volumes, and all places of groups */
    int32_t volume;  /* index in the scene, those of groups behind its own; -1: none */
    int32_t surface; /* numbered through over these volumes; -1: none */
    float normal[3]; /* unit, towards lower values */
    bool entering;   /* the value goes from below the isovalue to above */
} leafcast_ray_hit;

/* leafcast_trace_rays() - the first hit of each of count rays (below 2^30) with what the scene
 * shows; ignores its preview, lights and colours. By all threads of the device, within its budget.
 * leafcast_occluded_rays() - whether each ray hits anything: 1 or 0 a ray, at less cost.
 * Rays walk in batches: neighbours in the array that go the same way take less time. */
LEAFCAST_API leafcast_status leafcast_trace_rays(leafcast *volume, const leafcast_scene *scene,
                                                 const leafcast_ray *rays, size_t count,
                                                 leafcast_ray_hit *hits);
LEAFCAST_API leafcast_status leafcast_occluded_rays(leafcast *volume, const leafcast_scene *scene,
                                                    const leafcast_ray *rays, size_t count,
                                                    uint8_t *occluded);

/* leafcast_pixel_ray() - the primary ray of a pixel: origin = eye, unit direction. An invalid
 * camera or pixel gives direction 0,0,0. */
LEAFCAST_API void leafcast_pixel_ray(const leafcast_camera *camera, double x, double y,
                                     double origin[3], double direction[3]);

typedef struct leafcast_sample {
    bool inside;        /* whether the point is in the volume */
    uint64_t cell;      /* of level 0: the first one that holds the point, boundary included */
    double at[3];       /* as in leafcast_hit */
    double value;       /* by the cell's own interpolation; NaN where a corner is not finite */
    double nearest;     /* at the nearest corner of the cell, finite or not */
    double gradient[3]; /* per world unit */
    uint32_t treelet;
} leafcast_sample;

/* leafcast_probe_point() - finds the cell that holds a point. Outside the volume, or not finite, it
 * is not `inside`, and its value is NaN. LEAFCAST_USAGE, as below: a surface itself has none. */
LEAFCAST_API leafcast_status leafcast_probe_point(leafcast *volume, const double point[3],
                                                  leafcast_sample *sample);

/* leafcast_sample_points() - leafcast_probe_point() for count points, by all threads of the device,
 * within its budget. Treelets are read only where there are points, and once, in whatever order the
 * points come. They are read again only if memory is scarce, so that points (12 bytes each) or
 * treelets must wait. */
LEAFCAST_API leafcast_status leafcast_sample_points(leafcast *volume, const double (*points)[3],
                                                    size_t count, leafcast_sample *samples);

/* ---- Slices ---- */

typedef enum leafcast_interpolation {
    LEAFCAST_INTERPOLATION_LINEAR = 0, /* the cells' own interpolation: leafcast_sample.value */
    LEAFCAST_INTERPOLATION_NEAREST     /* leafcast_sample.nearest */
} leafcast_interpolation;

/* A rectangle of pixels in world space, flat or bent. The centre of the pixel in column x of row y
 * is at
 *
 *       origin + (x + 0.5) / width * u + (y + 0.5) / height * v,
 *
 * so origin is the upper left corner. If there is a line, it replaces origin + share * u: the
 * centre is then the line's point at (x + 0.5) / width of its length, + (y + 0.5) / height * v. */
typedef struct leafcast_slice_pixels {
    size_t size;
    leafcast_interpolation interpolation;
    uint32_t level; /* of detail: must exist in the volume; 0 is full resolution; meshes: 0 */
    double origin[3], u[3], v[3];
    const double (*line)[3];  /* points of a polyline; NULL: none */
    uint32_t line_count;      /* 0, or 2 to LEAFCAST_LINE_POINTS_MAX */
    uint32_t width, height;   /* 1 or more */
    uint64_t beside;          /* bytes of the caller's own to count in the budget, too; to 2^60 */
    uint32_t first_row, rows; /* leafcast_sample_slice() fills only these rows; rows 0: all */
} leafcast_slice_pixels;

/* leafcast_fit_slice() - sets width and height. Where cells are cubes: one square pixel a cell;
 * else as many pixels as the shortest edge of a cell needs. Nearest interpolation: one more each
 * way.
 *
 * leafcast_plane_slice() - the rectangle around the cut of the plane (n, d), n . p + d = 0, with
 * the volume, seen from where n points; fitted. Up is +z, or +y where n is along z. Keeps size,
 * interpolation and level of *slice, and sets all the rest. LEAFCAST_USAGE where the plane misses
 * the volume.
 *
 * leafcast_layer_slice() - the same for a plane of a grid's nodes: those with number `node` along
 * `axis` (0 to 2). The grid's other axes go right and up. With nearest interpolation and cubic
 * cells, pixels are the samples themselves. */
LEAFCAST_API leafcast_status leafcast_fit_slice(const leafcast *volume,
                                                leafcast_slice_pixels *slice);
LEAFCAST_API leafcast_status leafcast_plane_slice(const leafcast *volume, const double plane[4],
                                                  leafcast_slice_pixels *slice);
LEAFCAST_API leafcast_status leafcast_layer_slice(const leafcast *volume, int axis, uint32_t node,
                                                  leafcast_slice_pixels *slice);

/* leafcast_sample_slice() - writes the values at the pixels' centres, of the selected field and
 * step, row by row from the top: width x height of them, or those of the chosen rows. They are the
 * same bits as leafcast_probe_point() gives for the same points; NaN outside of the volume and
 * where there are no data. Uses all threads of the device, within its budget, which counts `value`,
 * too. Only treelets with pixels in them are read.
 *
 * stats may be NULL; treelets_active and bytes_active count the treelets with pixels,
 * treelets_loaded and bytes_read this call alone. watch: as for leafcast_trace(). The text of
 * LEAFCAST_USAGE says what is wrong with the slice. */
LEAFCAST_API leafcast_status leafcast_sample_slice(leafcast *volume,
                                                   const leafcast_slice_pixels *slice,
                                                   double *value, leafcast_stats *stats,
                                                   bool (*watch)(void *ctx, double done),
                                                   void *watch_ctx);

#ifdef __cplusplus
}
#endif

#endif
