/* gray_scott.c - a simulation that draws itself while it runs: reaction and diffusion after Gray
 * and Scott, in a cube without walls. One thread steps; another draws every SHOWN-th step
 * meanwhile, from a place that goes round. Nothing is written to the disk but pictures.
 *
 *     cc -O2 gray_scott.c $(pkg-config --cflags --libs leafcast) -lm -pthread -o gray_scott
 *     ./gray_scott 96 2000 picture
 *
 * So many nodes along each axis, and steps; pictures are picture_001.ppm and so on. At last it
 * prints how long stepping, handing over and drawing took.
 */
#define _POSIX_C_SOURCE 200809L

#include <leafcast.h>

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { SHOWN = 50, WIDTH = 320, HEIGHT = 240, PIXELS = WIDTH * HEIGHT, SLABS = 4 };

/* What is fed, removed, and spreads, per step (Pearson 1993): worms and bubbles that divide. */
static const float feed = 0.03f, kill_rate = 0.0565f, spread_u = 0.16f, spread_v = 0.08f;
static const float isovalue = 0.2f;

typedef struct simulation {
    int n, steps;
    float *u[2], *v[2]; /* both substances, now and in the next step */
    leafcast *volume;
    pthread_mutex_t lock;
    pthread_cond_t changed;
    int committed, drawn; /* steps; guarded by lock */
    leafcast_status status;
    double stepping, giving, drawing; /* seconds */
    const char *name;                 /* of the pictures, without their number */
} simulation;

static double seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* ---- The simulation ---- */

static size_t at(const simulation *s, int x, int y, int z) {
    return ((size_t)z * (size_t)s->n + (size_t)y) * (size_t)s->n + (size_t)x;
}

/* All of the first substance, and drops of the second. */
static void begin(simulation *s) {
    const int n = s->n;
    unsigned random = 1;
    for (size_t i = 0; i < at(s, 0, 0, n); i++) {
        s->u[0][i] = 1;
        s->v[0][i] = 0;
    }
    for (int drop = 0; drop < 20; drop++) {
        int place[3];
        for (int a = 0; a < 3; a++) {
            random = random * 1664525U + 1013904223U;
            place[a] = (int)(random >> 8) % (n - 6);
        }
        for (int k = 0; k < 6; k++)
            for (int j = 0; j < 6; j++)
                for (int i = 0; i < 6; i++) {
                    const size_t to = at(s, place[0] + i, place[1] + j, place[2] + k);
                    s->u[0][to] = 0.5f;
                    s->v[0][to] = 0.5f;
                }
    }
}

static void step_slice(simulation *s, int z) {
    const int n = s->n, below = (z + n - 1) % n, above = (z + 1) % n;
    const float *u = s->u[0], *v = s->v[0];
    for (int y = 0; y < n; y++) {
        const size_t here = at(s, 0, y, z), front = at(s, 0, (y + n - 1) % n, z);
        const size_t back = at(s, 0, (y + 1) % n, z);
        const size_t under = at(s, 0, y, below), over = at(s, 0, y, above);
        for (int x = 0; x < n; x++) {
            const size_t i = here + (size_t)x, left = here + (size_t)((x + n - 1) % n);
            const size_t right = here + (size_t)((x + 1) % n), to = (size_t)x;
            const float lu = u[left] + u[right] + u[front + to] + u[back + to] + u[under + to] +
                             u[over + to] - 6 * u[i];
            const float lv = v[left] + v[right] + v[front + to] + v[back + to] + v[under + to] +
                             v[over + to] - 6 * v[i];
            const float reaction = u[i] * v[i] * v[i];
            s->u[1][i] = u[i] + 0.7f * spread_u * lu - reaction + feed * (1 - u[i]);
            s->v[1][i] = v[i] + 0.7f * spread_v * lv + reaction - (feed + kill_rate) * v[i];
        }
    }
}

static void step(simulation *s) {
    for (int z = 0; z < s->n; z++)
        step_slice(s, z);
    float *const u = s->u[0], *const v = s->v[0];
    s->u[0] = s->u[1];
    s->v[0] = s->v[1];
    s->u[1] = u;
    s->v[1] = v;
}

/* Give the second substance in slabs, as it would come from the parts of a larger program. */
static leafcast_status give(const simulation *s, int number) {
    leafcast_status status = LEAFCAST_OK;
    for (int slab = 0; slab < SLABS && status == LEAFCAST_OK; slab++) {
        const int low = s->n * slab / SLABS, high = s->n * (slab + 1) / SLABS;
        const uint32_t n = (uint32_t)s->n;
        const uint32_t first[3] = {0, 0, (uint32_t)low}, size[3] = {n, n, (uint32_t)(high - low)};
        status = leafcast_update(s->volume, first, size, s->v[0] + at(s, 0, 0, low), NULL);
    }
    return status == LEAFCAST_OK ? leafcast_commit(s->volume, number) : status;
}

/* ---- The pictures ---- */

/* Colours are linear: bytes for a screen are sRGB. */
static int byte_of(double x) {
    const double encoded = x <= 0.0031308 ? 12.92 * x : 1.055 * pow(x, 1 / 2.4) - 0.055;
    return (int)(255.0 * fmin(fmax(encoded, 0.0), 1.0) + 0.5);
}

static int write_picture(const char *name, float rgb[3][PIXELS]) {
    FILE *file = fopen(name, "wb");
    if (!file)
        return 0;
    fprintf(file, "P6\n%d %d\n255\n", WIDTH, HEIGHT);
    for (int i = 0; i < 3 * PIXELS; i++)
        putc(byte_of((double)rgb[i % 3][i / 3]), file);
    return fclose(file) == 0;
}

static leafcast_status draw(const simulation *s, int number) {
    static float rgb[3][PIXELS];
    char name[1024];
    const double turn = 0.002 * number, middle = 0.5 * (s->n - 1), far_off = 1.9 * s->n;
    leafcast_camera camera = leafcast_standard_view(s->volume, 2.2, WIDTH, HEIGHT);
    camera.eye[0] = middle + far_off * cos(turn);
    camera.eye[1] = middle + far_off * sin(turn);
    camera.eye[2] = middle + 0.8 * far_off;
    leafcast_scene scene = leafcast_scene_default();
    scene.shadows = true;
    scene.light_count = 1;
    for (int a = 0; a < 3; a++) {
        /* From above the eye: what is seen is lit, wherever it goes. */
        scene.lights[0].vector[a] = camera.eye[a] - middle + (a == 2 ? 0.4 * far_off : 0);
        scene.lights[0].rgb[a] = 1;
    }
    scene.background[3] = 1;
    const leafcast_image image = {sizeof image, rgb[0], rgb[1], rgb[2]};
    const leafcast_status status =
        leafcast_trace(s->volume, &scene, &camera, &image, NULL, NULL, NULL);
    snprintf(name, sizeof name, "%s_%03d.ppm", s->name, number / SHOWN);
    return status == LEAFCAST_OK && !write_picture(name, rgb) ? LEAFCAST_IO : status;
}

/* The thread that draws: whenever there is a step that it has not drawn. */
static void *draw_all(void *of) {
    simulation *s = (simulation *)of;
    for (int number = 0, goes_on = 1; number < s->steps && goes_on;) {
        pthread_mutex_lock(&s->lock);
        while (s->committed == s->drawn && s->status == LEAFCAST_OK)
            pthread_cond_wait(&s->changed, &s->lock);
        number = s->committed;
        pthread_mutex_unlock(&s->lock);
        const double start = seconds();
        const leafcast_status status = draw(s, number);
        if (status != LEAFCAST_OK)
            fprintf(stderr, "step %d: %s\n", number, leafcast_error_text());
        pthread_mutex_lock(&s->lock);
        s->drawing += seconds() - start;
        s->drawn = number;
        s->status = s->status == LEAFCAST_OK ? status : s->status;
        goes_on = s->status == LEAFCAST_OK;
        pthread_cond_broadcast(&s->changed);
        pthread_mutex_unlock(&s->lock);
    }
    return NULL;
}

/* Hand a step over, once the one before is drawn; returns whether to go on. */
static int show(simulation *s, int number) {
    pthread_mutex_lock(&s->lock);
    while (s->drawn < s->committed && s->status == LEAFCAST_OK)
        pthread_cond_wait(&s->changed, &s->lock);
    pthread_mutex_unlock(&s->lock);
    const double start = seconds();
    const leafcast_status status = give(s, number);
    if (status != LEAFCAST_OK)
        fprintf(stderr, "step %d: %s\n", number, leafcast_error_text());
    pthread_mutex_lock(&s->lock);
    s->giving += seconds() - start;
    s->committed = number;
    s->status = s->status == LEAFCAST_OK ? status : s->status;
    pthread_cond_broadcast(&s->changed);
    const int goes_on = s->status == LEAFCAST_OK;
    pthread_mutex_unlock(&s->lock);
    return goes_on;
}

static void run(simulation *s) {
    pthread_t artist;
    int number = 0, goes_on = 1;
    if (pthread_create(&artist, NULL, draw_all, s) != 0) {
        fprintf(stderr, "no thread to draw with\n");
        s->status = LEAFCAST_NOMEM;
        return;
    }
    while (number < s->steps && goes_on) {
        const double start = seconds();
        for (int i = 0; i < SHOWN; i++, number++)
            step(s);
        s->stepping += seconds() - start;
        goes_on = show(s, number);
    }
    pthread_join(artist, NULL);
    printf("%d steps in %.2f s, handed over in %.3f s, drawn in %.2f s meanwhile\n", number,
           s->stepping, s->giving, s->drawing);
}

int main(int argc, char **argv) {
    static simulation s;
    s.n = argc == 4 ? atoi(argv[1]) : 0;
    s.steps = argc == 4 ? (atoi(argv[2]) + SHOWN - 1) / SHOWN * SHOWN : 0;
    if (s.n < 8 || s.n > 1024 || s.steps < 1) {
        fprintf(stderr, "gray_scott NODES STEPS PICTURE\n");
        return 2;
    }
    s.name = argv[3];
    const uint32_t n = (uint32_t)s.n;
    const leafcast_grid grid = {sizeof grid, {n, n, n}, LEAFCAST_F32};
    const leafcast_surface surface = leafcast_surface_default((double)isovalue);
    pthread_mutex_init(&s.lock, NULL);
    pthread_cond_init(&s.changed, NULL);
    for (int i = 0; i < 2; i++) {
        s.u[i] = (float *)malloc(at(&s, 0, 0, s.n) * sizeof(float));
        s.v[i] = (float *)malloc(at(&s, 0, 0, s.n) * sizeof(float));
    }
    s.status = s.u[0] && s.u[1] && s.v[0] && s.v[1] ? LEAFCAST_OK : LEAFCAST_NOMEM;
    if (s.status == LEAFCAST_OK)
        s.status = leafcast_open_live(&grid, NULL, &s.volume);
    if (s.status == LEAFCAST_OK)
        s.status = leafcast_select(s.volume, &surface, 1);
    if (s.status == LEAFCAST_OK) {
        begin(&s);
        run(&s);
    } else {
        fprintf(stderr, "%s\n", leafcast_error_text());
    }
    leafcast_close(s.volume);
    for (int i = 0; i < 2; i++) {
        free(s.u[i]);
        free(s.v[i]);
    }
    return (int)s.status;
}
