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
 * leafcast_prep.h makes such files. No globals, no output, no exit. Vectors are (x, y, z); spaces
 * are world space unless said.
 *
 * Errors. Every call that can fail returns a leafcast_status; leafcast_error_text() then says more,
 * for the calling thread. A volume stays usable after any failure: the next call starts afresh.
 *
 * Arguments. Every call looks at all that it is given before it does anything: at pointers, and at
 * every field of every struct, used or not, for the range that is said where it is declared. What
 * is wrong is LEAFCAST_USAGE, whose text names the field. Numbers are finite where nothing else is
 * said. Only pointers of which it is said may be NULL, and arrays without elements; others must
 * point to as much as the call needs, which nobody can look at. Structs that are all zero but
 * `size` are right, but for cameras, surfaces and slices.
 *
 * Sizes. A struct that has a member `size` may grow at its end in later versions: set it to the
 * size of the struct before the struct is passed, whether you fill it or the library does
 * (`leafcast_image image = {sizeof image};`). The functions that return such a struct have set it.
 * A size that no version knows is LEAFCAST_USAGE; so is a value that is none of an enumeration's.
 * Structs without `size` stay as they are.
 *
 * Devices. Volumes on one device share its threads and its memory budget; a volume that is opened
 * without one has a device of its own, which ends with it. A scene shows one volume or several.
 *
 * Threads. Any thread may call, several at a time: calls that draw or probe volumes of one device
 * take turns. But a volume, device or frame is closed by one call, when no other uses it any more.
 * leafcast_select() and leafcast_select_set() say what later calls see, whoever makes them: threads
 * that share a volume let their scenes say it instead. Of the caller's code, a device's threads run
 * watch() alone, which must not call for that device. Their signal mask is that of the thread that
 * made them.
 *
 * Processes. What fork() copies is no use to the child: there, calls with a volume or frame from
 * before are LEAFCAST_USAGE, and closing, destroying and ending give nothing back, but return. It
 * may make devices and open volumes of its own. The parent goes on undisturbed.
 *
 * Colours are linear RGB in [0, 1]. Those of pictures are premultiplied by alpha (a background of
 * alpha 0 adds nothing), and not clamped: light may exceed 1. Bytes for a screen are the caller's:
 * divide by alpha where alpha is kept, then encode as sRGB.
 */
#ifndef RENDER_LEAFCAST_H
#define RENDER_LEAFCAST_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <leafcast_status.h>

#ifdef __cplusplus
extern "C" {
#endif

#define LEAFCAST_VERSION "0.1.0"

/* leafcast_version() - of the library that is linked: a LEAFCAST_VERSION, as text. */
LEAFCAST_API const char *leafcast_version(void);

/* ---- Ranges ---- */

/* Of numbers in world space: coordinates, lengths, planes, directions. A direction may have any
 * length whose largest component is from the least to the most: so no square of one, and no
 * quotient of two of these, is 0 or infinite. */
#define LEAFCAST_PLACE_MOST      1e100
#define LEAFCAST_DIRECTION_LEAST 1e-100

/* Of a component of a colour that is drawn, or of light. */
#define LEAFCAST_COLOUR_MOST 1e9

enum {
    LEAFCAST_LEVEL_MAX = 31, /* of detail; the coarsest there is stands for those that are not */
    LEAFCAST_SHININESS_MAX = 1024,
    LEAFCAST_LINE_POINTS_MAX = 1 << 24 /* of a slice along a line */
};

/* ---- Opening ---- */

typedef struct leafcast_device leafcast_device;
typedef struct leafcast leafcast; /* a volume */

typedef enum leafcast_backend {
    LEAFCAST_BACKEND_AUTO = 0, /* the arena */
    /* Treelets of a grid are checked and used where the file is mapped: if somebody cuts it short
     * meanwhile, SIGBUS is raised. Those of a mesh hold indices, and are read as by the arena. */
    LEAFCAST_BACKEND_MAPPED,
    LEAFCAST_BACKEND_ARENA /* treelets are read (and decompressed) into memory of our own */
} leafcast_backend;

/* Which way the axes of the world point in a body: x to the left, y to its back and z to its head
 * (DICOM, ITK), or x to the right, y to the front and z to the head (NIfTI). */
typedef enum leafcast_axes {
    LEAFCAST_AXES_FILE = 0, /* as the file has them; in leafcast_info: the file does not say */
    LEAFCAST_AXES_LPS,
    LEAFCAST_AXES_RAS
} leafcast_axes;

typedef struct leafcast_options {
    size_t size;

    /* ---- Of a device ---- */

    /* Bytes for everything: directories, treelets, rays; 0: as much as scenes need. */
    uint64_t memory;
    int threads; /* render threads, to LEAFCAST_THREADS_MAX; 0: the CPUs this process may use; 1:
                    the caller's alone */
    const char *isa; /* kernels by name ("scalar"); NULL or "auto": the best this CPU has */
    /* To draw by `threads` threads of the caller's: run() calls work(arg, i) once for every i below
     * count, side by side or one after the other, and returns when all these have returned. NULL:
     * the device makes threads of its own. Those that read files are its own in any case. */
    void (*run)(void *host, int count, void (*work)(void *arg, int index), void *arg);
    void *host;

    /* ---- Of a volume ---- */

    leafcast_device *device; /* that it is on; what is above is then left 0. NULL: one of its own */
    leafcast_backend backend;
    const struct leafcast_experiments *experiments; /* leafcast_experimental.h; NULL: none */
    /* Of a mesh: keep which tets are neighbours, some 17 bytes a tet inside the budget. Media and
     * means then go from tet to tet (M08 6.3), with the same bits: mostly in two thirds of the
     * time, in more where a transfer function leaves most tets out. */
    bool neighbours;
    /* The world that the volume is to lie in: one whose file says that it lies in the other is
     * turned by half a turn about z; one whose file does not say stays as it is. */
    leafcast_axes axes;
} leafcast_options;

/* leafcast_device_create() - options may be NULL for the defaults; those of volumes do not matter.
 * leafcast_device_destroy() - the device ends with the last volume on it. NULL is fine. */
LEAFCAST_API leafcast_status leafcast_device_create(const leafcast_options *options,
                                                    leafcast_device **device);
LEAFCAST_API void leafcast_device_destroy(leafcast_device *device);

/* leafcast_open() - options may be NULL for the defaults. The file must stay as it is while it is
 * open: pictures and probes are LEAFCAST_CORRUPT as soon as its size, its time of last modification
 * or the file of its name is another. */
LEAFCAST_API leafcast_status leafcast_open(const char *path, const leafcast_options *options,
                                           leafcast **volume);

/* leafcast_open_memory() - the same of a file's bytes in memory. They stay the caller's, and must
 * be there and stay as they are until the volume is closed; nobody looks whether they do. What is
 * aligned to 64 bytes and holds a grid without compression is used in place, otherwise treelets are
 * copied. The budget counts them either way. */
LEAFCAST_API leafcast_status leafcast_open_memory(const void *bytes, size_t size,
                                                  const leafcast_options *options,
                                                  leafcast **volume);
LEAFCAST_API void leafcast_close(leafcast *volume); /* NULL is fine */

typedef struct leafcast_info {
    size_t size;
    const char *kind;        /* of geometry: "grid" or "mesh"; there may be others one day */
    uint32_t dims[3];        /* nodes per axis, level 0; of a mesh: 0 */
    uint64_t tets, vertices; /* of a mesh; of a grid: 0 */
    uint32_t fields, steps;
    bool moving; /* a mesh whose vertices move from step to step */
    uint32_t levels;
    uint32_t treelets;       /* of all levels */
    const char *sample_type; /* "u8" ... */
    const char *name;
    double value_min, value_max; /* of all fields and steps */
    double bounds[2][3]; /* of the volume in world space, axis-aligned: minimum and maximum; of a
                            moving mesh over all steps */
    double cell_size;    /* geometric mean edge of a cell, world units; of a mesh: about */
    uint64_t file_bytes, payload_bytes;
    uint32_t preview_levels; /* of detail that a preview may draw: levels; of a mesh with a coarse
                                grid the tets, and then those of the grid */
    bool gradients;        /* at the vertices of a mesh: leafcast_scene.smooth_normals may be set */
    leafcast_axes axes;    /* of the world that it lies in */
    const char *units[3];  /* of lengths along x, y, z: "mm"; "": the file does not say */
    const char *time_unit; /* of leafcast_step_time(): "s"; likewise */
} leafcast_info;

/* leafcast_get_info(), leafcast_describe() - pointers live as long as the volume. Of no volume
 * (NULL) all is 0. */
LEAFCAST_API leafcast_status leafcast_get_info(const leafcast *volume, leafcast_info *info);

static inline leafcast_info leafcast_describe(const leafcast *of) {
    leafcast_info info;
    info.size = sizeof info;
    (void)leafcast_get_info(of, &info);
    return info;
}

/* ---- What to draw ---- */

enum { LEAFCAST_SURFACES_MAX = 32, LEAFCAST_LIGHTS_MAX = 16, LEAFCAST_CLIP_PLANES_MAX = 16 };

typedef struct leafcast_surface {
    double isovalue; /* finite */
    float rgb[3];    /* 0 to LEAFCAST_COLOUR_MOST */
    float opacity;   /* (0, 1]; 1 is opaque */
} leafcast_surface;

LEAFCAST_API leafcast_surface leafcast_surface_default(double isovalue);

/* leafcast_select() - the isosurfaces that the next pictures show, as far as their scenes list no
 * volumes. count 1 .. LEAFCAST_SURFACES_MAX, isovalues finite. */
LEAFCAST_API leafcast_status leafcast_select(leafcast *volume, const leafcast_surface *surfaces,
                                             int count);

/* leafcast_select_set() - which field at which time step the next pictures show, and probes see; 0
 * and 0 until this is called. The isosurfaces stay selected. */
LEAFCAST_API leafcast_status leafcast_select_set(leafcast *volume, uint32_t field, uint32_t step);

/* leafcast_field_name() - "" where the file has no name for it; lives as long as the volume.
 * leafcast_find_field() - by name, or where no field is called so, by number; LEAFCAST_USAGE lists
 * those there are. leafcast_step_time() - as the file says; the step's number where it does not. */
LEAFCAST_API const char *leafcast_field_name(const leafcast *volume, uint32_t field);
LEAFCAST_API leafcast_status leafcast_find_field(const leafcast *volume, const char *name,
                                                 uint32_t *field);
LEAFCAST_API double leafcast_step_time(const leafcast *volume, uint32_t step);

/* leafcast_stop_reading() - what pictures have asked for, and a preview would still read behind
 * them, is not read: for a program that nobody looks at any more. Pictures that are under way ask
 * again. */
LEAFCAST_API void leafcast_stop_reading(leafcast *volume);

enum { LEAFCAST_BLOCKS_MAX = 64 }; /* of a map along an axis */

/* A block of a map: how many treelets of one level reach into it; of these, how many hold values
 * that the last picture asks for, are resident among those, and were walked by one of its rays. */
typedef struct leafcast_block {
    uint32_t treelets, wanted, resident, seen;
} leafcast_block;

/* leafcast_map_treelets() - which treelets of a level of detail are where: the volume is cut into
 * blocks[0] x blocks[1] x blocks[2] (1 .. LEAFCAST_BLOCKS_MAX each) along its own axes, map gets
 * one for each, x fastest. LEAFCAST_USAGE where there is no such level, or for too many blocks.
 * Any thread, between pictures and between the calls of leafcast_frame_advance(), for which it
 * waits; costs a pass over the level's part of the directory. */
LEAFCAST_API leafcast_status leafcast_map_treelets(leafcast *volume, uint32_t level,
                                                   const uint32_t blocks[3], leafcast_block *map);

/* leafcast_range() - range[0], range[1]: the smallest and the largest finite value of a field at a
 * step, at full resolution; range[0] > range[1] where none is finite. An isovalue v has a surface
 * only if range[0] < v && v <= range[1]. LEAFCAST_USAGE if there is no such field or step. Costs a
 * pass over the directory. */
LEAFCAST_API leafcast_status leafcast_range(const leafcast *volume, uint32_t field, uint32_t step,
                                            double range[2]);

typedef struct leafcast_light {
    bool point;       /* position, else direction */
    double vector[3]; /* towards the light, or where it is */
    float rgb[3];     /* 0 to LEAFCAST_COLOUR_MOST; no fall-off */
} leafcast_light;

typedef enum leafcast_shading {
    LEAFCAST_SHADING_DIFFUSE = 0, /* M08 eq. 4.6, two-sided, light by light */
    LEAFCAST_SHADING_PHONG,       /* plus a highlight */
    LEAFCAST_SHADING_FLAT         /* the surface's colour alone */
} leafcast_shading;

typedef enum leafcast_lod {
    LEAFCAST_LOD_EXACT = 0, /* full resolution */
    LEAFCAST_LOD_LEVEL,     /* `level` throughout */
    LEAFCAST_LOD_PIXEL      /* per treelet, the coarsest whose cells are not larger than a pixel */
} leafcast_lod;

/* What a volume is filled with: a transfer function says for each value which light a place sends
 * out, and how much of what comes from behind it swallows (DESIGN: media). It is linear between its
 * points, colour and extinction each by itself, and goes on beyond the first and the last one as it
 * is there. Two points at one value are a step, at which the second holds.
 *
 * Along a ray, which light of colour c is seen of a stretch dt with extinction k: c k dt, times
 * what of it comes through all that is in front. Where several volumes are filled at one place,
 * their k add, and so do their c k. */
typedef struct leafcast_transfer_point {
    double value;      /* -1e300 to 1e300; that of the point before, or more by
                          LEAFCAST_TRANSFER_NARROWEST */
    double rgb[3];     /* 0 to the greatest float */
    double extinction; /* per world length: 0 to 1e100 */
} leafcast_transfer_point;

enum { LEAFCAST_TRANSFER_POINTS_MAX = 4096 };
#define LEAFCAST_TRANSFER_NARROWEST 1e-290

typedef struct leafcast_medium {
    const leafcast_transfer_point *points;
    int count; /* 0: nothing; else at most LEAFCAST_TRANSFER_POINTS_MAX */
} leafcast_medium;

/* What else may be made of the values on a ray: of the cells' own interpolant, inside what is
 * clipped, as exact as rounding allows. Cells with NaN or inf among their samples give nothing. Of
 * several volumes: of all values together. */
typedef enum leafcast_project {
    LEAFCAST_PROJECT_NONE = 0,
    LEAFCAST_PROJECT_MAX, /* image.z: where it is; of several places the first */
    LEAFCAST_PROJECT_MIN,
    LEAFCAST_PROJECT_MEAN, /* over the length of the ray's way through cells with data; image.z:
                              +inf */
    LEAFCAST_PROJECT_FIRST /* the first that reaches project_value: that, or more where data begins
                              with more; image.z: where it is */
} leafcast_project;

/* A volume of a scene, and what it shows of it. */
typedef struct leafcast_shown {
    leafcast *volume;
    uint32_t field, step;
    const leafcast_surface *surfaces; /* count of them, as of leafcast_select(); with media or a
                                         projection there may be none */
    int count;
} leafcast_shown;

enum { LEAFCAST_VOLUMES_MAX = 16 };

typedef struct leafcast_scene {
    size_t size;
    /* Volumes of one device, each once. Surfaces of all are seen in order of their distance; of two
     * at the same one the volume that is listed first comes first. 0: the volume that is passed
     * with the scene, as it was selected. */
    const leafcast_shown *volumes;
    int volume_count;
    leafcast_light lights[LEAFCAST_LIGHTS_MAX];
    int light_count; /* 0: a headlight at the eye, without shadows */
    float ambient;   /* k_a of M08 eq. 4.6, in [0, 1] */
    float specular;  /* Phong: weight of the highlight, 0 to LEAFCAST_COLOUR_MOST */
    int shininess;   /* Phong: its exponent, 1 to LEAFCAST_SHININESS_MAX; others: or 0 */
    leafcast_shading shading;
    bool shadows;
    bool analytic_normals; /* gradient of the cell's trilinear form instead of interpolated central
                              differences; of a mesh that of the tet, in any case but the next */
    bool smooth_normals;   /* of a mesh: interpolated gradients at the vertices, which its file must
                              have; for shading and image.normal alone */
    float background[4];   /* RGBA, each 0 to LEAFCAST_COLOUR_MOST */
    bool clip_box;         /* draw only what is inside clip_min .. clip_max */
    double clip_min[3], clip_max[3];
    double clip_planes[LEAFCAST_CLIP_PLANES_MAX][4]; /* (n, d): draw only where n . p + d >= 0 */
    int clip_plane_count;
    leafcast_lod lod;
    uint32_t lod_level; /* 0 is full resolution; more than there are: the last one; at most
                           LEAFCAST_LEVEL_MAX */
    bool preview; /* do not wait: draw the finest level that is resident, of a mesh its coarse grid
                     where tets are absent, and say where that is provisional; of a medium also how
                     far that may be off (image.error). A mesh with a coarse grid has coarse levels
                     for lod here: level n is that grid's level n - 1, in place of the tets, and
                     all of the picture is provisional */
    bool sweep;   /* load everything the isovalues need, coarse first, instead of what the rays ask
                     for */
    int samples;  /* rays a pixel for r, g, b, a: 0 or 1 (through its centre), 4 or 16 on a fixed
                     pattern, whose mean is taken; each takes the time of a picture. z, normal and
                     id stay those of the pixel's centre */
    int layers_max; /* stop after so many transparent surfaces on a ray; 0: no limit; not below 0 */
    const struct leafcast_scene_experiments *experiments; /* leafcast_experimental.h; NULL: none */
    const leafcast_medium *media;                         /* what its volumes are filled with, */
    int media_count; /* as many as volumes (volume_count 0: 1); or 0: nothing is */
    /* How far a channel (r, g, b, a) of a picture with media may be from the integral along the ray
     * through the pixel's centre, as that ray is when it has been rounded to the volume's own
     * space: in [1e-9, 1]; 0: half a step of 8 bits, 1/510. image.error says how far it is at most.
     * The integral is that of the data at full resolution, with surfaces and caps as they are lit,
     * in floats. Where lod draws coarse levels, nobody knows how far those are from the data: then
     * image.error is all that may be seen, and the pixel is uncertified. */
    double error;
    /* Instead of surfaces and media. Coloured by the colours of the first medium, whatever its
     * extinction; without, grey from the least to the greatest value of the volumes' fields. */
    leafcast_project project;
    double project_value; /* of LEAFCAST_PROJECT_FIRST: finite */
    /* What clips have cut open is closed: where a ray enters through a clip at a value of an
     * isovalue or more, it meets the surface of the greatest such isovalue there, whose normal is
     * the clip's. Shadows do not fall on caps. Not in a preview; and caps are drawn at once,
     * however little time leafcast_frame_advance() has. */
    bool caps;
    const leafcast_medium *cap_colours; /* colours of caps by the value there, as they are; NULL:
                                           the surface's colour, lit */
    /* Colours of media are lit as surfaces are (M08 eq. 4.6, two-sided, without shadows and
     * highlights), with the gradient of the value as the normal: in grids central differences, or
     * as analytic_normals says; in meshes that of the tet, or as smooth_normals says. Not
     * certified: image.error is +inf, and all pixels are uncertified. */
    bool shade_media;
    /* Where the value changes by less than this share of its range in a cell, the lighting fades
     * away: flat regions and noise stay as they are. 0 to 1; 0: 1/32. */
    double shade_fade;
} leafcast_scene;

/* leafcast_init_scene(), leafcast_scene_default() - a headlight, diffuse, nothing clipped, exact,
 * before transparent black. */
LEAFCAST_API leafcast_status leafcast_init_scene(leafcast_scene *scene);

static inline leafcast_scene leafcast_scene_default(void) {
    leafcast_scene scene;
    scene.size = sizeof scene;
    (void)leafcast_init_scene(&scene);
    return scene;
}

typedef struct leafcast_camera {
    size_t size;
    double eye[3], look_at[3], up[3];
    double fov;             /* vertical, degrees, below 180; above 0 of a perspective camera */
    uint32_t width, height; /* pixels, 1 or more each, below 2^31 together; centres at +0.5, y down
                             */
    /* Orthographic, if not 0: world units from the lower to the upper edge of the picture, to
     * LEAFCAST_PLACE_MOST. Rays are parallel and begin in the plane through the eye. */
    double ortho_height;
} leafcast_camera;

/* leafcast_get_standard_view(), leafcast_standard_view() - width and height as a camera may have
 * them, distance above 0; what is wrong gives a camera that is all 0. fov 45, up +z, looking at the
 * centre of the bounding box from `distance` (2.2: the standard view, 1.1: the close view) times
 * its longest edge in the direction (1, 0.6, 0.8). */
LEAFCAST_API leafcast_status leafcast_get_standard_view(const leafcast *volume, double distance,
                                                        uint32_t width, uint32_t height,
                                                        leafcast_camera *camera);

static inline leafcast_camera leafcast_standard_view(const leafcast *of, double distance,
                                                     uint32_t width, uint32_t height) {
    leafcast_camera camera;
    camera.size = sizeof camera;
    (void)leafcast_get_standard_view(of, distance, width, height, &camera);
    return camera;
}

/* ---- What is worth a look ---- */

/* How the values of a field at a step are spread. Bin i holds the values v with edges[i] <= v <
 * edges[i + 1]. Of a large volume not all samples are counted, but `drawn` of `total` ones, which
 * is enough to know shares to a few in a thousand. Files of earlier versions have none: then
 * treelets are counted, by their ranges. */
enum { LEAFCAST_BINS_MAX = 256 };

typedef struct leafcast_histogram {
    uint32_t bins;  /* 0: no value is finite */
    uint64_t drawn; /* values that were counted: the sum of samples[] */
    uint64_t cells; /* cells, or tets, that were looked at */
    uint64_t total; /* samples, or tets, that there are */
    double edges[LEAFCAST_BINS_MAX + 1];
    uint32_t samples[LEAFCAST_BINS_MAX];
    uint32_t active[LEAFCAST_BINS_MAX]; /* cells that the isosurface of edges[i] crosses */
    float gradient[LEAFCAST_BINS_MAX];  /* mean length of the gradient in these, per world unit */
    float area[LEAFCAST_BINS_MAX];      /* of the isosurface of edges[i], about; world units */
    uint32_t first,
        end;      /* bins [first, end) hold data: all, unless one at an end holds a value that
                     may stand for missing data, such as -9999, and one beside it none */
    double aside; /* that value; NaN: there is none */
} leafcast_histogram;

/* leafcast_get_histogram() - LEAFCAST_USAGE if there is no such field or step. */
LEAFCAST_API leafcast_status leafcast_get_histogram(const leafcast *volume, uint32_t field,
                                                    uint32_t step, leafcast_histogram *histogram);

/* leafcast_data_range() - as leafcast_range(), but without a value that may stand for missing data:
 * that is then the end of leafcast_range() that differs. Suggestions leave it aside, too. */
LEAFCAST_API leafcast_status leafcast_data_range(const leafcast *volume, uint32_t field,
                                                 uint32_t step, double range[2]);

/* leafcast_suggested_isovalues() - up to `max` (0 and more; at most LEAFCAST_SUGGESTIONS_MAX)
 * isovalues whose surfaces are worth a look, best first; *count may become 0. */
enum { LEAFCAST_SUGGESTIONS_MAX = 4 };
LEAFCAST_API leafcast_status leafcast_suggested_isovalues(const leafcast *volume, uint32_t field,
                                                          uint32_t step, double *isovalues, int max,
                                                          int *count);

/* leafcast_fit_view() - a view of what these isovalues make active, of the whole volume where they
 * make nothing so. Up is +z, unless the box is more than twice as long along z as along x and y:
 * then up is the longer one of these. The longest of the other axes lies across. count: 0 to
 * LEAFCAST_SURFACES_MAX. fov: vertical, degrees, below 180; 0: LEAFCAST_FIT_FOV. */
enum { LEAFCAST_FIT_FOV = 35 };
LEAFCAST_API leafcast_status leafcast_fit_view(const leafcast *volume, uint32_t field,
                                               uint32_t step, const double *isovalues, int count,
                                               double fov, uint32_t width, uint32_t height,
                                               leafcast_camera *camera);

/* ---- Pictures ---- */

/* Planes of values, row by row from the top, the caller's own; any may be NULL. */
typedef struct leafcast_image {
    size_t size;
    float *r, *g, *b, *a;
    double *z;        /* of the nearest surface, or as leafcast_project says: distance along the
                         unit ray, +inf on a miss */
    float *normal[3]; /* unit, towards lower values; 0 on a miss */
    int32_t *id;      /* index of the nearest surface, -1 on a miss; surfaces of the volumes of a
                         scene are numbered through */
    uint8_t
        *provisional; /* 1: a preview drew something coarser than was asked for, or not yet all */
    uint8_t *rgba8;   /* 4 bytes a pixel for a screen: sRGB, not premultiplied. Needs room for the
                         planes r, g, b, a where these are NULL */
    /* The part of the camera's picture that is drawn, and that planes hold: its left upper pixel
     * and its size. Width 0: the whole picture. */
    uint32_t x, y, width, height;
    size_t stride; /* values from row to row, of all planes, width or more; 0: width */
    double *rgba;  /* 4 values a pixel: colour and alpha as in r, g, b, a, unrounded */
    double *error; /* of media: no channel of rgba is further off than this; where provisional: off
                      the picture of all data. Of projections: 0, or +inf where they are of coarse
                      levels or provisional */
    double *value; /* of a projection; NaN where the ray meets no data */
} leafcast_image;

typedef struct leafcast_stats {
    size_t size;
    /* Wall clock; load_s: summed over the loader's workers. */
    double open_s, first_image_s, load_s, render_s;
    uint64_t rays, primary_rays, shadow_rays;
    /* Loaded, and bytes_read: since the isovalues or the step were selected; a treelet twice counts
     * twice. */
    uint64_t treelets_total, treelets_active, treelets_loaded;
    uint64_t bytes_file, bytes_active, bytes_visible, bytes_read;
    uint64_t bytes_resident; /* of treelets, those of other isovalues and steps included */
    uint64_t bytes_peak;     /* of the memory budget */
    /* Traversal steps; cells handed to the intersector; hits it found. */
    uint64_t nodes, cells, roots;
    uint64_t covered_pixels; /* that show a surface */
    uint64_t provisional_pixels, ill_conditioned;
    uint64_t uncertified_pixels; /* of media: scene.error is less than rounding allows, or coarse
                                    levels are drawn; without those that are provisional */
    uint64_t passes; /* 1, and 1 more whenever all rays waited for treelets to give way to others */
    /* Of packets through a mesh (W07 table 4): rays individually tested against boxes and against
     * isopolygons; packets against boxes by intervals, and against isoranges; isopolygons taken up.
     */
    uint64_t box_tests, polygon_tests, interval_tests, isorange_tests, isopolygons;
    int threads;
    const char *isa;
    /* Of media, over the provisional pixels: how far these may be off, as image.error says. 0:
     * there are none. */
    double provisional_error_mean, provisional_error_most;
    /* Of meshes whose rays go from tet to tet (leafcast_options.neighbours): such tets, and
     * Pluecker tests. */
    uint64_t passed_tets, edge_tests;
    uint64_t bytes_read_ever; /* of treelets, since the volumes were opened */
} leafcast_stats;

/* leafcast_check_room() - whether the memory budget holds such a picture, before its planes are
 * there: planes may have any pointers that are not NULL. `beside`: bytes of the caller's own (to
 * 2^60) that shall count too, in this and in the following pictures. LEAFCAST_NOMEM names the
 * smallest budget that would do. */
LEAFCAST_API leafcast_status leafcast_check_room(leafcast *volume, const leafcast_scene *scene,
                                                 const leafcast_camera *camera,
                                                 const leafcast_image *planes, uint64_t beside);

/* leafcast_trace() - one picture. stats may be NULL. watch, when not NULL, is told now and then (by
 * any render thread) which share of the pixels is done; false ends it with LEAFCAST_STOPPED. */
LEAFCAST_API leafcast_status leafcast_trace(leafcast *volume, const leafcast_scene *scene,
                                            const leafcast_camera *camera,
                                            const leafcast_image *image, leafcast_stats *stats,
                                            bool (*watch)(void *ctx, double done), void *watch_ctx);

/* A picture that is drawn bit by bit, so that a program goes on meanwhile.
 *
 * leafcast_frame_begin() - copies what it is given, but for planes, which the caller keeps. The
 * volumes must stay open until leafcast_frame_end(); until then memory is held for it. Calls on one
 * frame come from one thread at a time, but for leafcast_frame_cancel(). */
typedef struct leafcast_frame leafcast_frame;

LEAFCAST_API leafcast_status leafcast_frame_begin(leafcast *volume, const leafcast_scene *scene,
                                                  const leafcast_camera *camera,
                                                  const leafcast_image *image,
                                                  leafcast_frame **frame);

/* leafcast_frame_advance() - draw for about so many seconds (INFINITY: to the end; no NaN), then
 * return with what there is; *done: all of it. Some tiles are drawn in any case. The next call goes
 * on where this one stopped, whatever was drawn in between: the picture is the same bits. stats, of
 * all calls so far, may be NULL; rays and cells are in it only when all is done. After a failure
 * the frame may only be ended. */
LEAFCAST_API leafcast_status leafcast_frame_advance(leafcast_frame *frame, double seconds,
                                                    bool *done, leafcast_stats *stats);

/* leafcast_frame_cancel() - by any thread: leafcast_frame_advance() soon returns LEAFCAST_STOPPED,
 * if it runs, and ever after. */
LEAFCAST_API void leafcast_frame_cancel(leafcast_frame *frame);
LEAFCAST_API void leafcast_frame_end(leafcast_frame *frame); /* NULL is fine */

/* ---- Single rays and points ---- */

typedef struct leafcast_hit {
    double t, point[3];
    int surface;
    /* entering: from below the isovalue to above. flat: of a tet without volume, which has no two
     * sides; then neither `entering` nor the gradient below means anything. */
    bool entering, flat;
    /* In a grid: */
    uint32_t cell[3];
    double at[3];     /* position inside the cell, [0, 1] */
    float samples[8]; /* corner x + 2y + 4z */
    /* In a mesh: the tet, by its number in the file's order, and its vertices. */
    uint64_t tet;
    float vertices[4][3], values[4];
    double gradient[3]; /* of the cell's trilinear form, or in the tet; world units */
    double normal[3];   /* the shading normal */
    double error_bound; /* of t, world units; INFINITY when the ray only grazes */
} leafcast_hit;

/* leafcast_probe_ray() - all hits of one ray with the selected surfaces, in order; at most max (0
 * and more) of them, *count says how many were written. t counts in lengths of direction. Origin
 * and direction as of a leafcast_ray. */
LEAFCAST_API leafcast_status leafcast_probe_ray(leafcast *volume, const leafcast_scene *scene,
                                                const double origin[3], const double direction[3],
                                                leafcast_hit *hits, int max, int *count);

/* A ray's piece in one cell. The value there is a polynomial in t, as it is in the cell: in
 * Bernstein form over [t0, t1], so that control[0] is the value at t0 and control[degree] the one
 * at t1. Where the ray goes on in the next cell, both have the same bits. */
typedef struct leafcast_segment {
    double t0, t1; /* t0 < t1, in lengths of the direction */
    int degree;    /* 3 in a grid, 1 in a mesh */
    double control[4];
    double least, most, least_t, most_t; /* the extreme values, and where they are */
    uint32_t cell[3];                    /* of a grid */
    uint64_t tet;                        /* of a mesh */
} leafcast_segment;

/* leafcast_probe_segments() - what the field does along a ray: its pieces in order of t, whatever
 * surfaces are selected; at most max of them, *count says how many were written. Cells without data
 * (NaN, inf) and tets without volume have none. Of the scene, clipping and level of detail count.
 */
LEAFCAST_API leafcast_status leafcast_probe_segments(leafcast *volume, const leafcast_scene *scene,
                                                     const double origin[3],
                                                     const double direction[3],
                                                     leafcast_segment *segments, int max,
                                                     int *count);

/* Rays of the caller's own, in world space. t counts in lengths of direction. */
typedef struct leafcast_ray {
    double origin[3];    /* within LEAFCAST_PLACE_MOST */
    double direction[3]; /* the largest component LEAFCAST_DIRECTION_LEAST to LEAFCAST_PLACE_MOST */
    double t0, t1;       /* t0 <= t1; t1 may be INFINITY */
} leafcast_ray;

typedef struct leafcast_ray_hit {
    double t;           /* +inf: none */
    double error_bound; /* of t; INFINITY where the ray only grazes */
    double isovalue;
    uint64_t cell;   /* of its grid: i + cells_x (j + cells_y k); of a mesh: the tet */
    int32_t volume;  /* by its place in the scene; -1: none */
    int32_t surface; /* surfaces of the scene's volumes are numbered through; -1: none */
    float normal[3]; /* unit, towards lower values */
    bool entering;   /* from below the isovalue to above */
} leafcast_ray_hit;

/* leafcast_trace_rays() - the first hit of each of count rays (to 2^30) with what the scene shows;
 * its preview, lights and colours do not matter. By all threads of the device, within its budget.
 * leafcast_occluded_rays() - whether there is any: 1 or 0 a ray, for less.
 *
 * Rays walk in batches: neighbours in the array that go the same way take less time. */
LEAFCAST_API leafcast_status leafcast_trace_rays(leafcast *volume, const leafcast_scene *scene,
                                                 const leafcast_ray *rays, size_t count,
                                                 leafcast_ray_hit *hits);
LEAFCAST_API leafcast_status leafcast_occluded_rays(leafcast *volume, const leafcast_scene *scene,
                                                    const leafcast_ray *rays, size_t count,
                                                    uint8_t *occluded);

/* leafcast_pixel_ray() - the primary ray of a pixel: origin = eye, unit direction; direction 0,0,0
 * of a camera, or a pixel, that cannot be. */
LEAFCAST_API void leafcast_pixel_ray(const leafcast_camera *camera, double x, double y,
                                     double origin[3], double direction[3]);

typedef struct leafcast_sample {
    bool inside; /* of the volume */
    /* In a grid: */
    uint32_t cell[3];
    double at[3];
    float samples[8];
    /* In a mesh: the first tet that holds the point, boundary included. */
    uint64_t tet;
    float vertices[4][3], values[4];
    double value;       /* trilinear, or linear; NaN where a sample is not finite */
    double gradient[3]; /* world units */
    uint32_t treelet;
} leafcast_sample;

/* leafcast_probe_point() - the cell that holds a point. One that is beyond all volumes, not finite
 * among them, is not `inside`, and its value is NaN. */
LEAFCAST_API leafcast_status leafcast_probe_point(leafcast *volume, const double point[3],
                                                  leafcast_sample *sample);

/* leafcast_sample_points() - the same of count points. By all threads of the device, within its
 * budget. Treelets are read where there are points, and once, whatever the order of these: more
 * often only where memory is scarce, so that points (12 bytes each) or treelets must wait. */
LEAFCAST_API leafcast_status leafcast_sample_points(leafcast *volume, const double (*points)[3],
                                                    size_t count, leafcast_sample *samples);

/* ---- Slices ---- */

typedef enum leafcast_interpolation {
    LEAFCAST_INTERPOLATION_LINEAR = 0, /* as the cells have it: leafcast_sample.value */
    LEAFCAST_INTERPOLATION_NEAREST     /* that of the nearest corner of the cell, or of the tet */
} leafcast_interpolation;

/* A rectangle of pixels in world space, which may be bent. The centre of the pixel in column x of
 * row y is at
 *
 *     origin + (x + 0.5) / width * u + (y + 0.5) / height * v,
 *
 * so that origin is the left upper corner. Where there is a line, its points stand for origin and
 * u: the row's first summand is the point at (x + 0.5) / width of the line's length. */
typedef struct leafcast_slice_pixels {
    size_t size;
    leafcast_interpolation interpolation;
    uint32_t level; /* of detail, which the volume has: 0 is full resolution; of a mesh 0 */
    double origin[3], u[3], v[3];
    const double (*line)[3];  /* of a polyline; NULL: none */
    uint32_t line_count;      /* 0, or 2 to LEAFCAST_LINE_POINTS_MAX */
    uint32_t width, height;   /* 1 and more */
    uint64_t beside;          /* bytes of the caller's own that the budget counts, too; to 2^60 */
    uint32_t first_row, rows; /* leafcast_sample_slice(): these rows alone; rows 0: all */
} leafcast_slice_pixels;

/* leafcast_fit_slice() - set width and height: one square pixel a cell, where cells are cubes;
 * where they are not, as many as it takes along the shortest edge; one more each way where the
 * interpolation is the nearest.
 *
 * leafcast_plane_slice() - where the plane (n, d), n . p + d = 0, cuts the volume: the rectangle
 * around that, seen from where n points, fitted; up is +z, or +y where n is along z. Of *slice,
 * size, interpolation and level are the caller's, the rest is set. LEAFCAST_USAGE where the plane
 * passes the volume by.
 *
 * leafcast_layer_slice() - likewise of a grid's node planes: across axis 0 to 2 through its nodes
 * of this number. The grid's other axes go right and up. With the nearest interpolation, pixels are
 * the samples themselves where cells are cubes. */
LEAFCAST_API leafcast_status leafcast_fit_slice(const leafcast *volume,
                                                leafcast_slice_pixels *slice);
LEAFCAST_API leafcast_status leafcast_plane_slice(const leafcast *volume, const double plane[4],
                                                  leafcast_slice_pixels *slice);
LEAFCAST_API leafcast_status leafcast_layer_slice(const leafcast *volume, int axis, uint32_t node,
                                                  leafcast_slice_pixels *slice);

/* leafcast_sample_slice() - the values at the pixels' centres, of the field and step that are
 * selected, row by row from the top, width x height of them, or of the rows that are wanted: the
 * same bits as leafcast_probe_point() gives for the same points. NaN outside of the volume and
 * where there is no data. By all threads of the device, within its budget, which counts `value`,
 * too; only treelets with pixels in them are read.
 *
 * stats may be NULL; treelets_active and bytes_active are those with pixels, treelets_loaded and
 * bytes_read are this call's. watch: as of leafcast_trace(). LEAFCAST_USAGE names what is wrong
 * with the slice. */
LEAFCAST_API leafcast_status leafcast_sample_slice(leafcast *volume,
                                                   const leafcast_slice_pixels *slice,
                                                   double *value, leafcast_stats *stats,
                                                   bool (*watch)(void *ctx, double done),
                                                   void *watch_ctx);

#ifdef __cplusplus
}
#endif

#endif
