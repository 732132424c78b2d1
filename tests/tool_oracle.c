/* tool_oracle.c - compare an image of distances (render --depth-f64) with the reference, pixel by
 * pixel.
 *
 *   oracle VOLUME --depth FILE --size WxH --iso V [--iso V]... [options]
 *
 * VOLUME is a plain NRRD file, or raw samples with --dims X,Y,Z --type
 * u8|i8|u16|i16|u32|i32|f32|f64 [--skip BYTES] [--big]
 * [--spacing X,Y,Z] [--origin X,Y,Z]; node coordinates of a rectilinear one come from --axis-x, -y,
 * -z FILE. The camera is that of render: --eye --look-at --up --fov, the standard view where
 * nothing is said, --view close. --clip-box and
 * --clip-plane likewise. Without --depth the distances themselves are printed. Pixels: all, --every
 * N, --pixels SEED,COUNT or --pixel X,Y.
 *
 * Prints a table; a line that reruns it for each pixel that is wrong. Exit status 1 if, outside the
 * grazing band, a surface is missed, false, or more than 1e-4 cell off.
 */
#include <getopt.h>
#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tests/support/fields.h"
#include "tests/support/ref_camera.h"
#include "tests/support/ref_judge.h"
#include "tests/support/ref_load.h"

enum { ISO_MAX = 32, PLANES_MAX = 16, THREADS_MAX = 64, SHOWN = 20 };

typedef struct job {
    ref_source source;
    ref_volume volume;
    ref_camera camera;
    bool eye, look_at, up, fov;
    double distance; /* of the standard view */
    double isos[ISO_MAX];
    int iso_count;
    ref_clip clip;
    double planes[PLANES_MAX][4], box[2][3];
    const char *depth_path;
    double *depth;
    long every, seed, random_count, pixel[2];
    size_t *pixels, pixel_count;
    int threads;
    char rerun[4096];
    /* shared by the threads */
    atomic_size_t next;
    pthread_mutex_t lock;
    ref_tally tally;
    int shown;
} job;

static void usage(const char *what) {
    fprintf(stderr, "oracle: %s (see the head of tests/tool_oracle.c)\n", what);
    exit(2);
}

/* Exactly `count` numbers, split by single characters. */
static void numbers(const char *text, int count, double *out) {
    for (int i = 0; i < count; i++) {
        char *end;
        out[i] = strtod(text, &end);
        if (end == text || (*end == 0) != (i == count - 1))
            usage(text);
        text = end + 1;
    }
}

/* ---- arguments ---- */

enum {
    DIMS = 256,
    TYPE,
    SKIP,
    BIG,
    SPACING,
    ORIGIN,
    AXIS_X,
    AXIS_Y,
    AXIS_Z,
    EYE,
    LOOK_AT,
    UP,
    FOV,
    VIEW,
    SIZE,
    ISO,
    CLIP_BOX,
    CLIP_PLANE,
    DEPTH,
    EVERY,
    PIXELS,
    PIXEL,
    THREADS
};

static const struct option options[] = {
    {"dims", 1, NULL, DIMS},         {"type", 1, NULL, TYPE},
    {"skip", 1, NULL, SKIP},         {"big", 0, NULL, BIG},
    {"spacing", 1, NULL, SPACING},   {"origin", 1, NULL, ORIGIN},
    {"axis-x", 1, NULL, AXIS_X},     {"axis-y", 1, NULL, AXIS_Y},
    {"axis-z", 1, NULL, AXIS_Z},     {"eye", 1, NULL, EYE},
    {"look-at", 1, NULL, LOOK_AT},   {"up", 1, NULL, UP},
    {"fov", 1, NULL, FOV},           {"view", 1, NULL, VIEW},
    {"size", 1, NULL, SIZE},         {"iso", 1, NULL, ISO},
    {"clip-box", 1, NULL, CLIP_BOX}, {"clip-plane", 1, NULL, CLIP_PLANE},
    {"depth", 1, NULL, DEPTH},       {"every", 1, NULL, EVERY},
    {"pixels", 1, NULL, PIXELS},     {"pixel", 1, NULL, PIXEL},
    {"threads", 1, NULL, THREADS},   {NULL, 0, NULL, 0},
};

static void set_source(job *j, int option, double spacing[3], double origin[3]) {
    double n[3];
    switch (option) {
    case DIMS:
        numbers(optarg, 3, n);
        for (int a = 0; a < 3; a++)
            j->source.dims[a] = (long)n[a];
        break;
    case TYPE: j->source.type = optarg; break;
    case SKIP: j->source.skip = atol(optarg); break;
    case BIG: j->source.big_endian = true; break;
    case SPACING: numbers(optarg, 3, spacing); break;
    case ORIGIN: numbers(optarg, 3, origin); break;
    default: j->source.axis_path[option - AXIS_X] = optarg; break;
    }
}

static void set_view(job *j, int option) {
    double n[6];
    switch (option) {
    case EYE:
        numbers(optarg, 3, j->camera.eye);
        j->eye = true;
        break;
    case LOOK_AT:
        numbers(optarg, 3, j->camera.look_at);
        j->look_at = true;
        break;
    case UP:
        numbers(optarg, 3, j->camera.up);
        j->up = true;
        break;
    case FOV:
        numbers(optarg, 1, &j->camera.fov);
        j->fov = true;
        break;
    case VIEW: j->distance = strcmp(optarg, "close") == 0 ? 1.1 : 2.2; break;
    case SIZE:
        numbers(optarg, 2, n);
        j->camera.width = (int)n[0];
        j->camera.height = (int)n[1];
        break;
    case CLIP_BOX:
        numbers(optarg, 6, j->box[0]);
        j->clip.box = j->box;
        break;
    case CLIP_PLANE:
        if (j->clip.plane_count == PLANES_MAX)
            usage("too many planes");
        numbers(optarg, 4, j->planes[j->clip.plane_count++]);
        j->clip.planes = j->planes;
        break;
    default: usage("unknown option");
    }
}

static void set_rest(job *j, int option) {
    double n[2];
    switch (option) {
    case ISO:
        if (j->iso_count == ISO_MAX)
            usage("too many isovalues");
        numbers(optarg, 1, &j->isos[j->iso_count++]);
        break;
    case DEPTH: j->depth_path = optarg; break;
    case EVERY: j->every = atol(optarg); break;
    case THREADS: j->threads = atoi(optarg); break;
    case PIXELS:
        numbers(optarg, 2, n);
        j->seed = (long)n[0];
        j->random_count = (long)n[1];
        break;
    case PIXEL:
        numbers(optarg, 2, n);
        j->pixel[0] = (long)n[0];
        j->pixel[1] = (long)n[1];
        break;
    default: set_view(j, option);
    }
}

static void parse(job *j, int argc, char **argv) {
    double spacing[3] = {1, 1, 1}, origin[3] = {0, 0, 0};
    int option;
    while ((option = getopt_long(argc, argv, "", options, NULL)) != -1) {
        if (option == '?')
            usage("unknown option");
        if (option <= AXIS_Z)
            set_source(j, option, spacing, origin);
        else
            set_rest(j, option);
        bool sampling = option == EVERY || option == PIXELS || option == PIXEL || option == THREADS;
        size_t used = strlen(j->rerun);
        if (!sampling)
            snprintf(j->rerun + used, sizeof j->rerun - used, " --%s %s",
                     options[option - DIMS].name, optarg ? optarg : "");
    }
    if (optind != argc - 1 || j->iso_count == 0 || j->camera.width < 1 || j->camera.height < 1)
        usage("one VOLUME, --size and at least one --iso, please");
    if (j->every < 1 || j->threads < 1 || j->threads > THREADS_MAX)
        usage("--every and --threads start at 1");
    j->source.path = argv[optind];
    size_t used = strlen(j->rerun);
    snprintf(j->rerun + used, sizeof j->rerun - used, " %s", argv[optind]);
    ref_source_set(&j->source, spacing, origin);
}

/* ---- pixels and distances ---- */

static void load(job *j) {
    const char *why;
    if (!ref_load(&j->source, &j->volume, &why)) {
        fprintf(stderr, "oracle: %s: %s\n", j->source.path, why);
        exit(3);
    }
    ref_camera standard =
        ref_standard_view(&j->volume, j->distance, j->camera.width, j->camera.height);
    if (!j->eye)
        memcpy(j->camera.eye, standard.eye, sizeof standard.eye);
    if (!j->look_at)
        memcpy(j->camera.look_at, standard.look_at, sizeof standard.look_at);
    if (!j->up)
        memcpy(j->camera.up, standard.up, sizeof standard.up);
    if (!j->fov)
        j->camera.fov = standard.fov;
    if (!j->depth_path)
        return;
    size_t count = (size_t)j->camera.width * (size_t)j->camera.height;
    FILE *in = fopen(j->depth_path, "rb");
    j->depth = malloc(count * sizeof j->depth[0]);
    if (!in || !j->depth || fread(j->depth, sizeof j->depth[0], count, in) != count ||
        getc(in) != EOF) {
        fprintf(stderr, "oracle: %s does not hold %zu doubles\n", j->depth_path, count);
        exit(3);
    }
    fclose(in);
}

static void choose_pixels(job *j) {
    size_t width = (size_t)j->camera.width, all = width * (size_t)j->camera.height;
    j->pixels = malloc((all + (size_t)j->random_count + 1) * sizeof j->pixels[0]);
    if (!j->pixels)
        exit(4);
    field_random r = {(uint64_t)j->seed};
    if (j->pixel[0] >= 0)
        j->pixels[j->pixel_count++] = (size_t)j->pixel[0] + width * (size_t)j->pixel[1];
    else if (j->random_count > 0)
        for (long i = 0; i < j->random_count; i++)
            j->pixels[j->pixel_count++] = (size_t)field_random_below(&r, (long)all);
    else
        for (size_t i = 0; i < all; i += (size_t)j->every)
            j->pixels[j->pixel_count++] = i;
    for (size_t i = 0; i < j->pixel_count; i++)
        if (j->pixels[i] >= all)
            usage("no such pixel");
}

/* ---- work ---- */

static void report(job *j, const ref_ray *ray, size_t at, ref_verdict verdict) {
    bool fault = verdict != REF_SAME && verdict != REF_GRAZING;
    int x = (int)(at % (size_t)j->camera.width), y = (int)(at / (size_t)j->camera.width);
    pthread_mutex_lock(&j->lock);
    if (j->pixel[0] >= 0) {
        ref_hit hits[64];
        size_t count = ref_trace(&j->volume, ray, j->isos, j->iso_count, &j->clip, hits, 64);
        printf("pixel %d,%d: %s, got %.17g, %zu surfaces\n", x, y, ref_verdict_name(verdict),
               j->depth ? j->depth[at] : (double)NAN, count);
        for (size_t i = 0; i < count && i < 64; i++)
            printf("  t %.17g cell %lld isovalue %d from %s\n", hits[i].t, (long long)hits[i].cell,
                   hits[i].iso, hits[i].from_inside ? "inside" : "outside");
    } else if (fault && j->shown++ < SHOWN) {
        ref_print_fault(stdout, &j->volume, ray, j->isos, j->iso_count, &j->clip, j->depth[at],
                        verdict, j->rerun, x, y);
    }
    pthread_mutex_unlock(&j->lock);
}

static void *work(void *context) {
    job *j = context;
    ref_tally tally = {0};
    size_t i;
    while ((i = atomic_fetch_add(&j->next, 1)) < j->pixel_count) {
        size_t at = j->pixels[i], width = (size_t)j->camera.width;
        ref_ray ray = ref_primary_ray(&j->camera, (int)(at % width), (int)(at / width));
        ref_verdict verdict = REF_SAME;
        if (j->depth)
            verdict =
                ref_judge(&tally, &j->volume, &ray, j->isos, j->iso_count, &j->clip, j->depth[at]);
        if (verdict != REF_SAME || j->pixel[0] >= 0)
            report(j, &ray, at, verdict);
    }
    pthread_mutex_lock(&j->lock);
    ref_tally_add(&j->tally, &tally);
    pthread_mutex_unlock(&j->lock);
    return NULL;
}

static void run(job *j) {
    pthread_t threads[THREADS_MAX];
    int started = 0;
    for (; started < j->threads - 1; started++)
        if (pthread_create(&threads[started], NULL, work, j) != 0)
            break;
    work(j);
    for (int i = 0; i < started; i++)
        pthread_join(threads[i], NULL);
}

int main(int argc, char **argv) {
    static job j = {.every = 1, .pixel = {-1, -1}, .distance = 2.2, .rerun = "tool_oracle"};
    j.threads = (int)sysconf(_SC_NPROCESSORS_ONLN);
    j.threads = j.threads < 1 ? 1 : j.threads > THREADS_MAX ? THREADS_MAX : j.threads;
    j.clip.t1 = INFINITY;
    pthread_mutex_init(&j.lock, NULL);
    parse(&j, argc, argv);
    if (!j.depth_path && j.pixel[0] < 0)
        usage("--depth FILE, or --pixel X,Y");
    load(&j);
    choose_pixels(&j);
    run(&j);
    if (j.depth) {
        ref_tally_heading(stdout, "volume");
        const char *slash = strrchr(j.source.path, '/');
        ref_tally_row(stdout, slash ? slash + 1 : j.source.path, &j.tally);
    }
    ref_unload(&j.volume);
    free(j.depth);
    free(j.pixels);
    return ref_tally_faults(&j.tally) ? 1 : 0;
}
