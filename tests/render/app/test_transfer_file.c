/* test_transfer_file.c - transfer functions from files: our text, ParaView's maps; colours between
 * colours and opacities between opacities against VTK 9.1; lists stretched and joined.
 */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/fault.h"
#include "formats/base/hash.h"
#include "render/app/colour_map.h"
#include "render/app/opacity_curve.h"
#include "render/app/transfer_curve.h"
#include "render/app/transfer_file.h"
#include "tests/support/scratch.h"

static mem budget; /* of the tests */

/* ---- Between colours ---- */

/* What vtkColorTransferFunction of VTK 9.1 makes of two points at 0 and 1. */
static const struct between {
    colour_space space;
    double a[3], b[3], s, seen[3];
} BETWEEN[] = {
    {COLOUR_RGB,
     {0.231372549, 0.298039216, 0.752941176},
     {0.705882353, 0.0156862745, 0.149019608},
     0.75,
     {0.587254902, 0.0862745098, 0.3}},
    {COLOUR_RGB, {0, 0, 1}, {1, 0, 0}, 0.375, {0.375, 0, 0.625}},
    {COLOUR_RGB, {1, 0.1, 0.1}, {0.9, 0.2, 1}, 0.875, {0.9125, 0.1875, 0.8875}},
    {COLOUR_RGB, {0, 0, 0}, {1, 1, 1}, 0.375, {0.375, 0.375, 0.375}},
    {COLOUR_RGB, {0.2, 0.9, 0.1}, {0.5, 0.5, 0.5}, 0.875, {0.4625, 0.55, 0.45}},
    {COLOUR_RGB, {1, 1, 1}, {0.1, 0, 0.4}, 0.875, {0.2125, 0.125, 0.475}},
    {COLOUR_RGB, {0.02, 0.9, 0.95}, {0.95, 0.9, 0.03}, 0.875, {0.83375, 0.9, 0.145}},
    {COLOUR_RGB, {0.95, 0.02, 0.9}, {0.5, 0.9, 0.03}, 0.75, {0.6125, 0.68, 0.2475}},
    {COLOUR_HSV,
     {0.231372549, 0.298039216, 0.752941176},
     {0.705882353, 0.0156862745, 0.149019608},
     0.125,
     {0.264979061, 0.202944496, 0.747058824}},
    {COLOUR_HSV, {0, 0, 1}, {1, 0, 0}, 0.625, {0.5, 1, 0}},
    {COLOUR_HSV, {1, 0.1, 0.1}, {0.9, 0.2, 1}, 0.25, {0.80859375, 1, 0.125}},
    {COLOUR_HSV, {0, 0, 0}, {1, 1, 1}, 0.875, {0.875, 0.875, 0.875}},
    {COLOUR_HSV, {0.2, 0.9, 0.1}, {0.5, 0.5, 0.5}, 0.125, {0.426475694, 0.85, 0.188888889}},
    {COLOUR_HSV, {1, 1, 1}, {0.1, 0, 0.4}, 0.25, {0.83671875, 0.85, 0.6375}},
    {COLOUR_HSV, {0.02, 0.9, 0.95}, {0.95, 0.9, 0.03}, 0.125, {0.02125, 0.95, 0.755194253}},
    {COLOUR_HSV, {0.95, 0.02, 0.9}, {0.5, 0.9, 0.03}, 0.375, {0.0238939145, 0.290642137, 0.93125}},
    {COLOUR_HSV_WRAPPED,
     {0.231372549, 0.298039216, 0.752941176},
     {0.705882353, 0.0156862745, 0.149019608},
     0.625,
     {0.723529412, 0.0934244792, 0.672283587}},
    {COLOUR_HSV_WRAPPED, {0, 0, 1}, {1, 0, 0}, 0.25, {0.5, 0, 1}},
    {COLOUR_HSV_WRAPPED, {1, 0.1, 0.1}, {0.9, 0.2, 1}, 0.625, {1, 0.1625, 0.751367187}},
    {COLOUR_HSV_WRAPPED, {0, 0, 0}, {1, 1, 1}, 0.75, {0.75, 0.75, 0.75}},
    {COLOUR_HSV_WRAPPED, {0.2, 0.9, 0.1}, {0.5, 0.5, 0.5}, 0.125, {0.426475694, 0.85, 0.188888889}},
    {COLOUR_HSV_WRAPPED, {1, 1, 1}, {0.1, 0, 0.4}, 0.75, {0.42109375, 0.1375, 0.55}},
    {COLOUR_HSV_WRAPPED, {0.02, 0.9, 0.95}, {0.95, 0.9, 0.03}, 0.25, {0.0225, 0.95, 0.511047291}},
    {COLOUR_HSV_WRAPPED,
     {0.95, 0.02, 0.9},
     {0.5, 0.9, 0.03},
     0.125,
     {0.94375, 0.0213171601, 0.61673439}},
    {COLOUR_LAB,
     {0.231372549, 0.298039216, 0.752941176},
     {0.705882353, 0.0156862745, 0.149019608},
     0.875,
     {0.681838218, 0.0936957802, 0.223381688}},
    {COLOUR_LAB, {0, 0, 1}, {1, 0, 0}, 0.25, {0.605205875, 0, 0.762936665}},
    {COLOUR_LAB, {1, 0.1, 0.1}, {0.9, 0.2, 1}, 0.625, {0.98774888, 0.132498343, 0.662395393}},
    {COLOUR_LAB, {0, 0, 0}, {1, 1, 1}, 0.375, {0.345982018, 0.345988559, 0.345982176}},
    {COLOUR_LAB, {0.2, 0.9, 0.1}, {0.5, 0.5, 0.5}, 0.25, {0.362666012, 0.800441176, 0.268892033}},
    {COLOUR_LAB, {1, 1, 1}, {0.1, 0, 0.4}, 0.625, {0.464012291, 0.356462143, 0.620803102}},
    {COLOUR_LAB,
     {0.02, 0.9, 0.95},
     {0.95, 0.9, 0.03},
     0.25,
     {0.550086181, 0.898820502, 0.770589829}},
    {COLOUR_LAB,
     {0.95, 0.02, 0.9},
     {0.5, 0.9, 0.03},
     0.125,
     {0.927185894, 0.309791121, 0.820406748}},
    {COLOUR_DIVERGING,
     {0.231372549, 0.298039216, 0.752941176},
     {0.705882353, 0.0156862745, 0.149019608},
     0.25,
     {0.553317944, 0.688634605, 0.995187929}},
    {COLOUR_DIVERGING, {0, 0, 1}, {1, 0, 0}, 0.75, {1, 0.684358875, 0.44301947}},
    {COLOUR_DIVERGING, {1, 0.1, 0.1}, {0.9, 0.2, 1}, 0.75, {0.973838252, 0.683945051, 1}},
    {COLOUR_DIVERGING, {0, 0, 0}, {1, 1, 1}, 0.625, {0.592544681, 0.592555244, 0.592544937}},
    {COLOUR_DIVERGING,
     {0.2, 0.9, 0.1},
     {0.5, 0.5, 0.5},
     0.25,
     {0.562713673, 0.94529144, 0.457901537}},
    {COLOUR_DIVERGING, {1, 1, 1}, {0.1, 0, 0.4}, 0.25, {1, 0.700123612, 0.722994982}},
    {COLOUR_DIVERGING, {0.02, 0.9, 0.95}, {0.95, 0.9, 0.03}, 0.125, {0.526431204, 1, 0.976170231}},
    {COLOUR_DIVERGING, {0.95, 0.02, 0.9}, {0.5, 0.9, 0.03}, 0.125, {1, 0.432006007, 0.853995734}},
};

static void test_colours_between(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof BETWEEN / sizeof *BETWEEN; i++) {
        const struct between *w = &BETWEEN[i];
        double linear[3];
        colour_space_between(w->space, w->a, w->b, w->s, linear);
        for (int c = 0; c < 3; c++)
            if (!(fabs(colour_space_encoded(linear[c]) - w->seen[c]) < 1e-6))
                fail_msg("row %zu, component %d: %.9g, not %.9g", i, c,
                         colour_space_encoded(linear[c]), w->seen[c]);
    }
}

/* The same bits on every CPU. */
static void test_bits(void **state) {
    (void)state;
    static double all[sizeof BETWEEN / sizeof *BETWEEN][9][3];
    for (size_t i = 0; i < sizeof BETWEEN / sizeof *BETWEEN; i++)
        for (int k = 0; k < 9; k++)
            colour_space_between(BETWEEN[i].space, BETWEEN[i].a, BETWEEN[i].b, k / 8.0, all[i][k]);
    assert_int_equal(hash_bytes(all, sizeof all), 0x9a4aaa5318ba5405);
}

/* vtkPiecewiseFunction of VTK 9.1 with 0.1 at 0, 0.9 at 1. */
static const double SHARP[][4] = {
    {0.5, 0, 0.125, 0.2},
    {0.5, 0, 0.35, 0.38},
    {0.5, 0, 0.45, 0.46},
    {0.5, 0, 0.8, 0.74},
    {0.3, 0, 0.125, 0.266666667},
    {0.3, 0, 0.35, 0.528571429},
    {0.3, 0, 0.45, 0.585714286},
    {0.3, 0, 0.8, 0.785714286},
    {0.5, 0.5, 0.125, 0.100048846},
    {0.5, 0.5, 0.35, 0.127519345},
    {0.5, 0.5, 0.45, 0.276007597},
    {0.5, 0.5, 0.8, 0.899175774},
    {0.7, 0.25, 0.125, 0.100722745},
    {0.7, 0.25, 0.35, 0.127653853},
    {0.7, 0.25, 0.45, 0.170225858},
    {0.7, 0.25, 0.8, 0.819351342},
    {0.2, 0.9, 0.125, 0.10040833},
    {0.2, 0.9, 0.35, 0.886850439},
    {0.2, 0.9, 0.45, 0.898758263},
    {0.2, 0.9, 0.8, 0.899999962},
    {0.4, 1, 0.125, 0.1},
    {0.4, 1, 0.35, 0.1},
    {0.4, 1, 0.45, 0.9},
    {0.4, 1, 0.8, 0.9},
};

static double opacity_of(const transfer_list *t, double value) {
    return 1.0 - exp(-transfer_list_at(t, value, true).extinction);
}

static void test_opacities_between(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof SHARP / sizeof *SHARP; i++) {
        const opacity_point points[2] = {{0.0, 0.1, SHARP[i][0], SHARP[i][1]},
                                         {1.0, 0.9, 0.5, 0.0}};
        transfer_list t = {.m = &budget};
        assert_int_equal(opacity_curve_convert(points, 2, &t), ST_OK);
        if (!(fabs(opacity_of(&t, SHARP[i][2]) - SHARP[i][3]) <= TRANSFER_CURVE_ERROR))
            fail_msg("row %zu: %.9g, not %.9g", i, opacity_of(&t, SHARP[i][2]), SHARP[i][3]);
        transfer_list_release(&t);
    }
}

/* An opacity of 1 becomes the largest there is; a step stays one. */
static void test_opaque(void **state) {
    (void)state;
    const opacity_point points[] = {
        {2.0, 0.0, 0.5, 0.0}, {2.0, 1.0, 0.5, 0.0}, {3.0, 1.0, 0.5, 0.0}};
    transfer_list t = {.m = &budget};
    assert_int_equal(opacity_curve_convert(points, 3, &t), ST_OK);
    assert_int_equal(t.count, 3);
    assert_true(transfer_list_at(&t, 2.0, false).extinction == 0.0);
    assert_true(fabs(opacity_of(&t, 2.0) - OPACITY_CURVE_MOST) < 1e-12);
    assert_true(t.points[2].extinction == t.points[1].extinction && t.points[2].value == 3.0);
    transfer_list_release(&t);
}

/* ---- Maps ---- */

/* The lines are everywhere as near to the curve as is said. */
static void test_lines_are_near(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof BETWEEN / sizeof *BETWEEN; i++) {
        const struct between *w = &BETWEEN[i];
        const colour_point points[2] = {{-3.0, {w->a[0], w->a[1], w->a[2]}},
                                        {5.0, {w->b[0], w->b[1], w->b[2]}}};
        transfer_list t = {.m = &budget};
        assert_int_equal(colour_map_convert(w->space, points, 2, &t), ST_OK);
        assert_true(t.count >= 2 && t.count < 400);
        double worst = 0.0, shown = 0.0;
        for (int k = 0; k <= 5000; k++) {
            const double s = k / 5000.0;
            double want[3];
            colour_space_between(w->space, w->a, w->b, s, want);
            const leafcast_transfer_point p = transfer_list_at(&t, -3.0 + 8.0 * s, true);
            for (int c = 0; c < 3; c++) {
                const double got = (double)p.rgb[c];
                worst = fmax(worst, fabs(got - want[c]));
                shown =
                    fmax(shown, fabs(colour_space_encoded(got) - colour_space_encoded(want[c])));
            }
        }
        if (!(worst <= TRANSFER_CURVE_ERROR && shown <= TRANSFER_CURVE_ERROR))
            fail_msg("row %zu: off by %.3g in light, %.3g on a screen", i, worst, shown);
        transfer_list_release(&t);
    }
}

/* Colours of the original's table, and what a screen shows of the map there. */
static const struct original {
    const char *name;
    int at; /* of 255 */
    double seen[3];
} ORIGINALS[] = {
    {"viridis", 0, {0.267004, 0.004874, 0.329415}},
    {"viridis", 10, {0.278791, 0.062145, 0.386592}},
    {"viridis", 31, {0.279574, 0.170599, 0.479997}},
    {"viridis", 77, {0.204903, 0.375746, 0.553533}},
    {"viridis", 128, {0.127568, 0.566949, 0.550556}},
    {"viridis", 150, {0.128087, 0.647749, 0.523491}},
    {"viridis", 200, {0.440137, 0.811138, 0.340967}},
    {"viridis", 246, {0.906311, 0.894855, 0.098125}},
    {"viridis", 255, {0.993248, 0.906157, 0.143936}},
    {"plasma", 0, {0.050383, 0.029803, 0.527975}},
    {"plasma", 10, {0.148607, 0.021154, 0.570562}},
    {"plasma", 31, {0.293478, 0.010213, 0.62949}},
    {"plasma", 77, {0.568201, 0.055778, 0.639477}},
    {"plasma", 128, {0.798216, 0.280197, 0.469538}},
    {"plasma", 150, {0.872303, 0.378774, 0.393355}},
    {"plasma", 200, {0.984199, 0.629718, 0.224595}},
    {"plasma", 246, {0.961681, 0.914672, 0.15052}},
    {"plasma", 255, {0.940015, 0.975158, 0.131326}},
    {"inferno", 0, {0.001462, 0.000466, 0.013866}},
    {"inferno", 10, {0.019373, 0.015133, 0.088767}},
    {"inferno", 31, {0.122908, 0.047536, 0.281624}},
    {"inferno", 77, {0.422549, 0.092501, 0.432714}},
    {"inferno", 128, {0.735683, 0.215906, 0.330245}},
    {"inferno", 150, {0.851384, 0.30226, 0.239636}},
    {"inferno", 200, {0.985952, 0.61575, 0.025592}},
    {"inferno", 246, {0.949545, 0.955063, 0.50786}},
    {"inferno", 255, {0.988362, 0.998364, 0.644924}},
    {"magma", 0, {0.001462, 0.000466, 0.013866}},
    {"magma", 10, {0.018815, 0.016026, 0.084584}},
    {"magma", 31, {0.107899, 0.064335, 0.267289}},
    {"magma", 77, {0.396467, 0.102902, 0.502658}},
    {"magma", 128, {0.716387, 0.214982, 0.47529}},
    {"magma", 150, {0.852126, 0.276106, 0.418573}},
    {"magma", 200, {0.992785, 0.594891, 0.410283}},
    {"magma", 246, {0.990175, 0.927196, 0.682926}},
    {"magma", 255, {0.987053, 0.991438, 0.749504}},
    {"cool-warm", 0, {0.231373, 0.298039, 0.752941}},
    {"cool-warm", 51, {0.484323, 0.622025, 0.975245}},
    {"cool-warm", 102, {0.753832, 0.830522, 0.961312}},
    {"cool-warm", 204, {0.932882, 0.519768, 0.40605}},
    {"cool-warm", 255, {0.70588, 0.0158127, 0.149021}},
    {"grey", 51, {0.2, 0.2, 0.2}},
    {"rainbow", 51, {0, 0.8, 1}},
};

static void test_named(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof ORIGINALS / sizeof *ORIGINALS; i++) {
        const struct original *o = &ORIGINALS[i];
        transfer_list t = {.m = &budget};
        assert_int_equal(colour_map_named(o->name, &t), ST_OK);
        assert_true(t.points[0].value == 0.0 && t.points[t.count - 1].value == 1.0);
        const leafcast_transfer_point p = transfer_list_at(&t, o->at / 255.0, true);
        for (int c = 0; c < 3; c++)
            if (!(fabs(colour_space_encoded((double)p.rgb[c]) - o->seen[c]) < 1.5 / 255))
                fail_msg("%s at %d: component %d is %.6g, not %.6g", o->name, o->at, c,
                         colour_space_encoded((double)p.rgb[c]), o->seen[c]);
        transfer_list_release(&t);
    }
}

/* Those that are told are those that there are. */
static void test_names(void **state) {
    (void)state;
    char names[256], *rest = names;
    snprintf(names, sizeof names, "%s", colour_map_names());
    for (char *name; (name = strsep(&rest, "|"));) {
        transfer_list t = {.m = &budget};
        assert_int_equal(colour_map_named(name, &t), ST_OK);
        for (size_t i = 1; i < t.count; i++)
            assert_true(t.points[i - 1].value < t.points[i].value);
        transfer_list_release(&t);
    }
    transfer_list t = {.m = &budget};
    assert_int_equal(colour_map_named("jet", &t), ST_AGAIN);
    assert_int_equal(colour_map_named("", &t), ST_AGAIN);
}

/* ---- Our own form ---- */

static transfer_file read_good(const char *text) {
    transfer_file f = {0};
    const status st = transfer_file_read(&budget, scratch_text("t.txt", text), &f);
    if (st != ST_OK)
        fail_msg("%s: %s", text, status_text());
    return f;
}

static void test_text(void **state) {
    (void)state;
    transfer_file f = read_good("\xef\xbb\xbf# a comment\n\n-1e-3\t0.5 1 0  0\r\n"
                                "2, 0, 0.25, 3, 1e3 # another\n2 0 0 0 0");
    assert_true(f.per_length && f.colours.count == 3 && f.extinctions.count == 3);
    const leafcast_transfer_point *p = f.colours.points;
    assert_true(p[0].value == -1e-3 && p[0].rgb[0] == 0.5f && p[0].rgb[1] == 1.0f);
    assert_true(p[1].value == 2.0 && p[1].rgb[2] == 3.0f &&
                f.extinctions.points[1].extinction == 1e3);
    assert_true(p[2].value == 2.0 && p[2].rgb[2] == 0.0f);
    transfer_file_release(&f);
}

/* What is printed is read again, to the bit. */
static void test_printed(void **state) {
    (void)state;
    const leafcast_transfer_point points[] = {{-1e299, {0.1f, 1e-38f, 3.0f}, 0.0},
                                              {1.0 / 3.0, {0.0f, 0.7f, 1.0f}, 1e-320},
                                              {1.0 / 3.0, {1.0f, 1.0f, 1.0f}, 2.0 / 3.0}};
    const char *path = scratch_path("printed.txt");
    FILE *out = fopen(path, "w");
    transfer_file_print(points, 3, out);
    fclose(out);
    transfer_file f = {0};
    assert_int_equal(transfer_file_read(&budget, path, &f), ST_OK);
    assert_int_equal(f.colours.count, 3);
    for (int i = 0; i < 3; i++) {
        assert_memory_equal(&f.colours.points[i].value, &points[i].value, sizeof(double));
        assert_memory_equal(f.colours.points[i].rgb, points[i].rgb, sizeof points[i].rgb);
        assert_true(f.extinctions.points[i].extinction == points[i].extinction);
    }
    transfer_file_release(&f);
}

/* ---- ParaView's ---- */

static const char PARAVIEW[] =
    "[{\"ColorSpace\": \"Lab\", \"Name\": \"a\", \"NanColor\": [1, 1, 0],\n"
    "  \"RGBPoints\": [0, 0.1, 0.2, 0.3, 1, 1, 1, 1], \"Points\": [0, 0, 0.5, 0, 1, 0.5, 0.5, 0]},"
    " {\"Name\": \"b\", \"RGBPoints\": [-5, 1, 0, 0]}]";

static void test_json(void **state) {
    (void)state;
    transfer_file f = {0};
    char name[4096];
    snprintf(name, sizeof name, "%s#a", scratch_text("p.json", PARAVIEW));
    assert_int_equal(transfer_file_read(&budget, name, &f), ST_OK);
    assert_true(!f.per_length && f.colours.count > 2 && f.extinctions.count > 2);
    const leafcast_transfer_point *last = &f.colours.points[f.colours.count - 1];
    assert_true(last->value == 1.0 && last->rgb[0] == 1.0f);
    assert_true(fabs(opacity_of(&f.extinctions, 1.0) - 0.5) < 1e-12);
    assert_true(fabs(opacity_of(&f.extinctions, 0.5) - 0.25) <= TRANSFER_CURVE_ERROR);
    transfer_file_release(&f);
    name[strlen(name) - 1] = 'b';
    assert_int_equal(transfer_file_read(&budget, name, &f), ST_OK);
    /* One point: the same everywhere. Opacities it has none. */
    assert_true(f.extinctions.count == 0 && f.colours.points[0].value == -5.0);
    assert_true(transfer_list_at(&f.colours, 7.0, true).rgb[0] == 1.0f);
    transfer_file_release(&f);
}

static void test_xml(void **state) {
    (void)state;
    transfer_file f =
        read_good("<?xml version=\"1.0\"?><ColorMaps><ColorMap name=\"x\" space=\"HSV\">\n"
                  "<Point x=\"0\" o=\"0\" r=\"0\" g=\"0\" b=\"1\"/><Point x=\"2\" o=\"1\" r=\"1\" "
                  "g=\"0\" b=\"0\"/>"
                  "<NaN r=\"1\" g=\"1\" b=\"0\"/></ColorMap></ColorMaps>");
    const leafcast_transfer_point p = transfer_list_at(&f.colours, 1.0, true);
    assert_true(!f.per_length && p.rgb[1] > 0.99f && p.rgb[0] < 0.01f && p.rgb[2] < 0.01f);
    assert_true(fabs(opacity_of(&f.extinctions, 2.0) - OPACITY_CURVE_MOST) < 1e-12);
    transfer_file_release(&f);
    f = read_good("<doc><ColorMap space='RGB'><Point x='0' r='0' g='0' b='1'/></ColorMap></doc>");
    assert_true(f.extinctions.count == 0 && f.colours.points[0].rgb[2] == 1.0f);
    transfer_file_release(&f);
}

/* ---- What is refused, and with which words ---- */

static const struct wrong {
    const char *text;
    status st;
    const char *says;
} WRONG[] = {
    {"", ST_CORRUPT, "expected points"},
    {"# nothing\n\n", ST_CORRUPT, "expected points"},
    {"1 2 3 4\n", ST_CORRUPT, "line 1"},
    {"1 0 0 0 0\n2 0 0 0 0 9\n", ST_CORRUPT, "line 2"},
    {"1 0 0 0 0\n\n0.5 0 0 0 0\n", ST_CORRUPT, "line 3: the value 0.5 comes behind 1"},
    {"1 0 -1 0 0\n", ST_CORRUPT, "green, 0 or more"},
    {"1 0 nan 0 0\n", ST_CORRUPT, "green"},
    {"1 0 0 1e7 0\n", ST_CORRUPT, "blue"},
    {"nan 0 0 0 0\n", ST_CORRUPT, "finite value"},
    {"inf 0 0 0 0\n", ST_CORRUPT, "line 1"},
    {"1 0 0 0 -1\n", ST_CORRUPT, "extinction"},
    {"1 0 0 0 inf\n", ST_CORRUPT, "extinction"},
    {"one 0 0 0 1\n", ST_CORRUPT, "a value"},
    {"1 0 0 0 0x\n", ST_CORRUPT, "extinction"},
    {"{\"Name\": 3", ST_CORRUPT, "line 1: expected JSON"},
    {"[]", ST_CORRUPT, "expected a colour map"},
    {"[3]", ST_CORRUPT, "expected an object"},
    {"{}", ST_UNSUPPORTED, "RGBPoints"},
    {"{\"RGBPoints\": []}", ST_CORRUPT, "expected points"},
    {"{\"RGBPoints\": [1,2,3]}", ST_CORRUPT, "four numbers a point"},
    {"{\"RGBPoints\": [0,0,0,\"a\"]}", ST_CORRUPT, "\"RGBPoints\", point 1: expected four numbers"},
    {"{\"RGBPoints\": {}}", ST_CORRUPT, "four numbers a point"},
    {"{\"RGBPoints\": [0,0,0,0, 1,0,2,0]}", ST_CORRUPT, "point 2: expected red, green and blue"},
    {"{\"RGBPoints\": [1,0,0,0, 0,0,0,0]}", ST_CORRUPT, "point 2: the value 0 comes behind 1"},
    {"{\"RGBPoints\": [0,0,0,0], \"ColorSpace\": \"Step\"}", ST_UNSUPPORTED, "\"Step\""},
    {"{\"RGBPoints\": [0,0,0,0], \"ColorSpace\": 4}", ST_UNSUPPORTED, "colour space"},
    {"{\"RGBPoints\": [0,0,0,0], \"UseLogScale\": 1}", ST_UNSUPPORTED, "logarithms"},
    {"{\"RGBPoints\": [0,0,0,0], \"Points\": [0,2,0.5,0]}", ST_CORRUPT, "\"Points\", point 1"},
    {"[{\"Name\": \"a\", \"RGBPoints\": [0,0,0,0]}, {\"Name\": \"b\", \"RGBPoints\": [0,0,0,0]}]",
     ST_USAGE, "which of its 2 maps? FILE#NAME: \"a\", \"b\""},
    {"[{\"Name\": \"a\"}, {}]", ST_USAGE, "which of its 2 maps?"},
    {"<a>", ST_CORRUPT, "line 1: expected XML"},
    {"<a/>", ST_CORRUPT, "expected a colour map"},
    {"<a>\n<ColorMap/></a>", ST_CORRUPT, "expected points"},
    {"<a>\n<ColorMap><Point x='0' r='0' g='0'/></ColorMap></a>", ST_CORRUPT, "line 2: expected b="},
    {"<a><ColorMap><Point x='z' r='0' g='0' b='0'/></ColorMap></a>", ST_CORRUPT, "x=\"z\""},
    {"<a><ColorMap><Point x='nan' r='0' g='0' b='0'/></ColorMap></a>", ST_CORRUPT, "finite"},
    {"<a><ColorMap><Point x='0' r='0' g='nan' b='0'/></ColorMap></a>", ST_CORRUPT, "0 to 1"},
    {"<a><ColorMap space='CIEDE'/></a>", ST_UNSUPPORTED, "\"CIEDE\""},
    {"<a><ColorMap indexedLookup='true'/></a>", ST_UNSUPPORTED, "categories"},
    {"<!DOCTYPE a [<!ENTITY b 'c'>]><a>&b;</a>", ST_UNSUPPORTED, "document type"},
};

static void test_refused(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof WRONG / sizeof *WRONG; i++) {
        transfer_file f = {0};
        const status st = transfer_file_read(&budget, scratch_text("w", WRONG[i].text), &f);
        if (st != WRONG[i].st || !strstr(status_text(), WRONG[i].says))
            fail_msg("%s: status %d, \"%s\", not %d, \"%s\"", WRONG[i].text, st, status_text(),
                     WRONG[i].st, WRONG[i].says);
        transfer_file_release(&f);
    }
    transfer_file f = {0};
    char name[4096];
    snprintf(name, sizeof name, "%s#c", scratch_text("p.json", PARAVIEW));
    assert_int_equal(transfer_file_read(&budget, name, &f), ST_USAGE);
    assert_non_null(strstr(status_text(), "there is no map \"c\", only \"a\", \"b\""));
    transfer_file_release(&f);
    snprintf(name, sizeof name, "%s#c", scratch_text("t.txt", "0 0 0 0 0\n"));
    assert_int_equal(transfer_file_read(&budget, name, &f), ST_USAGE);
    transfer_file_release(&f);
    assert_int_equal(transfer_file_read(&budget, scratch_path("none"), &f), ST_IO);
    transfer_file_release(&f);
    const char binary[] = "1 0 0 \0 0 0";
    assert_int_equal(transfer_file_read(&budget, scratch_write("b", binary, sizeof binary), &f),
                     ST_CORRUPT);
    transfer_file_release(&f);
}

static const char *const GOOD[] = {
    "0 0 0 0 0\n1 1 1 1 1 # end\n", PARAVIEW,
    "<a><ColorMap space='Lab'><Point x='0' o='1' r='0' g='0' b='0'/></ColorMap></a>"};

/* Good files with some bytes changed: what is read could be drawn, what is not is said. */
static void test_mutated(void **state) {
    (void)state;
    enum { ROUNDS = 3000, SEED = 21 };
    srand48(SEED);
    for (int k = 0; k < ROUNDS; k++) {
        char text[1024];
        transfer_file f = {0};
        snprintf(text, sizeof text, "%s", GOOD[k % 3]);
        const size_t size = strlen(text);
        for (int n = 0; n < 1 + k % 4; n++) {
            static const char likely[] = "0123456789.-+eE \n,[]{}<>\"'=#";
            text[lrand48() % (long)size] =
                k % 2 ? likely[lrand48() % (long)(sizeof likely - 1)] : (char)lrand48();
        }
        const status st = transfer_file_read(&budget, scratch_write("mutated", text, size), &f);
        const transfer_list *const lists[] = {&f.colours, &f.extinctions};
        if (st != ST_OK && !strstr(status_text(), "mutated"))
            fail_msg("round %d of seed %d: \"%s\"", k, SEED, status_text());
        for (int i = 0; i < 2 && st == ST_OK; i++)
            for (size_t n = 0; n < lists[i]->count; n++) {
                const leafcast_transfer_point *p = &lists[i]->points[n];
                assert_true(fabs(p->value) <= 1e300 && (n == 0 || p[-1].value <= p->value));
                assert_true(p->extinction >= 0.0 && p->extinction <= TRANSFER_LIST_MOST);
                for (int c = 0; c < 3; c++)
                    assert_true(p->rgb[c] >= 0.0f && isfinite(p->rgb[c]));
            }
        transfer_file_release(&f);
    }
    assert_int_equal(mem_used(&budget), 0);
}

/* Every beginning of a good file is read or refused with words, and leaves nothing. */
static void test_beginnings(void **state) {
    (void)state;
    for (int k = 0; k < 3; k++)
        for (size_t n = 0; n < strlen(GOOD[k]); n++) {
            transfer_file f = {0};
            const status st = transfer_file_read(&budget, scratch_write("part", GOOD[k], n), &f);
            if (st != ST_OK && !strstr(status_text(), "part"))
                fail_msg("%zu bytes of %s: \"%s\"", n, GOOD[k], status_text());
            transfer_file_release(&f);
        }
    assert_int_equal(mem_used(&budget), 0);
}

/* 4096 points are read, one more is refused; a flood of them or of a line as well. */
static void test_floods(void **state) {
    (void)state;
    char *text = malloc(1 << 20), *at = text;
    transfer_file f = {0};
    for (int i = 0; i < LEAFCAST_TRANSFER_POINTS_MAX; i++)
        at += sprintf(at, "%d 0 0 0 %d\n", i, i % 3);
    assert_int_equal(transfer_file_read(&budget, scratch_text("many", text), &f), ST_OK);
    assert_int_equal(f.extinctions.count, LEAFCAST_TRANSFER_POINTS_MAX);
    transfer_file_release(&f);
    strcpy(at, "5000 0 0 0 0\n");
    assert_int_equal(transfer_file_read(&budget, scratch_text("many", text), &f), ST_UNSUPPORTED);
    assert_non_null(strstr(status_text(), "line 4097"));
    transfer_file_release(&f);
    memset(text, '7', 1 << 19);
    text[1 << 19] = 0;
    assert_int_equal(transfer_file_read(&budget, scratch_text("many", text), &f), ST_CORRUPT);
    transfer_file_release(&f);
    memset(text, '[', 1 << 19);
    assert_int_equal(transfer_file_read(&budget, scratch_text("many", text), &f), ST_CORRUPT);
    transfer_file_release(&f);
    free(text);
}

/* An allocation that fails is ST_NOMEM, and all is given back. */
static void test_no_memory(void **state) {
    (void)state;
    const char *path = scratch_text("p.json", PARAVIEW);
    char name[4096];
    snprintf(name, sizeof name, "%s#a", path);
    bool fired = true;
    for (long k = 1; fired; k++) {
        transfer_file f = {0};
        fault_arm(FAULT_ALLOC, k);
        const status st = transfer_file_read(&budget, name, &f);
        fired = fault_fired(FAULT_ALLOC);
        fault_arm(FAULT_ALLOC, 0);
        assert_int_equal(st, fired ? ST_NOMEM : ST_OK);
        transfer_file_release(&f);
        assert_int_equal(mem_used(&budget), 0);
    }
}

/* ---- Lists ---- */

static transfer_list list_of(const leafcast_transfer_point *points, size_t count) {
    transfer_list t = {.m = &budget};
    for (size_t i = 0; i < count; i++)
        assert_int_equal(transfer_list_add(&t, points[i]), ST_OK);
    return t;
}

static void test_at(void **state) {
    (void)state;
    transfer_list t = list_of(
        (leafcast_transfer_point[]){
            {0.0, {0}, 1.0}, {2.0, {0}, 3.0}, {2.0, {0}, 9.0}, {2.0, {0}, 5.0}, {4.0, {0}, 5.0}},
        5);
    assert_true(transfer_list_at(&t, -1.0, true).extinction == 1.0);
    assert_true(transfer_list_at(&t, 0.0, false).extinction == 1.0);
    assert_true(transfer_list_at(&t, 1.0, true).extinction == 2.0);
    assert_true(transfer_list_at(&t, 2.0, false).extinction == 3.0);
    assert_true(transfer_list_at(&t, 2.0, true).extinction == 5.0);
    assert_true(transfer_list_at(&t, 9.0, false).extinction == 5.0);
    transfer_list_release(&t);
}

static void test_stretch(void **state) {
    (void)state;
    transfer_list t = list_of(
        (leafcast_transfer_point[]){
            {-1.0, {0}, 1.0}, {0.0, {0}, 1.0}, {0.0, {0}, 2.0}, {3.0, {0}, 1.0}},
        4);
    const double own[2] = {-1.0, 3.0}, to[2] = {10.0, 18.0}, all[2] = {-1e300, 1e300};
    const double one[2] = {4.0, 4.0}, beside[2] = {1.0, 2.0};
    transfer_list_stretch(&t, own, to);
    assert_true(t.points[0].value == 10.0 && t.points[1].value == 12.0);
    assert_true(t.points[2].value == 12.0 && t.points[3].value == 18.0);
    transfer_list_stretch(&t, to, all);
    assert_true(t.points[0].value == -1e300 && t.points[3].value == 1e300);
    assert_true(isfinite(t.points[1].value) && t.points[1].value <= t.points[2].value);
    transfer_list_stretch(&t, all, one);
    assert_true(t.points[0].value == 4.0 && t.points[3].value == 4.0);
    transfer_list_stretch(&t, one, beside);
    assert_true(t.points[3].value == 1.0);
    transfer_list_release(&t);
}

/* The union of the knots is both functions, at every value and on both sides of every step. */
static void test_join(void **state) {
    (void)state;
    transfer_list c = list_of((leafcast_transfer_point[]){{0.0, {0, 1, 0}, 0.0},
                                                          {1.0, {1, 0, 0}, 0.0},
                                                          {1.0, {0, 0, 1}, 0.0},
                                                          {3.0, {1, 1, 1}, 0.0}},
                              4);
    transfer_list e = list_of(
        (leafcast_transfer_point[]){
            {0.5, {0}, 2.0}, {1.0, {0}, 4.0}, {2.0, {0}, 0.0}, {2.0, {0}, 8.0}, {5.0, {0}, 1.0}},
        5);
    transfer_list t = {.m = &budget};
    assert_int_equal(transfer_list_join(&t, &c, &e, 0.5), ST_OK);
    assert_int_equal(t.count, 8); /* 0, 0.5, 1 twice, 2 twice, 3, 5 */
    for (size_t i = 1; i < t.count; i++)
        assert_true(t.points[i - 1].value <= t.points[i].value);
    for (int k = -20; k <= 120; k++)
        for (int after = 0; after < 2; after++) {
            const double v = k / 20.0;
            const leafcast_transfer_point p = transfer_list_at(&t, v, after);
            const leafcast_transfer_point want = transfer_list_at(&c, v, after);
            for (int i = 0; i < 3; i++)
                assert_true(fabs((double)p.rgb[i] - (double)want.rgb[i]) < 1e-6);
            assert_true(fabs(p.extinction - 0.5 * transfer_list_at(&e, v, after).extinction) <
                        1e-12);
        }
    transfer_list_release(&t);
    /* With itself: the same points. */
    assert_int_equal(transfer_list_join(&t, &e, &e, 1.0), ST_OK);
    assert_int_equal(t.count, e.count);
    for (size_t i = 0; i < e.count; i++)
        assert_true(t.points[i].value == e.points[i].value &&
                    t.points[i].extinction == e.points[i].extinction);
    transfer_list_release(&t);
    assert_int_equal(transfer_list_join(&t, &c, &e, 1e308), ST_OK);
    for (size_t i = 0; i < t.count; i++)
        assert_true(t.points[i].extinction <= TRANSFER_LIST_MOST);
    transfer_list_release(&t);
    transfer_list_release(&c);
    transfer_list_release(&e);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_colours_between),
        cmocka_unit_test(test_bits),
        cmocka_unit_test(test_opacities_between),
        cmocka_unit_test(test_opaque),
        cmocka_unit_test(test_lines_are_near),
        cmocka_unit_test(test_named),
        cmocka_unit_test(test_names),
        cmocka_unit_test(test_text),
        cmocka_unit_test(test_printed),
        cmocka_unit_test(test_json),
        cmocka_unit_test(test_xml),
        cmocka_unit_test(test_refused),
        cmocka_unit_test(test_beginnings),
        cmocka_unit_test(test_floods),
        cmocka_unit_test(test_mutated),
        cmocka_unit_test(test_no_memory),
        cmocka_unit_test(test_at),
        cmocka_unit_test(test_stretch),
        cmocka_unit_test(test_join),
    };
    mem_init(&budget, 0);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
