/* ray_bundle.h - rays that have an order of treelets in common: from the eye, towards a light.
 *
 * Each leg of a ray's way belongs to a bundle. Treelets are asked for in its order, so that with
 * few of them resident at a time nearly every one is still read once.
 */
#ifndef RENDER_RAY_RAY_BUNDLE_H
#define RENDER_RAY_RAY_BUNDLE_H

typedef struct ray_bundle {
    enum { RAYS_FROM, RAYS_TOWARDS, RAYS_ALONG } way;
    double vector[3]; /* world space: a point that all come from or go to; their direction */
} ray_bundle;

#endif
