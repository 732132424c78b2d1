/* view_options_keys.h - the keys of the flags of view_options.h, but for those of media
 * (medium_options.h), which follow: for its own files. */
#ifndef RENDER_APP_VIEW_OPTIONS_KEYS_H
#define RENDER_APP_VIEW_OPTIONS_KEYS_H

#include <stdint.h>

enum {
    ISO = 0x2000,
    COLOUR,
    OPACITY,
    LAYERS,
    SAMPLES,
    EYE,
    LOOK_AT,
    UP,
    FOV,
    VIEW,
    SIZE,
    SHADING,
    NORMALS,
    LIGHT,
    POINT_LIGHT,
    SHADOWS,
    AMBIENT,
    SPECULAR,
    SHININESS,
    BACKGROUND,
    CLIP_BOX,
    CLIP_PLANE,
    LOD,
    PREVIEW,
    SWEEP,
    INTERSECTOR,
    FIELD,
    STEP,
    ORTHO,
    TIME,
    INTERPOLATE,
    LIGHT_SAMPLES,
    OCCLUSION,
    REFLECT,
    COLOUR_BY,
    REFRACT
};

/* view_options_bit() - the bit of a key in view_options.given. */
static inline uint64_t view_options_bit(int key) {
    return (uint64_t)1 << (key - ISO);
}

#endif
