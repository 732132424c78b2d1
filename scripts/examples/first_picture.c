/* first_picture.c - a picture from an array: samples in memory become a treelet file, which is
 * drawn: the isovalue that its values suggest, in a view that fits.
 *
 *     cc first_picture.c $(pkg-config --cflags --libs leafcast) -lm -o first_picture
 *     ./first_picture gyroid.leaf gyroid.ppm
 */
#include <leafcast.h>
#include <leafcast_prep.h>

#include <math.h>
#include <stdio.h>

enum { N = 64, WIDTH = 320, HEIGHT = 240, PIXELS = WIDTH * HEIGHT };

/* Colours are linear: bytes for a screen are sRGB. */
static int byte_of(double x) {
    const double encoded = x <= 0.0031308 ? 12.92 * x : 1.055 * pow(x, 1 / 2.4) - 0.055;
    return (int)(255.0 * fmin(fmax(encoded, 0.0), 1.0) + 0.5);
}

int main(int argc, char **argv) {
    static float samples[N][N][N], rgb[3][PIXELS];
    for (int z = 0; z < N; z++)
        for (int y = 0; y < N; y++)
            for (int x = 0; x < N; x++)
                samples[z][y][x] =
                    (float)(sin(x * 0.2) * cos(y * 0.2) + sin(y * 0.2) * cos(z * 0.2) +
                            sin(z * 0.2) * cos(x * 0.2));
    const leafcast_grid grid = {sizeof grid, {N, N, N}, LEAFCAST_F32};
    leafcast *volume = NULL;
    leafcast_camera camera = {sizeof camera};
    leafcast_image image = {sizeof image, rgb[0], rgb[1], rgb[2]};
    double isovalue = 0;
    int found = 0, bad = argc != 3;
    bad = bad || leafcast_convert_array(&grid, samples, NULL, argv[1], NULL);
    bad = bad || leafcast_open(argv[1], NULL, &volume);
    bad = bad || leafcast_suggested_isovalues(volume, 0, 0, &isovalue, 1, &found);
    const leafcast_surface surface = leafcast_surface_default(isovalue);
    const leafcast_scene scene = leafcast_scene_default();
    bad = bad || leafcast_select(volume, &surface, 1);
    bad = bad || leafcast_fit_view(volume, 0, 0, &isovalue, found, 0, WIDTH, HEIGHT, &camera);
    bad = bad || leafcast_trace(volume, &scene, &camera, &image, NULL, NULL, NULL);
    FILE *file = bad ? NULL : fopen(argv[2], "wb");
    if (file)
        fprintf(file, "P6\n%d %d\n255\n", WIDTH, HEIGHT);
    for (int i = 0; file && i < 3 * PIXELS; i++)
        putc(byte_of(rgb[i % 3][i / 3]), file);
    if (bad)
        fprintf(stderr, "%s\n",
                argc == 3 ? leafcast_error_text() : "first_picture OUT.leaf OUT.ppm");
    leafcast_close(volume);
    return !file || fclose(file) != 0;
}
