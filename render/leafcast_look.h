/* leafcast_look.h - what to look at, and from where: surfaces, lights, media, scenes, cameras;
 * and what is worth a look.
 *
 * Part of leafcast.h, which includes it, and which says how arguments are checked.
 */
#ifndef RENDER_LEAFCAST_LOOK_H
#define RENDER_LEAFCAST_LOOK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <leafcast_status.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct leafcast leafcast; /* a volume */

/* ---- Ranges ---- */

/* The largest magnitude of numbers in world space: coordinates, lengths, planes, directions. A
 * direction may have any length, as long as its largest component is in LEAFCAST_DIRECTION_LEAST ..
 * LEAFCAST_PLACE_MOST. So no square of such a number, and no quotient of two, is 0 or infinite. */
#define LEAFCAST_PLACE_MOST      1e100
#define LEAFCAST_DIRECTION_LEAST 1e-100

/* The largest component of a drawn colour, or of light. */
#define LEAFCAST_COLOUR_MOST 1e9

#define LEAFCAST_REFRACTION_MOST 4.0

enum {
    LEAFCAST_LEVEL_MAX = 31, /* the last level; a volume's coarsest stands for those it lacks */
    LEAFCAST_SHININESS_MAX = 1024,
    LEAFCAST_LINE_POINTS_MAX = 1 << 24 /* points of a slice's line */
};

/* ---- Scenes ---- */

enum { LEAFCAST_SURFACES_MAX = 32, LEAFCAST_LIGHTS_MAX = 16, LEAFCAST_CLIP_PLANES_MAX = 16 };
enum { LEAFCAST_LIGHT_SAMPLES_MAX = 64, LEAFCAST_BOUNCES_MAX = 8 };

typedef struct leafcast_surface {
    double isovalue;    /* finite; of a volume that is a surface itself (LEAFCAST_ABILITY_GIVEN) it
                           does not matter */
    float rgb[3];       /* 0 to LEAFCAST_COLOUR_MOST */
    float opacity;      /* (0, 1]; 1 is opaque */
    float reflectivity; /* 0 to 1: the share of the mirrored ray's colour in the surface's own; the
                           scene's `bounces` says how deep */
    /* The refractive index of its inside, divided by that of its outside: 1 /
     * LEAFCAST_REFRACTION_MOST to LEAFCAST_REFRACTION_MOST; glass in air has 1.5, an air bubble in
     * glass 1 / 1.5. 0 or 1, or opaque: rays go straight through. Inside are values from the
     * isovalue up; of triangles what is behind them, seen from where their corners run
     * counterclockwise, as normals of closed surfaces point out; of terrain the ground. See the
     * scene's `bounces`. */
    float refraction;
} leafcast_surface;

LEAFCAST_API leafcast_surface leafcast_surface_default(double isovalue);

typedef struct leafcast_light {
    bool point;       /* whether `vector` is a position; else it is a direction */
    double vector[3]; /* direction towards the light, or its position */
    float rgb[3];     /* 0 to LEAFCAST_COLOUR_MOST; no fall-off */
    /* Above 0, shadows are soft. A point: the light is a ball of this radius, in world lengths, to
     * LEAFCAST_PLACE_MOST. A direction: it is a disc in the sky, seen from everywhere under this
     * half-angle in degrees, to 90; the sun has 0.27. Surfaces are shaded by the light's middle. */
    double radius;
} leafcast_light;

typedef enum leafcast_shading {
    LEAFCAST_SHADING_DIFFUSE = 0, /* M08 eq. 4.6, two-sided, summed over the lights */
    LEAFCAST_SHADING_PHONG,       /* the same, plus a highlight */
    LEAFCAST_SHADING_FLAT         /* the surface's colour, unlit */
} leafcast_shading;

typedef enum leafcast_lod {
    LEAFCAST_LOD_EXACT = 0, /* full resolution */
    LEAFCAST_LOD_LEVEL,     /* `lod_level` everywhere */
    LEAFCAST_LOD_PIXEL      /* per treelet, the coarsest with cells no larger than a pixel */
} leafcast_lod;

/* A transfer function: for each value the colour of the light that a place sends out, and the
 * extinction, by which it swallows light from behind (DESIGN: media). Between points, colour and
 * extinction are linear, each by itself. Below the first and above the last point they stay
 * constant. Two points at one value are a step, at which the second holds.
 *
 * Along a ray, a stretch dt with colour c and extinction k adds c k dt, times the share of light
 * that comes through all that is in front. Where several volumes are filled at one place, their k
 * add, and so do their c k. */
typedef struct leafcast_transfer_point {
    double value;      /* -1e300 to 1e300; equal to the point before, or above it by
                          LEAFCAST_TRANSFER_NARROWEST or more */
    double rgb[3];     /* 0 to the largest float */
    double extinction; /* per world length: 0 to 1e100 */
} leafcast_transfer_point;

enum { LEAFCAST_TRANSFER_POINTS_MAX = 4096 };
#define LEAFCAST_TRANSFER_NARROWEST 1e-290

typedef struct leafcast_medium {
    const leafcast_transfer_point *points;
    int count; /* 0: not filled; else at most LEAFCAST_TRANSFER_POINTS_MAX */
} leafcast_medium;

/* One value per ray, drawn instead of surfaces and media. Taken from the cells' own interpolant,
 * inside the clips, as exactly as rounding allows. Cells with NaN or inf among their samples are
 * left out. With several volumes, all their values count together. */
typedef enum leafcast_project {
    LEAFCAST_PROJECT_NONE = 0,
    LEAFCAST_PROJECT_MAX, /* image.z: where it is, the first place if there are several */
    LEAFCAST_PROJECT_MIN,
    LEAFCAST_PROJECT_MEAN, /* over the length of the ray inside cells with data; image.z: +inf */
    LEAFCAST_PROJECT_FIRST /* the first value of project_value or more: project_value itself, or
                              more if data begin above it; image.z: where it is */
} leafcast_project;

/* A field that colours surfaces of a volume: of another volume on the same device, of any kind that
 * has values at points. For another field of the same file, open it once more. */
typedef struct leafcast_colouring {
    leafcast *volume;
    uint32_t field, step;
    double between;      /* as in leafcast_shown, */
    const double *place; /* and likewise: where that volume is in the scene's world, whatever the
                            place of what it colours */
} leafcast_colouring;

/* An object of a scene: a volume, what is shown of it, and where. */
typedef struct leafcast_shown {
    leafcast *volume;
    uint32_t field, step;
    const leafcast_surface *surfaces; /* `count` of them, as for leafcast_select(); with media or a
                                         projection count may be 0 */
    int count;
    double between; /* so much of the way from that step to the next: leafcast_select_between() */
    /* Where it is: 12 numbers, rows of 4, that take a point of the volume's own world to the
     * scene's (p -> M p + origin); NULL: both are the same. M may turn, mirror, shear and scale,
     * also unevenly. No number above LEAFCAST_PLACE_MOST; M with its largest number in 1 /
     * LEAFCAST_SCALE_MOST .. LEAFCAST_SCALE_MOST, and |M| |M^-1| (Frobenius) at most
     * LEAFCAST_SCALE_UNEVEN, which no singular M is. Rays are taken to the volume's own world,
     * once, and keep their t; what they find there is taken back: so a hit has the bits of that
     * ray's in the volume alone. Lights, clips, cameras, t, normals, gradients, and the lengths of
     * which extinction is told, are the scene's. */
    const double *place;
    /* Colours its surfaces by the value there, whatever the extinction: that of an isosurface is
     * the isovalue. NULL: by surfaces[].rgb, or of a volume with LEAFCAST_ABILITY_GIVEN, whose
     * field is named "rgb", by its own colours; between two steps by surfaces[].rgb. */
    const leafcast_medium *colours;
    /* `colours` are of another field's value at each point of a surface instead: origin + t
     * direction of the ray that has met it, where the value is leafcast_sample.value as
     * leafcast_probe_point() finds it (at a coarse level of detail, at that level). Where that is
     * NaN, surfaces have the colour of surfaces[].rgb. NULL: by the surface's own value. Of terrain
     * whose field is named "rgb", an image (leafcast convert --field rgb), the colours themselves
     * are taken, mixed as light between its nodes, and `colours` may be NULL. Ignored by
     * projections, single rays and caps. LEAFCAST_USAGE: `colours` is NULL, or the other volume is
     * a surface itself, or shown with another field or step. */
    const leafcast_colouring *colour_by;
} leafcast_shown;

#define LEAFCAST_SCALE_MOST   1e30
#define LEAFCAST_SCALE_UNEVEN 1e6

enum {
    LEAFCAST_VOLUMES_MAX = 4096, /* objects of a scene; of so many, lists take some 15 MiB beside
                                    leafcast_options.memory */
    LEAFCAST_MEDIA_MAX = 16      /* those among them that are filled with a medium */
};

/* Many places, which pictures share: of each some 280 bytes, beside leafcast_options.memory.
 *
 * leafcast_make_places() - copy `count` places, 1 to 2^30 of 12 numbers each, as
 * leafcast_shown.place; for scenes of the volume's device. which: NULL, or for each place which one
 * of the groups in its group lies there, alone. leafcast_free_places() - NULL, too; not while a
 * picture that shows them is under way. */
typedef struct leafcast_places leafcast_places;
LEAFCAST_API leafcast_status leafcast_make_places(const leafcast *volume, const double *places,
                                                  const uint16_t *which, uint32_t count,
                                                  leafcast_places **out);
LEAFCAST_API void leafcast_free_places(leafcast_places *places);

/* Objects that lie together in a world of their own, and that world at many places (M08 5.2:
 * multi-level instancing). Each object is drawn as if it was listed once for each of its group's
 * places, at its own place followed by that: with the same bits. A ray reads what it meets.
 *
 * Volumes of groups have surfaces, and nothing else: no media, no colour_by. Groups may lie in
 * groups, LEAFCAST_GROUPS_DEEP deep. All places of a scene together are below 2^32 - 1 objects. */
typedef struct leafcast_group {
    leafcast_places *places;       /* in the world of what lists the group; of no other group */
    const leafcast_shown *volumes; /* in the group's own world */
    int volume_count;
    /* In that world, too. Where places say which of them lies there: these have no places of their
     * own (NULL), and there are no volumes. */
    const struct leafcast_group *groups;
    int group_count;
} leafcast_group;

enum { LEAFCAST_GROUPS_DEEP = 7 };

typedef struct leafcast_scene {
    size_t size;
    /* Objects: volumes of one device. All their surfaces are seen in order of distance; at equal
     * distance the object listed first comes first. A volume may be listed many times, with other
     * surfaces, media and places, but with one field and step. 0 objects: the volume passed with
     * the scene, as selected. LEAFCAST_LOD_PIXEL and media in steps: not with places. */
    const leafcast_shown *volumes;
    int volume_count;
    /* Objects that are placed many times, behind the volumes in order; then 0 volumes are none.
     * With their volumes, level by level, LEAFCAST_VOLUMES_MAX in all. Not with projections, caps,
     * LEAFCAST_LOD_PIXEL and media in steps; no probe meets them. */
    const leafcast_group *groups;
    int group_count;
    leafcast_light lights[LEAFCAST_LIGHTS_MAX];
    int light_count; /* 0: a headlight at the eye, without shadows */
    float ambient;   /* k_a of M08 eq. 4.6, in [0, 1] */
    float specular;  /* Phong: weight of the highlight, 0 to LEAFCAST_COLOUR_MOST */
    int shininess;   /* Phong: its exponent, 1 to LEAFCAST_SHININESS_MAX; other shadings: 0 too */
    leafcast_shading shading;
    bool shadows;
    bool analytic_normals; /* grids: gradient of the trilinear form, not interpolated central
                              differences; meshes: the tet's, unless smooth_normals */
    bool smooth_normals;   /* meshes: interpolate gradients at the vertices, which the file must
                              have; affects only shading and image.normal */
    float background[4];   /* RGBA, each 0 to LEAFCAST_COLOUR_MOST */
    bool clip_box;         /* draw only what is inside clip_min .. clip_max */
    double clip_min[3], clip_max[3];
    double clip_planes[LEAFCAST_CLIP_PLANES_MAX][4]; /* (n, d): draw only where n . p + d >= 0 */
    int clip_plane_count;
    leafcast_lod lod;
    uint32_t lod_level; /* 0 is full resolution; beyond the last level: the last one, but
                           LEAFCAST_USAGE of a volume that has level 0 alone, unless in a preview
                           with others; at most LEAFCAST_LEVEL_MAX */
    bool preview; /* do not wait for all data. Draws a grid's isosurfaces alone at the finest level
                     of which few megabytes are absent, and waits for what it sees of that. Else
                     draws what is resident, the finest levels first, or a coarse grid where cells
                     are absent. Marks provisional pixels; with media, image.error says how far they
                     may be off. For a volume with a coarse grid, lod level n > 0 is that grid's
                     level n - 1, or one inside it, drawn instead of the cells, and the whole
                     picture is provisional */
    bool allow_missing; /* draw treelets that cannot be read, as they are damaged or the disk fails,
                           by the coarser one above, or not at all; their pixels are provisional,
                           and stats count them. false: they are an error. Ignored by previews,
                           rays and probes; not with LEAFCAST_PROJECT_MAX and _MIN, and caps */
    bool sweep;     /* load everything that the isovalues need, coarse levels first, not only what
                       rays ask for */
    int samples;    /* rays a pixel for r, g, b, a: 0 or 1 (through its centre), or the mean of 4 or
                       16 on a fixed pattern; each takes the time of a picture. z, normal and id are
                       always those of the pixel's centre */
    int layers_max; /* stop after so many transparent surfaces on a ray, 0 or more; 0: no limit */
    const struct leafcast_scene_experiments *experiments; /* leafcast_experimental.h; NULL: none */
    const leafcast_medium *media;                         /* one per object, in order */
    int media_count; /* the number of volumes (1 if volume_count is 0); or 0: no media */
    /* The largest allowed error of a channel (r, g, b, a) of a picture with media: in [1e-9, 1]; 0:
     * half a step of 8 bits, 1/510. image.error gives the bound that was reached. Measured against
     * the integral along the ray through the pixel's centre, as rounded to the volume's own space.
     * The integral is over the data at full resolution, with surfaces and caps as lit, in floats.
     * Where lod draws coarse levels, their distance from the data is unknown: then image.error
     * covers all that might be seen, and the pixel is uncertified. */
    double error;
    /* Instead of surfaces and media, in the first medium's colours, whatever its extinction;
     * without media, grey from the least to the greatest value of the volumes' fields. */
    leafcast_project project;
    double project_value; /* for LEAFCAST_PROJECT_FIRST: finite */
    /* Close surfaces that clips cut open. Where a ray enters through a clip, and the value there is
     * at least an isovalue, the ray meets a cap: of the surface with the greatest such isovalue,
     * with the clip's normal. Caps receive no shadows. Ignored in previews. Caps are drawn all at
     * once, however little time leafcast_frame_advance() has. */
    bool caps;
    const leafcast_medium *cap_colours; /* colours caps by the value there, unlit; NULL: the
                                           surface's colour, lit */
    /* Light the colours of media as surfaces are lit (M08 eq. 4.6, two-sided, without shadows and
     * highlights), with the gradient of the value as the normal. Grids: central differences, or as
     * analytic_normals says. Meshes: the tet's gradient, or as smooth_normals says. Not certified:
     * image.error is +inf, and all pixels are uncertified. */
    bool shade_media;
    /* Lighting of media fades out where the value changes by less than this share of its range in a
     * cell, so flat regions and noise stay unlit. 0 to 1; 0: 1/32. */
    double shade_fade;
    /* Soft shadows: rays to each light that has a radius, 1 to LEAFCAST_LIGHT_SAMPLES_MAX, or
     * 0: 16. So much of the light arrives as their mean says. Their directions are spread evenly
     * over the part of the sky that the light covers; each ends at the light. One on the other side
     * of the cell's own gradient is hidden. A surface inside the ball of a light gets all of it. */
    int light_samples;
    /* Ambient occlusion: above 0, the ambient term (with LEAFCAST_SHADING_FLAT, the colour) of a
     * surface is multiplied by the share of such light that comes from up to this world length, to
     * LEAFCAST_PLACE_MOST. Each of `occlusion_samples` rays (1 to LEAFCAST_LIGHT_SAMPLES_MAX, or 0:
     * 16), spread about the shading normal by the cosine, is dimmed by surfaces as light is. Those
     * on the other side of the cell's own gradient are left out; if all are, the share is 1. */
    double occlusion;
    int occlusion_samples;
    /* Mirrored rays, of surfaces with a reflectivity, and mirrored and refracted rays, of those
     * with a refraction: 0 to LEAFCAST_BOUNCES_MAX one after the other. They see surfaces, lit like
     * others, and behind these the background; no media and no caps. A surface keeps its own colour
     * where a mirrored ray would count for 2^-12 of the pixel or less (without the media before
     * it), and where the ray would lead to the other side of the cell's own gradient.
     *
     * Through a surface with a refraction, what its opacity leaves is seen along two rays: the
     * refracted one by Snell's law, and the mirrored one, whose share is Fresnel's for light that
     * is not polarised; all of it where reflection is total. One that would count for 2^-12 or less
     * leaves its share to the other. Directions are by the normal that shades, or by the cell's own
     * where that would lead to the wrong side; where both do, where there have been `bounces` rays,
     * and where what the opacity leaves counts for 2^-12 of the pixel or less (the share in which
     * the surface is seen, times 1 - opacity), what is behind is seen straight on. `layers_max`
     * counts the surfaces on refracted rays with those before. Lights shine straight through, as
     * without a refraction. LEAFCAST_USAGE with media: bent rays would not see them. */
    int bounces;
} leafcast_scene;

/* leafcast_init_scene(), leafcast_scene_default() - set the defaults: a headlight, diffuse shading,
 * no clips, full resolution, a transparent black background. */
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
    double fov;             /* vertical, in degrees, below 180; above 0 for a perspective camera */
    uint32_t width, height; /* pixels: each 1 or more, product below 2^31; centres +0.5, y down */
    /* Above 0: orthographic, with this many world units from the lower to the upper edge of the
     * picture, to LEAFCAST_PLACE_MOST. Rays are parallel and begin in the plane through the eye. */
    double ortho_height;
} leafcast_camera;

/* leafcast_get_standard_view(), leafcast_standard_view() - a camera with fov 45 and up +z that
 * looks at the centre of the bounding box. Its distance is `distance` times the box's longest edge
 * (2.2: the standard view, 1.1: the close view), in the direction (1, 0.6, 0.8). width and height
 * as for a camera; distance above 0. Wrong arguments give a camera that is all 0. */
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
 * edges[i + 1]. Of a large volume only `drawn` of `total` samples are counted: enough to know
 * shares to a few in a thousand. Files of earlier versions have no histogram: then treelets are
 * counted, by their ranges. */
enum { LEAFCAST_BINS_MAX = 256 };

typedef struct leafcast_histogram {
    uint32_t bins;  /* 0: no value is finite */
    uint64_t drawn; /* values counted: the sum of samples[] */
    uint64_t cells; /* cells, or tets, looked at */
    uint64_t total; /* samples, or tets, in the volume */
    double edges[LEAFCAST_BINS_MAX + 1];
    uint32_t samples[LEAFCAST_BINS_MAX];
    uint32_t active[LEAFCAST_BINS_MAX]; /* cells that the isosurface of edges[i] crosses */
    float gradient[LEAFCAST_BINS_MAX];  /* mean length of the gradient in these, per world unit */
    float area[LEAFCAST_BINS_MAX];      /* the isosurface's estimated area, world units^2 */
    uint32_t first, end; /* bins [first, end) hold data. That is all bins, unless the first or last
                            holds a value that may stand for missing data, such as -9999, and its
                            neighbour is empty */
    double aside;        /* the value for missing data; NaN: there is none */
} leafcast_histogram;

/* leafcast_get_histogram() - LEAFCAST_USAGE if there is no such field or step. */
LEAFCAST_API leafcast_status leafcast_get_histogram(const leafcast *volume, uint32_t field,
                                                    uint32_t step, leafcast_histogram *histogram);

/* leafcast_data_range() - as leafcast_range(), but without a value that may stand for missing data:
 * then one end differs from leafcast_range()'s. Suggested isovalues ignore such a value, too. */
LEAFCAST_API leafcast_status leafcast_data_range(const leafcast *volume, uint32_t field,
                                                 uint32_t step, double range[2]);

/* leafcast_suggested_isovalues() - up to `max` (0 or more; at most LEAFCAST_SUGGESTIONS_MAX)
 * isovalues whose surfaces are worth a look, best first; *count may become 0. Of a volume with
 * LEAFCAST_ABILITY_GIVEN one, which stands for its surface. */
enum { LEAFCAST_SUGGESTIONS_MAX = 4 };
LEAFCAST_API leafcast_status leafcast_suggested_isovalues(const leafcast *volume, uint32_t field,
                                                          uint32_t step, double *isovalues, int max,
                                                          int *count);

/* leafcast_fit_view() - a view of the box that these isovalues make active, or of the whole volume
 * if they make nothing active. Up is +z, unless the box is more than twice as long along z as along
 * x and y: then up is the longer one of x and y. The longer of the other two axes lies across the
 * picture. count: 0 to LEAFCAST_SURFACES_MAX. fov: vertical, degrees, below 180; 0:
 * LEAFCAST_FIT_FOV. */
enum { LEAFCAST_FIT_FOV = 35 };
LEAFCAST_API leafcast_status leafcast_fit_view(const leafcast *volume, uint32_t field,
                                               uint32_t step, const double *isovalues, int count,
                                               double fov, uint32_t width, uint32_t height,
                                               leafcast_camera *camera);

#ifdef __cplusplus
}
#endif

#endif
