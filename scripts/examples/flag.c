/* flag.c - triangles that move: a flag in the wind, its vertices given anew before each picture,
 * lit, with the shadow that its waves cast on it.
 *
 *     cc flag.c $(pkg-config --cflags --libs leafcast) -lm -o flag
 *     ./flag 8 flag                 # flag_000.ppm, flag_001.ppm, ..
 */
#include <leafcast.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { WIDE = 96, HIGH = 64, VERTICES = WIDE * HIGH, TRIANGLES = 2 * (WIDE - 1) * (HIGH - 1) };
enum { WIDTH = 320, HEIGHT = 240, PIXELS = WIDTH * HEIGHT };

static float positions[VERTICES][3], rgb[3][PIXELS];
static uint32_t triangles[TRIANGLES][3], colours[VERTICES];

/* Waves run from the pole, where the flag is held, and grow on their way. */
static void wave(double time) {
    for (int i = 0; i < VERTICES; i++) {
        const double x = (double)(i % WIDE) / (WIDE - 1), y = (double)(i / WIDE) / (WIDE - 1);
        positions[i][0] = (float)x;
        positions[i][1] = (float)(y - 0.05 * x * sin(3.0 * x - time));
        positions[i][2] = (float)(0.12 * x * sin(11.0 * x + 2.0 * y - 2.0 * time));
    }
}

static void weave(void) {
    int n = 0;
    for (int i = 0; i < VERTICES; i++)
        colours[i] = i / WIDE < HIGH / 2 ? 0x2060c0 : 0xf0c040;
    for (uint32_t y = 0; y + 1 < HIGH; y++)
        for (uint32_t x = 0; x + 1 < WIDE; x++) {
            const uint32_t at = y * WIDE + x;
            const uint32_t corners[2][3] = {{at, at + 1, at + WIDE},
                                            {at + 1, at + WIDE + 1, at + WIDE}};
            for (int t = 0; t < 2; t++, n++)
                for (int k = 0; k < 3; k++)
                    triangles[n][k] = corners[t][k];
        }
}

/* Colours are linear: bytes for a screen are sRGB. */
static int byte_of(double x) {
    const double encoded = x <= 0.0031308 ? 12.92 * x : 1.055 * pow(x, 1 / 2.4) - 0.055;
    return (int)(255.0 * fmin(fmax(encoded, 0.0), 1.0) + 0.5);
}

/* Returns whether it could not be written. */
static int write_picture(const char *prefix, int n) {
    char name[1024];
    snprintf(name, sizeof name, "%s_%03d.ppm", prefix, n);
    FILE *file = fopen(name, "wb");
    if (!file) {
        perror(name);
        return 1;
    }
    fprintf(file, "P6\n%d %d\n255\n", WIDTH, HEIGHT);
    for (int i = 0; i < 3 * PIXELS; i++)
        putc(byte_of(rgb[i % 3][i / 3]), file);
    return fclose(file) != 0;
}

int main(int argc, char **argv) {
    leafcast_triangles mesh = {sizeof mesh, VERTICES, TRIANGLES, positions, triangles};
    leafcast_camera camera = {sizeof camera};
    leafcast_image image = {sizeof image, rgb[0], rgb[1], rgb[2]};
    leafcast_surface cloth = leafcast_surface_default(0);
    leafcast_scene scene = leafcast_scene_default();
    const double towards_light[3] = {1.0, 0.3, 0.8};
    const int count = argc == 3 ? atoi(argv[1]) : 0;
    leafcast *flag = NULL;
    mesh.colours = colours;
    for (int a = 0; a < 3; a++) {
        scene.lights[0].vector[a] = towards_light[a];
        scene.lights[0].rgb[a] = 1.0f;
    }
    scene.light_count = 1;
    scene.shadows = 1;
    weave();
    wave(0.0);
    int bad = count < 1 || leafcast_open_triangles(&mesh, NULL, &flag) ||
              leafcast_select(flag, &cloth, 1) ||
              leafcast_fit_view(flag, 0, 0, NULL, 0, 0, WIDTH, HEIGHT, &camera);
    int unwritten = 0;
    for (int n = 0; n < count && !bad && !unwritten; n++) {
        wave(0.5 * n);
        bad = leafcast_update_vertices(flag, (const float(*)[3])positions, VERTICES) ||
              leafcast_trace(flag, &scene, &camera, &image, NULL, NULL, NULL);
        unwritten = !bad && write_picture(argv[2], n);
    }
    if (bad)
        fprintf(stderr, "%s\n", count < 1 ? "flag PICTURES PREFIX" : leafcast_error_text());
    leafcast_close(flag);
    return bad || unwritten;
}
