/* between_lab.h - series of a small grid or mesh, for tests of times between its steps; and what
 * they compare with: a file of the samples between, alone, that the laboratory makes itself. Of a
 * mesh, samples are those of between_mesh.h: coordinates, too.
 */
#ifndef TESTS_SUPPORT_BETWEEN_LAB_H
#define TESTS_SUPPORT_BETWEEN_LAB_H

#include "tests/support/leaf_files.h"
#include "tests/support/pictures.h"

enum {
    BETWEEN_STEPS = 6, /* more pairs than sets of leaf_between.h */
    BETWEEN_SIDE = 36,
    BETWEEN_SAMPLES = BETWEEN_SIDE * BETWEEN_SIDE * BETWEEN_SIDE,
    BETWEEN_GRIDS = 7, /* kinds, of which the others are meshes: 4 of tets, 4 of hexahedra */
    BETWEEN_HEXES = BETWEEN_GRIDS + 4,
    BETWEEN_KINDS = BETWEEN_HEXES + 4,
    BETWEEN_SHARES = 5
};

/* The cells between a mesh's points. */
typedef enum between_cells { BETWEEN_TETS, BETWEEN_MIXED, BETWEEN_CURVILINEAR } between_cells;

/* What a series is like. */
typedef struct between_kind {
    sample_type type;
    leaf_codec codec;
    bool bare, grown; /* levels 1; the last steps were added to the file */
    bool small;       /* a small ball, that is at another place in each step */
    int non_finite;   /* of f32: one sample in so many is NaN or infinite; 0: none */
    bool mesh, moves; /* a mesh, whose points move; between_mesh.h */
    between_cells cells;
} between_kind;

typedef struct between_lab {
    between_kind of;
    char series[256];
    float *step[BETWEEN_STEPS]; /* samples */
    double iso;
    leafcast_camera view;
} between_lab;

extern const double between_times[BETWEEN_STEPS];
extern const double between_shares[BETWEEN_SHARES]; /* of the way from a step to the next */
extern const between_kind between_kinds[BETWEEN_KINDS];

/* between_lab_make() - a ball that moves along x and gets larger. Nothing changes at the other end,
 * and step 3 is step 2 with but one other sample. */
between_lab *between_lab_make(const between_kind *of);
void between_lab_free(between_lab *s);

/* between_lab_mix() - the sample between two. between_lab_blend() - all of them; the caller frees
 * them. between_lab_alone() - a file of these. */
float between_lab_mix(float a, float b, double share);
float *between_lab_blend(const between_lab *s, uint32_t step, double share);
const char *between_lab_alone(const between_lab *s, const float *samples);

/* between_lab_open() - a volume that shows an isosurface; options may be NULL. between_lab_fine(),
 * between_lab_refused() - fail the test unless a call ended well, or so, with this in its text. */
leafcast *between_lab_open(const char *path, const leafcast_options *o, double iso);
void between_lab_fine(leafcast_status st);
void between_lab_refused(leafcast_status st, leafcast_status as, const char *text);

/* between_lab_scene() - what may be drawn. between_lab_same() - fail the test unless all pixels of
 * both are the same. Returns those that show something. */
enum { SURFACE, SHADOWS, CLIPPED, ANALYTIC, LARGEST, FIRST, LOOKS };
leafcast_scene between_lab_scene(const between_lab *s, int look);
int between_lab_same(const picture *is, const picture *want, const char *what);

#endif
