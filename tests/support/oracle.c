#include "tests/support/oracle.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tests/support/fields.h"

enum { THREADS_MAX = 64, SHOWN = 20, HITS_SHOWN = 64 };

void oracle_stop(int code, const char *name, const char *subject, const char *what) {
    fprintf(stderr, "%s: %s: %s\n", name, subject, what);
    exit(code);
}

static _Noreturn void usage(const oracle *o, const char *what) {
    oracle_stop(2, o->name, what, "see the head of its source, and tests/support/oracle.h");
}

void oracle_numbers(const oracle *o, const char *text, int count, double *out) {
    for (int i = 0; i < count; i++) {
        char *end;
        out[i] = strtod(text, &end);
        if (end == text || (*end == 0) != (i == count - 1))
            usage(o, text);
        text = end + 1;
    }
}

/* ---- arguments ---- */

static void set_camera(oracle *o, int option) {
    double n[2];
    switch (option) {
    case ORACLE_EYE:
        oracle_numbers(o, optarg, 3, o->camera.eye);
        o->eye = true;
        break;
    case ORACLE_LOOK_AT:
        oracle_numbers(o, optarg, 3, o->camera.look_at);
        o->look_at = true;
        break;
    case ORACLE_UP:
        oracle_numbers(o, optarg, 3, o->camera.up);
        o->up = true;
        break;
    case ORACLE_FOV:
        oracle_numbers(o, optarg, 1, &o->camera.fov);
        o->fov = true;
        break;
    case ORACLE_VIEW: o->distance = strcmp(optarg, "close") == 0 ? 1.1 : 2.2; break;
    default:
        oracle_numbers(o, optarg, 2, n);
        o->camera.width = (int)n[0];
        o->camera.height = (int)n[1];
    }
}

static void set_picture(oracle *o, int option) {
    switch (option) {
    case ORACLE_ISO:
        if (o->iso_count == ORACLE_ISOS)
            usage(o, "too many isovalues");
        oracle_numbers(o, optarg, 1, &o->isos[o->iso_count++]);
        break;
    case ORACLE_CLIP_BOX:
        oracle_numbers(o, optarg, 6, o->box[0]);
        o->clip.box = o->box;
        break;
    case ORACLE_CLIP_PLANE:
        if (o->clip.plane_count == ORACLE_PLANES)
            usage(o, "too many planes");
        oracle_numbers(o, optarg, 4, o->planes[o->clip.plane_count++]);
        o->clip.planes = o->planes;
        break;
    default: o->depth_path = optarg;
    }
}

static void set_sampling(oracle *o, int option) {
    double n[2];
    switch (option) {
    case ORACLE_EVERY: o->every = atol(optarg); break;
    case ORACLE_THREADS: o->threads = atoi(optarg); break;
    case ORACLE_PIXELS:
        oracle_numbers(o, optarg, 2, n);
        o->seed = (long)n[0];
        o->random_count = (long)n[1];
        break;
    default:
        oracle_numbers(o, optarg, 2, n);
        o->pixel[0] = (long)n[0];
        o->pixel[1] = (long)n[1];
    }
}

/* The line that reruns it, without the choice of pixels. */
static void remember(oracle *o, const char *option, const char *value) {
    size_t used = strlen(o->rerun);
    snprintf(o->rerun + used, sizeof o->rerun - used, " %s%s%s%s", option ? "--" : "",
             option ? option : value, option && value ? " " : "", option && value ? value : "");
}

int oracle_parse(oracle *o, const char *name, int argc, char **argv, const struct option *options,
                 void (*own)(void *ctx, int option), void *ctx) {
    int option, index;
    *o = (oracle){.name = name, .every = 1, .pixel = {-1, -1}, .distance = 2.2};
    o->clip.t1 = INFINITY;
    o->threads = (int)sysconf(_SC_NPROCESSORS_ONLN);
    o->threads = o->threads < 1 ? 1 : o->threads > THREADS_MAX ? THREADS_MAX : o->threads;
    snprintf(o->rerun, sizeof o->rerun, "%s", name);
    while ((option = getopt_long(argc, argv, "", options, &index)) != -1) {
        if (option == '?')
            usage(o, "unknown option");
        if (option >= ORACLE_OPTIONS_END)
            own(ctx, option);
        else if (option <= ORACLE_SIZE)
            set_camera(o, option);
        else if (option <= ORACLE_DEPTH)
            set_picture(o, option);
        else
            set_sampling(o, option);
        if (option < ORACLE_EVERY || option >= ORACLE_OPTIONS_END)
            remember(o, options[index].name, optarg);
    }
    for (int i = optind; i < argc; i++)
        remember(o, NULL, argv[i]);
    if (o->iso_count == 0 || o->camera.width < 1 || o->camera.height < 1)
        usage(o, "--size and at least one --iso, please");
    if (o->every < 1 || o->threads < 1 || o->threads > THREADS_MAX)
        usage(o, "--every and --threads start at 1");
    if (!o->depth_path && o->pixel[0] < 0)
        usage(o, "--depth FILE, or --pixel X,Y");
    return optind;
}

/* ---- pixels and distances ---- */

static void set_view(oracle *o) {
    const oracle_reference *r = o->reference;
    ref_camera standard =
        ref_view_of_box(r->lower, r->upper, o->distance, o->camera.width, o->camera.height);
    if (!o->eye)
        memcpy(o->camera.eye, standard.eye, sizeof standard.eye);
    if (!o->look_at)
        memcpy(o->camera.look_at, standard.look_at, sizeof standard.look_at);
    if (!o->up)
        memcpy(o->camera.up, standard.up, sizeof standard.up);
    if (!o->fov)
        o->camera.fov = standard.fov;
}

static void load_depth(oracle *o) {
    if (!o->depth_path)
        return;
    size_t count = (size_t)o->camera.width * (size_t)o->camera.height;
    FILE *in = fopen(o->depth_path, "rb");
    o->depth = malloc(count * sizeof o->depth[0]);
    if (!in || !o->depth || fread(o->depth, sizeof o->depth[0], count, in) != count ||
        getc(in) != EOF)
        oracle_stop(3, o->name, o->depth_path, "does not hold a double for each pixel");
    fclose(in);
}

static void choose_pixels(oracle *o) {
    size_t width = (size_t)o->camera.width, all = width * (size_t)o->camera.height;
    o->pixels = malloc((all + (size_t)o->random_count + 1) * sizeof o->pixels[0]);
    if (!o->pixels)
        oracle_stop(4, o->name, "pixels", "no room");
    field_random r = {(uint64_t)o->seed};
    if (o->pixel[0] >= 0)
        o->pixels[o->pixel_count++] = (size_t)o->pixel[0] + width * (size_t)o->pixel[1];
    else if (o->random_count > 0)
        for (long i = 0; i < o->random_count; i++)
            o->pixels[o->pixel_count++] = (size_t)field_random_below(&r, (long)all);
    else
        for (size_t i = 0; i < all; i += (size_t)o->every)
            o->pixels[o->pixel_count++] = i;
    for (size_t i = 0; i < o->pixel_count; i++)
        if (o->pixels[i] >= all)
            usage(o, "no such pixel");
}

/* ---- work ---- */

static void show_pixel(oracle *o, const ref_ray *ray, int x, int y, double depth,
                       ref_verdict verdict) {
    ref_hit hits[HITS_SHOWN];
    size_t count = o->reference->trace(o->reference->ctx, o, ray, hits, HITS_SHOWN);
    printf("pixel %d,%d: %s, got %.17g, %zu surfaces\n", x, y, ref_verdict_name(verdict), depth,
           count);
    for (size_t i = 0; i < count && i < HITS_SHOWN; i++)
        printf("  t %.17g cell %lld isovalue %d from %s\n", hits[i].t, (long long)hits[i].cell,
               hits[i].iso, hits[i].from_inside ? "inside" : "outside");
}

static void show_fault(oracle *o, const ref_ray *ray, int x, int y, double depth,
                       ref_verdict verdict) {
    ref_hit hit = {.t = INFINITY, .cell = -1, .iso = -1};
    o->reference->trace(o->reference->ctx, o, ray, &hit, 1);
    printf("%s: got %.17g, truth %.17g (cell %lld, isovalue %d); rerun: %s --pixel %d,%d\n",
           ref_verdict_name(verdict), depth, hit.t, (long long)hit.cell, hit.iso, o->rerun, x, y);
}

static void report(oracle *o, const ref_ray *ray, size_t at, ref_verdict verdict) {
    bool fault = verdict != REF_SAME && verdict != REF_GRAZING;
    int x = (int)(at % (size_t)o->camera.width), y = (int)(at / (size_t)o->camera.width);
    double depth = o->depth ? o->depth[at] : (double)NAN;
    pthread_mutex_lock(&o->lock);
    if (o->pixel[0] >= 0)
        show_pixel(o, ray, x, y, depth, verdict);
    else if (fault && o->shown++ < SHOWN)
        show_fault(o, ray, x, y, depth, verdict);
    pthread_mutex_unlock(&o->lock);
}

static void *work(void *context) {
    oracle *o = context;
    const oracle_reference *r = o->reference;
    ref_tally tally = {0};
    size_t i;
    while ((i = atomic_fetch_add(&o->next, 1)) < o->pixel_count) {
        size_t at = o->pixels[i], width = (size_t)o->camera.width;
        ref_ray ray = ref_primary_ray(&o->camera, (int)(at % width), (int)(at / width));
        ref_verdict verdict = REF_SAME;
        if (o->depth)
            verdict = r->judge(r->ctx, o, &ray, o->depth[at], &tally);
        if (verdict != REF_SAME || o->pixel[0] >= 0)
            report(o, &ray, at, verdict);
    }
    pthread_mutex_lock(&o->lock);
    ref_tally_add(&o->tally, &tally);
    pthread_mutex_unlock(&o->lock);
    return NULL;
}

static void share_out(oracle *o) {
    pthread_t threads[THREADS_MAX];
    int started = 0;
    for (; started < o->threads - 1; started++)
        if (pthread_create(&threads[started], NULL, work, o) != 0)
            break;
    work(o);
    for (int i = 0; i < started; i++)
        pthread_join(threads[i], NULL);
}

int oracle_run(oracle *o, const oracle_reference *reference) {
    o->reference = reference;
    pthread_mutex_init(&o->lock, NULL);
    set_view(o);
    load_depth(o);
    choose_pixels(o);
    share_out(o);
    if (o->depth) {
        ref_tally_heading(stdout, "picture");
        ref_tally_row(stdout, reference->title, &o->tally);
    }
    free(o->depth);
    free(o->pixels);
    pthread_mutex_destroy(&o->lock);
    return ref_tally_faults(&o->tally) ? 1 : 0;
}
