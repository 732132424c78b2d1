/* test_colour_image.c - surfaces of all kinds under an image: each pixel beside the image's
 * colours, mixed as light; what points of it are; it is not drawn itself.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <string.h>

#include "render/ray/affine.h"
#include "tests/support/colour_lab.h"
#include "tests/support/scene_stage.h"

static double light_of(uint32_t colour, int c) {
    const double s = (colour >> (16 - 8 * c) & 255) / 255.0;
    return s <= 0.04045 ? s / 12.92 : pow((s + 0.055) / 1.055, 2.4);
}

/* The colour of the image at a point of the scene's world, mixed as light. Returns false beside
 * it. */
static bool image_at(const coloured *c, const double at[3], double rgb[3]) {
    const heights_truth *h = &colour_lab_image.truth;
    double own[3], u[2];
    int cell[2];
    affine space;
    affine_init(&space, c->colouring.place);
    affine_point_to_grid(&space, at, own);
    for (int a = 0; a < 2; a++) {
        const double most = (a ? h->ny : h->nx) - 1.0, x = (own[a] - h->origin[a]) / h->spacing[a];
        if (x < 0.0 || x > most)
            return false;
        cell[a] = (int)fmin(floor(x), most - 1.0);
        u[a] = x - cell[a];
    }
    for (int k = 0; k < 3; k++) {
        rgb[k] = 0.0;
        for (int n = 0; n < 4; n++)
            rgb[k] +=
                (n & 1 ? u[0] : 1.0 - u[0]) * (n & 2 ? u[1] : 1.0 - u[1]) *
                light_of(
                    (uint32_t)h->heights[cell[0] + (n & 1) + (size_t)h->nx * (cell[1] + (n >> 1))],
                    k);
    }
    return true;
}

static void open_draped(coloured *c, int of, where how, const leafcast_options *device,
                        uint32_t treelets) {
    colour_lab_open(c, of, IMAGE, how, device, treelets);
    c->shown.colours = NULL;
    for (int r = 0; r < 3; r++) /* its elevations are nowhere */
        c->place[1][4 * r + 2] = r == 2 ? 1.0 : 0.0;
}

/* Surfaces of all kinds under an image, each pixel beside its colours. */
static void test_image(void **state) {
    static picture p;
    (void)state;
    for (int of = 0; of < FILES; of++)
        for (where how = PLACED; how <= TILED; how++) {
            coloured c;
            int draped = 0, plain = 0;
            if (of == HOLES)
                continue;
            open_draped(&c, of, how, NULL, 0);
            pictures_draw(c.of, &c.scene, &c.camera, &p, NULL);
            for (int i = 0; i < PICTURE_PIXELS; i++) {
                double o[3], d[3], at[3], rgb[3];
                if (p.id[i] < 0)
                    continue;
                leafcast_pixel_ray(&c.camera, i % PICTURE_WIDTH + 0.5, i / PICTURE_WIDTH + 0.5, o,
                                   d);
                for (int a = 0; a < 3; a++)
                    at[a] = o[a] + p.z[i] * d[a];
                const bool there = image_at(&c, at, rgb);
                draped += there;
                plain += !there;
                for (int k = 0; k < 3; k++) {
                    const double expected = there ? rgb[k] : (double)c.surfaces[0].rgb[k];
                    if (fabs((double)p.rgba[k][i] - expected) > 1e-6)
                        fail_msg("%s: pixel %d, channel %d is %.9g, not %.9g", colour_lab_names[of],
                                 i, k, (double)p.rgba[k][i], expected);
                }
            }
            print_message("%s: %d pixels under the image, %d plain\n", colour_lab_names[of], draped,
                          plain);
            assert_true(draped > PICTURE_PIXELS / 40);
            colour_lab_close(&c);
        }
}

/* Points of an image have its nearest colour. It is not drawn itself. */
static void test_image_alone(void **state) {
    coloured c;
    (void)state;
    open_draped(&c, GRID, TILED, NULL, 0);
    const heights_truth *h = &colour_lab_image.truth;
    for (int i = 0; i < 40; i++) {
        const int at[2] = {i % (h->nx - 1), i % (h->ny - 1)};
        const double point[3] = {h->origin[0] + (at[0] + 0.3) * h->spacing[0],
                                 h->origin[1] + (at[1] + 0.8) * h->spacing[1], 5.0};
        leafcast_sample s;
        assert_int_equal(leafcast_sample_points(c.by, &point, 1, &s), LEAFCAST_OK);
        assert_true(s.value == (double)h->heights[at[0] + h->nx * (at[1] + 1)]);
        for (int a = 0; a < 3; a++)
            assert_true(s.gradient[a] == 0.0);
    }
    c.shown.volume = c.by;
    c.shown.place = NULL;
    c.shown.colour_by = NULL;
    colour_lab_refused(&c, "is an image");
    colour_lab_close(&c);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_image),
                                       cmocka_unit_test(test_image_alone)};
    return cmocka_run_group_tests(tests, colour_lab_set, scene_stage_clear);
}
