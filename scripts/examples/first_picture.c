/* first_picture.c - draw a treelet file: the isovalue that its values suggest, in a view that fits.
 *
 *     cc first_picture.c $(pkg-config --cflags --libs leafcast) -lm -o first_picture
 *     ./first_picture engine.leaf engine.ppm
 */
#include <leafcast.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { WIDTH = 320, HEIGHT = 240, PIXELS = WIDTH * HEIGHT };

/* Colours are linear: bytes for a screen are sRGB. */
static int byte_of(float linear) {
    const double x = linear;
    const double encoded = x <= 0.0031308 ? 12.92 * x : 1.055 * pow(x, 1 / 2.4) - 0.055;
    return (int)(255.0 * fmin(fmax(encoded, 0.0), 1.0) + 0.5);
}

static int write_ppm(const char *path, const leafcast_image *image) {
    FILE *file = fopen(path, "wb");
    if (!file)
        return 0;
    fprintf(file, "P6\n%d %d\n255\n", WIDTH, HEIGHT);
    for (int i = 0; i < PIXELS; i++) {
        putc(byte_of(image->r[i]), file);
        putc(byte_of(image->g[i]), file);
        putc(byte_of(image->b[i]), file);
    }
    return fclose(file) == 0;
}

int main(int argc, char **argv) {
    static float r[PIXELS], g[PIXELS], b[PIXELS];
    leafcast *volume = NULL;
    leafcast_image image = {sizeof image};
    leafcast_camera camera = {sizeof camera};
    double isovalue = 0;
    int found = 0, bad = argc != 3;
    image.r = r, image.g = g, image.b = b;
    bad = bad || leafcast_open(argv[1], NULL, &volume);
    bad = bad || leafcast_suggested_isovalues(volume, 0, 0, &isovalue, 1, &found);
    const leafcast_surface surface = leafcast_surface_default(isovalue);
    const leafcast_scene scene = leafcast_scene_default();
    bad = bad || leafcast_select(volume, &surface, 1);
    bad = bad || leafcast_fit_view(volume, 0, 0, &isovalue, found, 0, WIDTH, HEIGHT, &camera);
    bad = bad || leafcast_trace(volume, &scene, &camera, &image, NULL, NULL, NULL);
    bad = bad || !write_ppm(argv[2], &image);
    if (bad)
        fprintf(stderr, "%s\n",
                argc == 3 ? leafcast_error_text() : "first_picture FILE.leaf OUT.ppm");
    leafcast_close(volume);
    return bad;
}
