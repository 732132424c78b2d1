/* batch_stage.h - a volume and a kind's kernels that trace batches of rays through it: each ray has
 * the answer of tracer_next() to the bit, whatever goes with it, the ISA, and which treelets are
 * there. */
#ifndef TESTS_SUPPORT_BATCH_STAGE_H
#define TESTS_SUPPORT_BATCH_STAGE_H

#include "render/door/leafcast_volume.h"
#include "render/ray/kind.h"
#include "tests/support/fields.h"

enum { BATCH_STAGE_KERNELS = 5 };

typedef struct batch_stage {
    /* Set by the test, as the volume, on which something is selected: */
    const char *name;
    leafcast *v;
    batch_fn wide;  /* as AVX-512 traces them, on any CPU */
    double size[3]; /* of the volume */
    /* A line that has a chance to meet the volume. */
    void (*line)(const void *lab, field_random *random, double o[3], double d[3]);
    const void *lab;
    /* By batch_stage_set(): */
    leafcast_scene scene;
    tracer tr;
    const char *kernel_name[BATCH_STAGE_KERNELS];
    ray_kernels kernels[BATCH_STAGE_KERNELS];
    int kernel_count;
    uint32_t treelets;
    uint8_t *walked; /* by single rays */
    void *scratch;
    field_random random;
    uint64_t rays, hits, blocked;
} batch_stage;

/* batch_stage_set() - what is selected on the volume is `surfaces`. batch_stage_close(): the
 * volume, too. */
void batch_stage_set(batch_stage *s, const leafcast_surface surfaces[], int count, bool smooth);
void batch_stage_close(batch_stage *s);

/* batch_stage_load() - some of the active treelets are there, or all. */
void batch_stage_load(batch_stage *s, bool all);

/* batch_stage_ray() - a line, of some length, cut somehow. batch_stage_secondary(): from a surface
 * that it meets towards somewhere, as shadows and mirrors begin. False: it has come to nothing.
 * batch_stage_fill(): rays of all sorts, side by side or not. */
bool batch_stage_ray(batch_stage *s, ray *r);
bool batch_stage_secondary(batch_stage *s, ray *r, trace_state *state);
void batch_stage_fill(batch_stage *s, ray_batch *b);

/* batch_stage_single() - traces rays one by one; counts them. batch_stage_check(): by every kernel;
 * fails where a ray has another answer. all: treelets are there. */
void batch_stage_single(batch_stage *s, const ray_batch *begun, ray_batch *want);
void batch_stage_check(batch_stage *s, const ray_batch *begun, bool all);

/* batch_stage_together() - how many times as many nodes single rays visit as this batch. */
double batch_stage_together(batch_stage *s, const ray_batch *b);

#endif
