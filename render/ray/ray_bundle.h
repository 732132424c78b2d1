/* ray_bundle.h - rays that share an order of treelets: all from the eye, or all towards a light.
 *
 * Each leg of a ray's way belongs to a bundle. Treelets are requested in the bundle's order, so
 * nearly every one is read only once even when few can be resident.
 */
#ifndef RENDER_RAY_RAY_BUNDLE_H
#define RENDER_RAY_RAY_BUNDLE_H

typedef struct ray_bundle {
    enum { RAYS_FROM, RAYS_TOWARDS, RAYS_ALONG } way;
    double
        vector[3]; /* world space: the point that all rays come from or go to, or their direction */
} ray_bundle;

#endif
