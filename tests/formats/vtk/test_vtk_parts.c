/* test_vtk_parts.c - VTK's files that name files, and structured grids: what is read of them, what
 * is refused; cut and damaged files; faults.
 */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/grid/volume_kind.h"
#include "formats/input_open.h"
#include "tests/support/mesh_files.h"
#include "tests/support/scratch.h"
#include "tests/support/volumes.h"
#include "tests/support/vtk_files.h"

/* ---- lists ---- */

/* A file of that type with these elements. */
static const char *list(const char *name, const char *type, const char *elements) {
    char text[2000];
    assert_in_range(snprintf(text, sizeof text,
                             "<VTKFile type=\"%s\">\n<%s>\n%s\n</%s>\n</VTKFile>\n", type, type,
                             elements, type),
                    1, sizeof text - 1);
    return scratch_text(name, text);
}

static const vtk_xml_style styles[] = {
    {.text = true, .pieces = 2},
    {.block = 48, .head64 = true, .big_endian = true, .pieces = 2},
    {.appended = true, .raw = true, .head64 = true, .pieces = 2},
    {.block = 64, .packing = VTK_WRITER_LZ4, .pieces = 2},
};

/* A mesh named by each form, directly and by another. */
static const char *form(int i) {
    static const char piece[] = "<Piece Source='a.vtu'/>", set[] = "<DataSet file='a.vtu'/>";
    list("b.pvtu", "PUnstructuredGrid", piece);
    switch (i) {
    case 0: return list("l.pvtu", "PUnstructuredGrid", piece);
    case 1: return list("l.vtm", "vtkMultiBlockDataSet", set);
    case 2: return list("l.pvd", "Collection", set);
    case 3: return list("l.vtm", "vtkMultiBlockDataSet", "<DataSet file='b.pvtu'/>");
    case 4: return list("l.pvd", "Collection", "<DataSet timestep='4' file='b.pvtu'/>");
    default:
        list("b.vtm", "vtkMultiBlockDataSet",
             "<Block><Block><DataSet file='b.pvtu'/></Block></Block>");
        return list("l.pvd", "Collection", "<DataSet timestep='4' file='b.vtm'/>");
    }
}

enum { FORMS = 6 };

static void test_forms(void **state) {
    (void)state;
    for (size_t s = 0; s < sizeof styles / sizeof *styles; s++) {
        vtk_files_xml("a.vtu", &styles[s]);
        for (int i = 0; i < FORMS; i++) {
            vtk_files_check(mesh_files_good(form(i), NULL), 2, "alpha", 0);
            const mesh_hints cells = {.field = "w", .cells_to_points = true};
            vtk_files_check(mesh_files_good(form(i), &cells), 2, "w", 0);
            assert_true(mesh_files_recognised(form(i)));
        }
    }
}

/* Steps by time, whatever their order; parts of one time in the file's order. */
static void test_steps(void **state) {
    (void)state;
    static const double expected[] = {-0.5, 1, 1e10};
    vtk_files_xml("a.vtu", &(vtk_xml_style){.text = true});
    vtk_files_xml("c.vtu", &(vtk_xml_style){.text = true, .pieces = 3});
    const char *path = list("l.pvd", "Collection",
                            "<DataSet timestep='1' file='c.vtu'/><DataSet timestep='1e10' "
                            "file='a.vtu'/><DataSet timestep='-.5' file='a.vtu'/><DataSet "
                            "timestep='1.0' part='1' file='a.vtu'/>");
    static const int pieces[] = {1, 4, 1};
    for (uint32_t step = 0; step < 3; step++) {
        const mesh_copy *a = mesh_files_good(path, &(mesh_hints){.step = step});
        assert_int_equal(a->report.points, pieces[step] * VTK_FILES_POINTS);
        assert_int_equal(a->report.tets, pieces[step] * VTK_FILES_TETS);
    }
    mesh_files_refused(path, &(mesh_hints){.step = 3}, ST_USAGE,
                       "no step 3: there are 3, counted from 0");
    mem m;
    mem_init(&m, 0);
    mesh_input *x = NULL;
    assert_int_equal(mesh_input_open(&m, path, &(mesh_hints){.step = 2}, &x), ST_OK);
    assert_int_equal(mesh_input_steps(x), 3);
    assert_memory_equal(mesh_input_times(x), expected, sizeof expected);
    assert_string_equal(mesh_input_file(x), scratch_path("a.vtu"));
    mesh_input_close(x);
    assert_int_equal(mem_used(&m), 0);
    mesh_files_refused(scratch_path("a.vtu"), &(mesh_hints){.step = 1}, ST_USAGE, "no step 1");
}

static void test_refused(void **state) {
    (void)state;
    static const struct {
        const char *type, *elements;
        status st;
        const char *said;
    } cases[] = {
        {"PUnstructuredGrid", "", ST_CORRUPT, "names no file"},
        {"PUnstructuredGrid", "<Piece/>", ST_CORRUPT, "line 3: expected the attribute Source"},
        {"PUnstructuredGrid", "<Piece Source='none.vtu'/>", ST_IO,
         "none.vtu: cannot open: No such file"},
        {"PUnstructuredGrid", "<Piece Source='l.xml'/>", ST_UNSUPPORTED, "is PUnstructuredGrid"},
        {"PUnstructuredGrid", "<Piece Source='../a.vtu'/>", ST_UNSUPPORTED,
         "outside of its folder"},
        {"PUnstructuredGrid", "<Piece Source='text'/>", ST_UNSUPPORTED, "is nothing of VTK"},
        {"PUnstructuredGrid", "<Piece Source='a.vtu'/><Piece Source='text'/>", ST_UNSUPPORTED,
         "text is nothing of VTK; give one of them itself: "},
        {"vtkMultiBlockDataSet", "<DataSet/>", ST_CORRUPT, "names no file"},
        {"vtkMultiBlockDataSet", "<DataSet file='l.xml'/>", ST_UNSUPPORTED,
         "is vtkMultiBlockDataSet"},
        {"Collection", "<DataSet/>", ST_CORRUPT, "expected the attribute file"},
        {"Collection", "<DataSet file='l.xml'/>", ST_UNSUPPORTED, "is Collection"},
        {"Collection", "<DataSet timestep='' file='a.vtu'/>", ST_CORRUPT, "timestep"},
        {"Collection", "<DataSet timestep='nan' file='a.vtu'/>", ST_CORRUPT, "timestep"},
        {"Collection", "<DataSet timestep='1 2' file='a.vtu'/>", ST_CORRUPT, "expected 1 numbers"},
    };
    vtk_files_xml("a.vtu", &styles[0]);
    scratch_text("text", "neither one nor the other");
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        mesh_files_refused(list("l.xml", cases[i].type, cases[i].elements), NULL, cases[i].st,
                           cases[i].said);
    const char *path = list("l.pvd", "Collection", "<DataSet file='a.vti'/>");
    scratch_text("a.vti", "?");
    volumes_refused(path, NULL, ST_CORRUPT, "a.vti");
    assert_false(mesh_files_recognised(path));
}

static void test_list_sweeps(void **state) {
    (void)state;
    vtk_files_xml("a.vtu", &(vtk_xml_style){.text = true});
    for (int i = 0; i < FORMS; i++) {
        mesh_files_truncate(form(i), NULL, 12);
        mesh_files_damage(form(i), NULL);
        mesh_files_faults(form(i), NULL);
    }
}

/* ---- structured grids ---- */

typedef void placing(int i, int j, int k, double xyz[3]);

/* The test volume with its nodes there; type: of the points. */
static const char *structured(const char *name, const vtk_xml_style *style, const char *type,
                              placing *place) {
    double samples[VOLUMES_SAMPLES], points[3 * VOLUMES_SAMPLES];
    vtk_writer w;
    int n = 0;
    for (int k = 0; k < VOLUMES_NZ; k++)
        for (int j = 0; j < VOLUMES_NY; j++)
            for (int i = 0; i < VOLUMES_NX; i++, n++) {
                samples[n] = 7 * n - 50;
                place(i, j, k, points + 3 * (ptrdiff_t)n);
            }
    vtk_writer_begin(&w, "StructuredGrid", style);
    fprintf(w.out, "<StructuredGrid WholeExtent=\"5 8 0 2 -1 0\"><Piece Extent=\"5 8 0 2 -1 0\">\n"
                   "<PointData>\n");
    vtk_writer_array(&w, "s", "Float32", 1, VOLUMES_SAMPLES, samples);
    fprintf(w.out, "</PointData>\n<Points>\n");
    vtk_writer_array(&w, "Points", type, 3, (size_t)3 * VOLUMES_SAMPLES, points);
    fprintf(w.out, "</Points>\n</Piece></StructuredGrid>\n");
    return vtk_writer_end(&w, name);
}

static const vtk_xml_style codings[] = {
    {.text = true}, {.block = 48}, {.appended = true, .raw = true, .big_endian = true}};

static void place_even(int i, int j, int k, double xyz[3]) {
    xyz[0] = 2 - 0.5 * i;
    xyz[1] = 4 * k;
    xyz[2] = 1 + 0.25 * j;
}

/* Sheared and turned. */
static void place_turned(int i, int j, int k, double xyz[3]) {
    xyz[0] = 1e3 + 0.1 * i + 0.3 * j - 0.01 * k;
    xyz[1] = -7 + 0.2 * i - 0.1 * j;
    xyz[2] = 0.7 * k + 0.05 * i;
}

static void place_uneven(int i, int j, int k, double xyz[3]) {
    xyz[0] = i * i + 0.5 * i;
    xyz[1] = 3 * j;
    xyz[2] = 5 - k;
}

/* Uneven along a slanted axis. */
static void place_slanted(int i, int j, int k, double xyz[3]) {
    xyz[0] = 0.6 * i * i;
    xyz[1] = 0.8 * i * i + 2 * j;
    xyz[2] = k;
}

static double bend; /* of one node */

static void place_bent(int i, int j, int k, double xyz[3]) {
    place_even(i, j, k, xyz);
    if (i == 2 && j == 1 && k == 1)
        xyz[2] += bend;
}

static void place_bent_edge(int i, int j, int k, double xyz[3]) {
    place_even(i, j, k, xyz);
    if (i == 1)
        xyz[2] += bend;
}

/* All nodes where they were put, to so much; whether it is rectilinear. */
static bool check_place(const char *path, placing *place, double most) {
    mem m;
    mem_init(&m, 0);
    volume *v = NULL;
    if (volume_open(&m, path, NULL, &v) != ST_OK)
        fail_msg("%s", status_text());
    const grid *g = volume_grid(v);
    for (int n = 0; n < VOLUMES_SAMPLES; n++) {
        const int at[3] = {n % VOLUMES_NX, n / VOLUMES_NX % VOLUMES_NY,
                           n / VOLUMES_NX / VOLUMES_NY};
        double xyz[3];
        place(at[0], at[1], at[2], xyz);
        for (int row = 0; row < 3; row++) {
            double got = g->to_world[row][3];
            for (int a = 0; a < 3; a++)
                got += g->to_world[row][a] * (g->axis[a] ? g->axis[a][at[a]] : at[a]);
            if (!(fabs(got - xyz[row]) <= most))
                fail_msg("%s: node %d: %.17g, expected %.17g", path, n, got, xyz[row]);
        }
    }
    const bool rectilinear = grid_is_rectilinear(g);
    volume_close(v);
    assert_int_equal(mem_used(&m), 0);
    return rectilinear;
}

static void test_structured(void **state) {
    (void)state;
    static const double even[3][4] = {{-0.5, 0, 0, 2}, {0, 0, 4, 0}, {0, 0.25, 0, 1}};
    for (size_t c = 0; c < sizeof codings / sizeof *codings; c++)
        for (int f64 = 0; f64 < 2; f64++) {
            const char *type = f64 ? "Float64" : "Float32";
            const double far = (f64 ? DBL_EPSILON : (double)FLT_EPSILON) * 8e3;
            volumes_check(structured("a.vts", &codings[c], type, place_even), NULL, SAMPLE_F32,
                          even);
            const char *path = structured("a.vts", &codings[c], type, place_turned);
            assert_false(check_place(path, place_turned, far));
            path = structured("a.vts", &codings[c], type, place_uneven);
            assert_true(check_place(path, place_uneven, 0));
            path = structured("a.vts", &codings[c], type, place_slanted);
            assert_true(check_place(path, place_slanted, far));
        }
    /* Whole numbers, too. */
    assert_true(
        check_place(structured("a.vts", &codings[1], "Float64", place_uneven), place_uneven, 0));
}

/* What rounding does is taken, and no more. */
static void test_curvilinear(void **state) {
    (void)state;
    static placing *const bends[] = {place_bent, place_bent_edge};
    for (int i = 0; i < 2; i++) {
        bend = 0x1p-23;
        volumes_check(structured("a.vts", &codings[1], "Float32", bends[i]), NULL, SAMPLE_F32,
                      (const double[3][4]){{-0.5, 0, 0, 2}, {0, 0, 4, 0}, {0, 0.25, 0, 1}});
        for (bend = 1e-4; bend < 1; bend *= 10)
            volumes_refused(structured("a.vts", &codings[1], "Float32", bends[i]), NULL,
                            ST_UNSUPPORTED, "a curvilinear grid, which is not read here: node ");
        bend = 1e-9;
        volumes_refused(structured("a.vts", &codings[1], "Float64", bends[i]), NULL, ST_UNSUPPORTED,
                        "Resample To Image");
        bend = NAN;
        volumes_refused(structured("a.vts", &codings[1], "Float64", bends[i]), NULL, ST_CORRUPT,
                        "expected finite coordinates");
    }
}

static void test_structured_refused(void **state) {
    (void)state;
    const char *path = structured("a.vts", &codings[0], "Float32", place_even);
    volumes_refused(vtk_files_patch(path, "<Points>", "<Other>"), NULL, ST_CORRUPT, "mismatched");
    volumes_refused(vtk_files_patch(path, "NumberOfComponents=\"3\"", "NumberOfComponents=\"2\""),
                    NULL, ST_CORRUPT, "2 components, expected 3 numbers");
    volumes_refused(vtk_files_patch(path, "type=\"Float32\" Name=\"Points\"",
                                    "type=\"String\" Name=\"Points\""),
                    NULL, ST_CORRUPT, "expected 3 numbers");
    volumes_refused(
        vtk_files_patch(path, "WholeExtent=\"5 8 0 2 -1 0\"", "WholeExtent=\"5 8 0 2 -1 1\""), NULL,
        ST_CORRUPT, "do not fill the whole extent");
    volumes_refused(vtk_files_patch(path, "Extent=\"5 8 0 2 -1 0\"><Piece Extent=\"5 8 0 2 -1 0\"",
                                    "Extent=\"5 5 0 2 -1 0\"><Piece Extent=\"5 5 0 2 -1 0\""),
                    NULL, ST_UNSUPPORTED, "1 sample along x");
}

static void test_structured_sweeps(void **state) {
    (void)state;
    for (size_t c = 0; c < sizeof codings / sizeof *codings; c++) {
        const char *path = structured("a.vts", &codings[c], "Float32", place_uneven);
        volumes_faults(path, NULL);
        volumes_damage(path, NULL);
        if (codings[c].text)
            volumes_truncate(path, NULL, 12);
    }
}

/* ---- collections of grids ---- */

static void test_grid_steps(void **state) {
    (void)state;
    structured("a.vts", &codings[0], "Float32", place_even);
    structured("b.vts", &codings[1], "Float64", place_uneven);
    const char *path = list("l.pvd", "Collection",
                            "<DataSet timestep='3' file='b.vts'/><DataSet timestep='2' "
                            "file='a.vts'/>");
    assert_false(check_place(path, place_even, 0));
    volumes_refused(path, &(volume_hints){.step = 2}, ST_USAGE, "there are 2, counted from 0");
    volumes_faults(path, &(volume_hints){.step = 1});
    volumes_damage(path, NULL);
    volumes_truncate(path, NULL, 12);
    path = list("l.vtm", "vtkMultiBlockDataSet", "<Block><DataSet file='b.vts'/></Block>");
    assert_true(check_place(path, place_uneven, 0));
    path = list("l.vtm", "vtkMultiBlockDataSet", "<DataSet file='b.vts'/><DataSet file='a.vts'/>");
    volumes_refused(path, NULL, ST_UNSUPPORTED, "several grids as blocks: give one of them itself");
    /* The front door tells lists of grids from those of meshes. */
    input in;
    mem m;
    mem_init(&m, 0);
    assert_int_equal(input_open(&m, scratch_path("l.pvd"), NULL, &in), ST_OK);
    assert_true(in.kind == &volume_kind && strcmp(in.kind->format(in.own), VOLUME_COLLECTION) == 0);
    input_close(&in);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_forms),
        cmocka_unit_test(test_steps),
        cmocka_unit_test(test_refused),
        cmocka_unit_test(test_list_sweeps),
        cmocka_unit_test(test_structured),
        cmocka_unit_test(test_curvilinear),
        cmocka_unit_test(test_structured_refused),
        cmocka_unit_test(test_structured_sweeps),
        cmocka_unit_test(test_grid_steps),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
