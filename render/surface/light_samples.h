/* light_samples.h - where rays go to lights that have a radius, and to what hides ambient light.
 *
 * Of each of N rays of a pixel, n samples are taken. Sample k of ray s has the number m = s n + k,
 * and the point of the unit square
 *
 *   u = (m + 1/2) / (n N) + a x + b y + c q     v = m's bits reversed / 2^32 + b x + a y
 *
 * all modulo 1, in 32 bits: Hammersley's points, moved from pixel to pixel. x and y count the
 * pixels of the whole picture, and q the lights, ambient light behind them. a, b: the numbers of
 * Roberts's R2 sequence, which spread over neighbouring pixels; c: the golden ratio's. So a sample
 * depends on nothing else: not on threads, kernels, memory or the part of the picture drawn.
 */
#ifndef RENDER_SURFACE_LIGHT_SAMPLES_H
#define RENDER_SURFACE_LIGHT_SAMPLES_H

#include "render/frame/frame.h"

/* A unit direction, and how far a ray goes. */
typedef struct lit_way {
    double to[3], distance;
} lit_way;

/* light_samples_point() - set uv to the point of sample k of n; q: see above. */
void light_samples_point(const frame *f, uint32_t pixel, uint32_t q, int k, int n, double uv[2]);

/* light_samples_light() - returns the way to a light's sample. Directions are spread evenly over
 * the cone that the light fills; the way ends at the ball. middle: the way to the light's middle,
 * which a ball must be farther from than its radius. */
lit_way light_samples_light(const leafcast_light *light, const lit_way *middle, const double uv[2]);

/* light_samples_about() - set `to` to a direction about a unit normal, spread by the cosine. */
void light_samples_about(const float normal[3], const double uv[2], double to[3]);

#endif
