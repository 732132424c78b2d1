/* pictures.h - the same picture from every kernel: what the tests of tiles share. Trouble fails the
 * running test.
 */
#ifndef TESTS_SUPPORT_PICTURES_H
#define TESTS_SUPPORT_PICTURES_H

#include "render/leafcast.h"
#include "tests/support/fields.h"
#include "tests/support/watched.h"

/* No multiple of a tile's side. */
enum { PICTURE_WIDTH = WATCHED ? 43 : 75, PICTURE_HEIGHT = WATCHED ? 29 : 53 };
enum { PICTURE_PIXELS = PICTURE_WIDTH * PICTURE_HEIGHT };

typedef struct picture {
    float rgba[4][PICTURE_PIXELS], normal[3][PICTURE_PIXELS];
    double z[PICTURE_PIXELS];
    int32_t id[PICTURE_PIXELS];
    uint8_t provisional[PICTURE_PIXELS];
} picture;

/* pictures_draw() - a picture and what it took. */
void pictures_draw(leafcast *volume, const leafcast_scene *scene, const leafcast_camera *view,
                   picture *p, leafcast_stats *stats);

/* pictures_least_memory() - the least budget that this picture takes, of a volume whose budget is
 * too small for it, as its refusal names it. */
size_t pictures_least_memory(leafcast *volume, const leafcast_scene *scene,
                             const leafcast_camera *view);

/* pictures_same_pixel() - whether pixel i of both is the same to the bit: depth, colour, normal. */
bool pictures_same_pixel(const picture *a, const picture *b, int i);

/* The same file opened with several kernels: of[0] traces single rays. */
typedef struct picture_volumes {
    leafcast *of[16];
    const char *name[16];
    int count;
} picture_volumes;

/* pictures_open() - for single rays, then for each ISA with tiles; pictures_open_one() - one more.
 */
picture_volumes pictures_open(const char *path, int threads);
void pictures_open_one(picture_volumes *v, const char *path, const char *isa, int threads);
void pictures_close(picture_volumes *v);
void pictures_select(picture_volumes *v, const leafcast_surface *surfaces, int count);

/* pictures_alike() - all planes of all kernels are those of single rays. Twice: with treelets still
 * absent, and with all there. Returns the pixels with a surface. */
int pictures_alike(const picture_volumes *v, const leafcast_scene *scene,
                   const leafcast_camera *view, const char *what);

/* pictures_view() - cameras around, near and inside a volume, at random and in its planes, narrow
 * and wide: 0 .. PICTURE_VIEWS - 1. */
enum { PICTURE_VIEWS = 8 };
leafcast_camera pictures_view(const leafcast *volume, int kind, field_random *r);

/* pictures_scene() - lights, shadows, transparency, clipping, levels by turns. */
leafcast_scene pictures_scene(int kind, const leafcast_info *info);

/* pictures_of_layers() - twelve transparent surfaces about an isovalue, `step` apart, of which a
 * few, many or all count, with lights and shadows: pictures_alike() of some views. */
int pictures_of_layers(picture_volumes *v, double iso, double step, const char *what);

#endif
