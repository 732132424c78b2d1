/* api_draw.h - arguments of the public calls, drawn at random: right ones of small volumes and
 * pictures, and then, now and then, one of their fields at the end of its range, beyond it, NaN,
 * random bits. Never what no call could look at: arrays that are shorter than their count, pictures
 * that are larger than their planes, pointers to nowhere.
 */
#ifndef TESTS_SUPPORT_API_DRAW_H
#define TESTS_SUPPORT_API_DRAW_H

#include "prep/leafcast_prep.h"
#include "render/leafcast_experimental.h"
#include "tests/support/fields.h"

enum { API_SIDE = 8, API_VOLUMES = 4, API_ROOM = 32, API_POINTS = 6, API_LINE = 5 };

/* api_chance() - once in n. api_number() - about x, or any odd number. */
bool api_chance(field_random *r, long n);
double api_number(field_random *r, double x);

/* A scene and all that it points to; may not be copied. */
typedef struct api_scene {
    leafcast_scene scene;
    leafcast_shown shown[API_ROOM];
    leafcast_surface surfaces[API_ROOM][LEAFCAST_SURFACES_MAX];
    leafcast_medium media[API_ROOM], colours, shown_colours[API_ROOM];
    leafcast_colouring by[API_ROOM];
    leafcast_transfer_point points[2 * API_ROOM + 1][API_POINTS];
    leafcast_scene_experiments experiments;
} api_scene;

/* api_draw_scene() - of some of these volumes, of which there is one at least. */
void api_draw_scene(field_random *r, leafcast *const volumes[], int count, api_scene *s);

void api_draw_surfaces(field_random *r, const leafcast *v,
                       leafcast_surface surfaces[LEAFCAST_SURFACES_MAX], int *count);
void api_draw_camera(field_random *r, const leafcast *v, leafcast_camera *c);

/* api_draw_image() - planes of their own, exactly as large as they must be, which api_free_image()
 * gives back. */
void api_draw_image(field_random *r, const leafcast_camera *c, leafcast_image *image);
void api_free_image(leafcast_image *image);

void api_draw_place(field_random *r, const leafcast *v, double point[3]);
void api_draw_direction(field_random *r, double direction[3]);
void api_draw_ray(field_random *r, const leafcast *v, leafcast_ray *ray);

/* api_draw_slice() - its line, if it has one, lies in line[]. */
void api_draw_slice(field_random *r, const leafcast *v, double line[API_LINE][3],
                    leafcast_slice_pixels *slice);

/* api_draw_options() - experiments lie in *e. device: NULL, or one that it may be on. */
void api_draw_options(field_random *r, leafcast_device *device, leafcast_experiments *e,
                      leafcast_options *o);
void api_draw_convert_options(field_random *r, leafcast_convert_options *o);
void api_draw_grid(field_random *r, leafcast_grid *g);

#endif
