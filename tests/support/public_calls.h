/* public_calls.h - every function of the public headers, called with all that it takes from one
 * place, where tests put wrong things. */
#ifndef TESTS_SUPPORT_PUBLIC_CALLS_H
#define TESTS_SUPPORT_PUBLIC_CALLS_H

#include "formats/public_fields.h"
#include "prep/leafcast_prep.h"
#include "render/leafcast_experimental.h"

enum { CALLS_SIDE = 4, CALLS_SOME = 2 };

/* What calls are given: structs, of which some point to others here, and arrays. */
typedef enum calls_slot {
    CALLS_VOLUME,
    CALLS_LIVE,   /* a live volume */
    CALLS_MOVING, /* triangles that move */
    CALLS_FRAME,
    CALLS_OPTIONS,
    CALLS_SURFACES,
    CALLS_SCENE,
    CALLS_CAMERA,
    CALLS_IMAGE,
    CALLS_STATS,
    CALLS_INFO,
    CALLS_CELL,
    CALLS_RAYS,
    CALLS_SLICE,
    CALLS_CONVERT_OPTIONS,
    CALLS_GRID,
    CALLS_TETS,
    CALLS_TRIANGLES,
    CALLS_POSITIONS, /* of their vertices */
    CALLS_PATH,      /* of a treelet file */
    CALLS_BYTES,     /* of one */
    CALLS_OUT,       /* pointers to what a call makes: a volume, a device, a frame */
    CALLS_PLACES,    /* 12 numbers each */
    CALLS_VECTOR,    /* an origin, a point, a plane */
    CALLS_VECTOR2,   /* a direction */
    CALLS_NUMBERS,   /* isovalues, values of a slice */
    CALLS_COUNT,     /* to be filled */
    CALLS_FOUND,     /* room for hits, samples, a histogram, a map */
    CALLS_DONE,
    CALLS_TEXT, /* the name of a field */
    CALLS_BLOCKS,
    CALLS_SAMPLES, /* of a grid that is converted */
    CALLS_SLICES,  /* any pointer: a function that delivers them */
    CALLS_OUTPUT,  /* the path that is converted to */
    CALLS_SLOTS
} calls_slot;

typedef struct calls_lab {
    void *p[CALLS_SLOTS];
    int max, count, axis;
    uint32_t field, step, level, node, width, height, steps;
    size_t many;
    double seconds, fov, distance, x;
    uint64_t beside;
    leafcast_device *device; /* of the volume */
} calls_lab;

typedef struct public_call {
    const char *name;
    leafcast_status (*call)(calls_lab *l); /* NULL: there is nothing that may be wrong */
    uint64_t needs, takes, sizes; /* slots, as bits: that may not be NULL; that are structs and
                                     looked at, all of them; whose `size` is */
    const char *only;             /* fields of what it takes, with blanks around; NULL: all */
} public_call;

/* public_calls() - all of them, *count. */
const public_call *public_calls(int *count);

/* public_calls_table() - of the fields of a public struct; NULL: it has none. */
const public_fields *public_calls_table(const char *name);

/* public_calls_set_up() - a small grid, opened, and arguments of which all calls make something,
 * and all arrays have elements. public_calls_tear_down() - ends that. */
void public_calls_set_up(calls_lab *l);
void public_calls_tear_down(calls_lab *l);

/* public_calls_draw() - a picture of the volume, as it was selected; fails the test where there is
 * none. */
void public_calls_draw(const calls_lab *l, double z[CALLS_SIDE * CALLS_SIDE]);

#endif
