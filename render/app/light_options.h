/* light_options.h - the values of flags about light: lights, soft shadows, what hides ambient
 * light, reflections, refractions.
 */
#ifndef RENDER_APP_LIGHT_OPTIONS_H
#define RENDER_APP_LIGHT_OPTIONS_H

#include "formats/base/status.h"
#include "render/leafcast.h"

/* light_options_add() - add the light of "X,Y,Z[,R,G,B][,RADIUS]" to the scene. */
CHECKED status light_options_add(leafcast_scene *scene, bool point, const char *text);

/* light_options_remove() - remove all point lights, or all others. */
void light_options_remove(leafcast_scene *scene, bool point);

/* light_options_soft() - whether a light has a radius. */
bool light_options_soft(const leafcast_scene *scene);

/* light_options_occlusion() - take "DISTANCE[,SAMPLES]". */
CHECKED status light_options_occlusion(const char *text, leafcast_scene *scene);

/* light_options_reflect() - take "WEIGHT[,BOUNCES]" for a surface, light_options_refract() -
 * "INDEX[,BOUNCES]". *bounces stays where they are not given. */
enum { LIGHT_OPTIONS_BENDS = 4 }; /* bounces of refractions that ask for none */
CHECKED status light_options_reflect(const char *text, leafcast_surface *surface, int *bounces);
CHECKED status light_options_refract(const char *text, leafcast_surface *surface, int *bounces);

#endif
