/* oracle.h - what the tools have in common that hold pictures of distances (render --depth-f64)
 * against a reference: their options, the choice of pixels, threads, the report.
 *
 *   --size WxH --iso V [--iso V]...        what was rendered; the camera is that of render:
 *   --eye --look-at --up --fov             X,Y,Z; the standard view where nothing is said
 *   --view close                           the close one
 *   --clip-box X,Y,Z,X,Y,Z --clip-plane X,Y,Z,W
 *   --depth FILE                           doubles; without it, the distances themselves
 *   --every N, --pixels SEED,COUNT, --pixel X,Y      else all
 *   --threads N
 */
#ifndef TESTS_SUPPORT_ORACLE_H
#define TESTS_SUPPORT_ORACLE_H

#include <getopt.h>
#include <pthread.h>
#include <stdatomic.h>

#include "tests/support/ref_camera.h"
#include "tests/support/ref_judge.h"

enum { ORACLE_ISOS = 32, ORACLE_PLANES = 16 };

typedef struct oracle {
    const char *name; /* the program */
    ref_camera camera;
    double isos[ORACLE_ISOS];
    int iso_count;
    ref_clip clip;
    /* the rest is oracle.c's */
    bool eye, look_at, up, fov;
    double distance; /* of the standard view */
    double planes[ORACLE_PLANES][4], box[2][3];
    const char *depth_path;
    double *depth;
    long every, seed, random_count, pixel[2];
    size_t *pixels, pixel_count;
    int threads;
    char rerun[4096];
    const struct oracle_reference *reference;
    atomic_size_t next;
    pthread_mutex_t lock;
    ref_tally tally;
    int shown;
} oracle;

/* The reference: both are called by many threads at once. */
typedef struct oracle_reference {
    const void *ctx;
    const char *title;         /* of the row in the table */
    double lower[3], upper[3]; /* the world box of what was rendered */
    /* ref_judge(), ref_trace() or what is like them */
    ref_verdict (*judge)(const void *ctx, const oracle *o, const ref_ray *ray, double depth,
                         ref_tally *tally);
    size_t (*trace)(const void *ctx, const oracle *o, const ref_ray *ray, ref_hit *hits,
                    size_t capacity);
} oracle_reference;

/* For the list of getopt_long(); a tool's own options are numbered from ORACLE_OPTIONS_END on. */
enum {
    ORACLE_EYE = 256,
    ORACLE_LOOK_AT,
    ORACLE_UP,
    ORACLE_FOV,
    ORACLE_VIEW,
    ORACLE_SIZE,
    ORACLE_ISO,
    ORACLE_CLIP_BOX,
    ORACLE_CLIP_PLANE,
    ORACLE_DEPTH,
    ORACLE_EVERY,
    ORACLE_PIXELS,
    ORACLE_PIXEL,
    ORACLE_THREADS,
    ORACLE_OPTIONS_END
};
#define ORACLE_OPTIONS                                                                            \
    {"eye", 1, NULL, ORACLE_EYE}, {"look-at", 1, NULL, ORACLE_LOOK_AT},                           \
        {"up", 1, NULL, ORACLE_UP}, {"fov", 1, NULL, ORACLE_FOV}, {"view", 1, NULL, ORACLE_VIEW}, \
        {"size", 1, NULL, ORACLE_SIZE}, {"iso", 1, NULL, ORACLE_ISO},                             \
        {"clip-box", 1, NULL, ORACLE_CLIP_BOX}, {"clip-plane", 1, NULL, ORACLE_CLIP_PLANE},       \
        {"depth", 1, NULL, ORACLE_DEPTH}, {"every", 1, NULL, ORACLE_EVERY},                       \
        {"pixels", 1, NULL, ORACLE_PIXELS}, {"pixel", 1, NULL, ORACLE_PIXEL}, {                   \
        "threads", 1, NULL, ORACLE_THREADS                                                        \
    }

/* oracle_parse() - all options; those from ORACLE_OPTIONS_END on go to own(ctx, option), and
 * oracle_stop() is called when anything is wrong. Returns argv's first word that is no option. */
int oracle_parse(oracle *o, const char *name, int argc, char **argv, const struct option *options,
                 void (*own)(void *ctx, int option), void *ctx);

/* oracle_numbers() - exactly `count` numbers, split by single characters, or oracle_stop(). */
void oracle_numbers(const oracle *o, const char *text, int count, double *out);

/* oracle_run() - judge the pixels and print a table; a line that reruns it for each that is wrong;
 * all surfaces of a --pixel. Returns the exit status: 1 when there are faults. */
int oracle_run(oracle *o, const oracle_reference *reference);

/* oracle_stop() - a message, and the end of the program. */
_Noreturn void oracle_stop(int code, const char *name, const char *subject, const char *what);

#endif
