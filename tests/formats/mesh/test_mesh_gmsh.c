/* test_mesh_gmsh.c - Gmsh's .msh of both versions as text and binary, all kinds of cells and data;
 * refusals that name the place, cut and damaged files, faults.
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

#include "formats/base/id_map.h"
#include "tests/support/mesh_files.h"
#include "tests/support/scratch.h"

/* ---- the test mesh: a cube, a pyramid on it, a prism beside it, a tet in front of that ---- */

enum { NODES = 12, CELLS = 7, IN_FIRST_BLOCK = 7 };

static const double at[NODES][3] = {{0, 0, 0},     {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                    {0, 0, 1},     {1, 0, 1}, {1, 1, 1}, {0, 1, 1},
                                    {0.5, 0.5, 2}, {2, 0, 0}, {2, 1, 0}, {1.25, -1, 0.25}};
static const int node_id[NODES] = {40, 7, 8, 9, 100, 3, 2, 1, 500, 12, 11, 1000000};

static const struct {
    int id, type, dimensions, nodes, node[8];
} cells[CELLS] = {
    {1, 15, 0, 1, {3}},
    {2, 1, 1, 2, {3, 4}},
    {900, 2, 2, 3, {0, 1, 2}},
    {50, 5, 3, 8, {0, 1, 2, 3, 4, 5, 6, 7}},
    {51, 7, 3, 5, {4, 5, 6, 7, 8}},
    {20, 6, 3, 6, {1, 9, 5, 2, 10, 6}},
    {1000, 4, 3, 4, {1, 9, 5, 11}},
};

/* ---- writing it ---- */

typedef struct msh {
    char bytes[1 << 14];
    size_t size;
    int version, width; /* of a size_t */
    bool binary, foreign;
} msh;

static void put_text(msh *o, const char *text) {
    memcpy(o->bytes + o->size, text, strlen(text));
    o->size += strlen(text);
}

static void put_raw(msh *o, const void *value, size_t size) {
    for (size_t i = 0; i < size; i++)
        o->bytes[o->size + i] = ((const char *)value)[o->foreign ? size - 1 - i : i];
    o->size += size;
}

static void put_int(msh *o, int value) {
    char text[20];
    snprintf(text, sizeof text, "%d ", value);
    if (o->binary)
        put_raw(o, &value, 4);
    else
        put_text(o, text);
}

static void put_size(msh *o, int value) {
    uint64_t wide = (uint64_t)value;
    if (o->binary && o->width == 8)
        put_raw(o, &wide, 8);
    else
        put_int(o, value);
}

static void put_double(msh *o, double value) {
    char text[40];
    snprintf(text, sizeof text, "%.17g ", value);
    if (o->binary)
        put_raw(o, &value, 8);
    else
        put_text(o, text);
}

static void end_row(msh *o) {
    if (!o->binary)
        put_text(o, "\n");
}

static void put_point(msh *o, int n, int parameters) {
    for (int a = 0; a < 3; a++)
        put_double(o, at[n][a]);
    for (int i = 0; i < parameters; i++)
        put_double(o, -9);
    end_row(o);
}

static void put_nodes_2(msh *o) {
    put_text(o, "$Nodes\n12\n");
    for (int n = 0; n < NODES; n++) {
        put_int(o, node_id[n]);
        put_point(o, n, 0);
    }
    put_text(o, "\n$EndNodes\n");
}

static void put_header(msh *o, int blocks, int all) {
    put_size(o, blocks);
    put_size(o, all);
    put_size(o, 1);
    put_size(o, 1000000);
    end_row(o);
}

static void put_node_block(msh *o, int dimensions, bool parametric, int from, int to) {
    put_int(o, dimensions);
    put_int(o, 1);
    put_int(o, parametric);
    put_size(o, to - from);
    end_row(o);
    for (int n = from; n < to; n++) {
        put_size(o, node_id[n]);
        end_row(o);
    }
    for (int n = from; n < to; n++)
        put_point(o, n, parametric ? dimensions : 0);
}

static void put_nodes_4(msh *o) {
    put_text(o, "$Entities\n");
    put_raw(o, "\1\0$End$EndEntitie", 17);
    put_text(o, "\n$EndEntities\n$Nodes\n");
    put_header(o, 3, NODES);
    put_node_block(o, 2, true, 0, IN_FIRST_BLOCK);
    put_node_block(o, 1, true, 0, 0);
    put_node_block(o, 3, false, IN_FIRST_BLOCK, NODES);
    put_text(o, "\n$EndNodes\n");
}

static void put_elements(msh *o) {
    put_text(o, o->version == 2 ? "$Elements\n7\n" : "$Elements\n");
    if (o->version == 4)
        put_header(o, CELLS, CELLS);
    for (int i = 0; i < CELLS; i++) {
        if (o->version == 4) {
            put_int(o, cells[i].dimensions);
            put_int(o, 1);
            put_int(o, cells[i].type);
            put_size(o, 1);
            end_row(o);
            put_size(o, cells[i].id);
        } else {
            if (!o->binary)
                put_int(o, cells[i].id);
            put_int(o, cells[i].type);
            if (o->binary)
                put_int(o, 1);
            put_int(o, 2);
            if (o->binary)
                put_int(o, cells[i].id);
            put_int(o, 99);
            put_int(o, 4);
        }
        for (int k = 0; k < cells[i].nodes; k++)
            (o->version == 2 ? put_int : put_size)(o, node_id[cells[i].node[k]]);
        end_row(o);
    }
    put_text(o, "\n$EndElements\n");
}

static void put_tags(msh *o, const char *section, const char *name, int components, int rows) {
    char text[200];
    snprintf(text, sizeof text, "$%s\n1\n%s\n1\n0.5\n4\n3\n%d\n%d\n0\n", section, name, components,
             rows);
    put_text(o, text);
}

static double temperature(int n) {
    return at[n][0] + 2 * at[n][1] + 4 * at[n][2];
}

/* Nodes backwards, without the first; one that is no point. */
static void put_node_data(msh *o) {
    put_tags(o, "NodeData", "\"the temperature\"", 1, NODES);
    for (int n = NODES; n-- > 1;) {
        put_int(o, node_id[n]);
        put_double(o, temperature(n));
        end_row(o);
    }
    put_int(o, 5555);
    put_double(o, 1);
    put_text(o, "\n$EndNodeData\n");
    put_tags(o, "NodeData", "speed", 3, NODES);
    for (int n = 0; n < NODES; n++) {
        put_int(o, node_id[n]);
        for (int a = 0; a < 3; a++)
            put_double(o, at[n][a]);
        end_row(o);
    }
    put_text(o, "\n$EndNodeData\n");
}

/* Volumes alone: 10 for the cube, 20, ..; of $ElementNodeData plus the node's place in the cell. */
static void put_element_data(msh *o, bool nodes) {
    put_tags(o, nodes ? "ElementNodeData" : "ElementData", nodes ? "\"stress\"" : "\"density\"", 1,
             4);
    for (int i = 3; i < CELLS; i++) {
        put_int(o, cells[i].id);
        if (nodes)
            put_int(o, cells[i].nodes);
        for (int k = 0; k < (nodes ? cells[i].nodes : 1); k++)
            put_double(o, 10 * (i - 2) + k);
        end_row(o);
    }
    put_text(o, nodes ? "\n$EndElementNodeData\n" : "\n$EndElementData\n");
}

static const char *write_msh(msh *o) {
    char text[100];
    o->size = 0;
    snprintf(text, sizeof text, "$Comments\nwhat $EndNodes\n$EndComments\n$MeshFormat\n%s %d %d\n",
             o->version == 2 ? "2.2" : "4.1", o->binary, o->version == 2 ? 8 : o->width);
    put_text(o, text);
    if (o->binary)
        put_raw(o, &(int){1}, 4);
    put_text(o, o->binary ? "\n$EndMeshFormat\n" : "$EndMeshFormat\n");
    put_text(o, "$PhysicalNames\n1\n3 1 \"all of it\"\n$EndPhysicalNames\n");
    (o->version == 2 ? put_nodes_2 : put_nodes_4)(o);
    put_elements(o);
    put_element_data(o, false);
    put_node_data(o);
    put_element_data(o, true);
    return scratch_write("a.msh", o->bytes, o->size);
}

static const struct {
    int version, width;
    bool binary, foreign;
} variants[] = {{2, 8, false, false}, {2, 8, true, false}, {2, 8, true, true}, {4, 8, false, false},
                {4, 8, true, false},  {4, 8, true, true},  {4, 4, true, false}};

enum { VARIANTS = sizeof variants / sizeof *variants };

static const char *write_variant(int i) {
    static msh o;
    o = (msh){.version = variants[i].version,
              .width = variants[i].width,
              .binary = variants[i].binary,
              .foreign = variants[i].foreign};
    return write_msh(&o);
}

/* ---- reading it ---- */

static void check_mesh(const mesh_copy *a) {
    assert_int_equal(a->report.points, NODES);
    assert_int_equal(a->report.tets, 6 + 3 + 2 + 1);
    assert_int_equal(a->report.split[CELL_HEXAHEDRON], 1);
    assert_int_equal(a->report.split[CELL_WEDGE], 1);
    assert_int_equal(a->report.split[CELL_PYRAMID], 1);
    assert_int_equal(a->report.skipped, 3);
    assert_int_equal(a->report.bad_indices + a->report.repeated, 0);
    for (int n = 0; n < NODES; n++)
        for (int k = 0; k < 3; k++)
            assert_true(a->xyz[n][k] == (float)at[n][k]);
    double all;
    (void)mesh_files_volume(a, &all);
    assert_true(fabs(all - 2) < 1e-12);
    assert_true(mesh_files_closed(a));
}

static void check_values(const mesh_copy *a, const char *field, const double want[NODES]) {
    assert_string_equal(a->report.field, field);
    for (int n = 0; n < NODES; n++)
        if (!(a->values[n] == (float)want[n]) && !(isnan(a->values[n]) && isnan(want[n])))
            fail_msg("%s: value %d is %g, not %g", field, n, (double)a->values[n], want[n]);
}

/* The means that put_element_data() makes. */
static void element_means(bool nodes, double want[NODES]) {
    for (int n = 0; n < NODES; n++) {
        double sum = 0;
        int count = 0;
        for (int i = 3; i < CELLS; i++)
            for (int k = 0; k < cells[i].nodes; k++)
                if (cells[i].node[k] == n) {
                    sum += 10 * (i - 2) + (nodes ? k : 0);
                    count++;
                }
        want[n] = sum / count;
    }
}

static void test_variants(void **state) {
    (void)state;
    mesh_copy *first = NULL;
    for (int i = 0; i < VARIANTS; i++) {
        double want[NODES];
        const char *path = write_variant(i);
        assert_true(mesh_files_recognised(path));
        for (int n = 0; n < NODES; n++)
            want[n] = n == 0 ? (double)NAN : temperature(n);
        const mesh_copy *a = mesh_files_good(path, NULL);
        check_mesh(a);
        check_values(a, "the temperature", want);
        if (first)
            mesh_files_same(first, a);
        else
            first = mesh_files_keep(a);
        for (int n = 0; n < NODES; n++)
            want[n] = sqrt(at[n][0] * at[n][0] + at[n][1] * at[n][1] + at[n][2] * at[n][2]);
        check_values(mesh_files_good(path, &(mesh_hints){.field = "speed"}), "speed", want);
        for (int n = 0; n < NODES; n++)
            want[n] = at[n][2];
        check_values(mesh_files_good(path, &(mesh_hints){.field = "speed", .component = 3}),
                     "speed", want);
        element_means(true, want);
        check_values(mesh_files_good(path, &(mesh_hints){.field = "stress"}), "stress", want);
        element_means(false, want);
        a = mesh_files_good(path, &(mesh_hints){.cells_to_points = true});
        check_values(a, "density", want);
        check_mesh(a);
    }
    free(first);
}

/* Another step of a node field: `value` everywhere. */
static void put_step(msh *o, const char *name, double time, double value) {
    char text[200];
    snprintf(text, sizeof text, "$NodeData\n1\n\"%s\"\n1\n%g\n3\n1\n1\n%d\n", name, time, NODES);
    put_text(o, text);
    for (int n = 0; n < NODES; n++) {
        put_int(o, node_id[n]);
        put_double(o, value);
        end_row(o);
    }
    put_text(o, "\n$EndNodeData\n");
}

/* "the temperature" at three steps, 0.5, 1.5 and `last`; "wind" at two. */
static const char *write_steps(int variant, double last) {
    static msh o;
    o = (msh){.version = variants[variant].version,
              .width = variants[variant].width,
              .binary = variants[variant].binary,
              .foreign = variants[variant].foreign};
    (void)write_msh(&o);
    put_step(&o, "wind", 0.5, 30);
    put_step(&o, "the temperature", 1.5, 7);
    put_step(&o, "wind", 1.5, 31);
    put_step(&o, "the temperature", last, 8);
    return scratch_write("a.msh", o.bytes, o.size);
}

static void check_step(const char *path, const char *field, uint32_t step, double value) {
    double want[NODES];
    for (int n = 0; n < NODES; n++)
        want[n] = value;
    check_values(mesh_files_good(path, &(mesh_hints){.field = field, .step = step}), field, want);
}

static void check_times(const char *path, double last) {
    mem m;
    mesh_input *x = NULL;
    mem_init(&m, 0);
    assert_int_equal(mesh_input_open(&m, path, NULL, &x), ST_OK);
    assert_int_equal(mesh_input_steps(x), 3);
    const double *times = mesh_input_times(x);
    assert_non_null(times);
    assert_true(times[0] == 0.5 && times[1] == 1.5 && times[2] == last);
    mesh_input_close(x);
    assert_int_equal(mem_used(&m), 0);
}

static void test_steps(void **state) {
    (void)state;
    for (int i = 0; i < VARIANTS; i++) {
        const char *path = write_steps(i, 2.5);
        check_times(path, 2.5);
        check_step(path, "the temperature", 1, 7);
        check_step(path, "the temperature", 2, 8);
        check_step(path, "wind", 0, 30);
        check_step(path, "wind", 1, 31);
        mesh_files_refused(path, &(mesh_hints){.field = "wind", .step = 2}, ST_USAGE,
                           "a.msh: \"wind\" has no step 2");
        mesh_files_refused(path, &(mesh_hints){.step = 3}, ST_USAGE,
                           "a.msh: no step 3: there are 3, counted from 0");
        /* One array is a field's at all steps. */
        mesh_copy *speed = mesh_files_keep(mesh_files_good(path, &(mesh_hints){.field = "speed"}));
        mesh_files_same(speed, mesh_files_good(path, &(mesh_hints){.field = "speed", .step = 2}));
        free(speed);
        check_times(write_steps(i, 1.5), 1.5);
    }
}

static void test_refused_hints(void **state) {
    (void)state;
    const char *path = write_variant(3);
    mesh_files_refused(path, &(mesh_hints){.field = "density"}, ST_USAGE,
                       "a.msh: no array \"density\" of the points, which have \"the temperature\", "
                       "\"speed\", \"stress\"; the cells have \"density\" (--cells-to-points");
    mesh_files_refused(path, &(mesh_hints){.field = "speed", .cells_to_points = true}, ST_USAGE,
                       "no array \"speed\" of the cells, which have \"density\"; the points have");
    mesh_files_refused(path, &(mesh_hints){.field = "speed", .component = 4}, ST_USAGE,
                       "\"speed\" has no component 4 but 1 to 3");
}

static void test_sweeps(void **state) {
    (void)state;
    const mesh_hints stress = {.field = "stress"}, density = {.cells_to_points = true};
    for (int i = 0; i < VARIANTS; i++) {
        const mesh_hints *hints = i % 3 == 0 ? NULL : i % 3 == 1 ? &stress : &density;
        const char *path = write_variant(i);
        mesh_files_faults(path, hints);
        if (i == 1 || i == 3)
            assert_true(mesh_files_damage(path, hints) > 0);
        if (i == 0 || i == 4)
            mesh_files_truncate(path, &stress, 1);
    }
}

/* ---- refusals ---- */

#define TWO   "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"
#define FOUR  "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n"
#define NODE2 "$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n"
#define NODE4 "$Nodes\n1 4 1 4\n3 1 0 4\n1 2 3 4\n0 0 0 1 0 0 0 1 0 0 0 1\n$EndNodes\n"
#define TET2  "$Elements\n1\n7 4 0 1 2 3 4\n$EndElements\n"
#define TET4  "$Elements\n1 1 7 7\n3 1 4 1\n7 1 2 3 4\n$EndElements\n"
#define DATA  "$NodeData\n1\n\"f\"\n0\n3\n0\n1\n1\n"

static void test_refused(void **state) {
    (void)state;
    static const struct {
        const char *text;
        status st;
        const char *said;
    } cases[] = {
        {"$MeshFormat\n1 0 8\n$EndMeshFormat\n", ST_UNSUPPORTED,
         "version \"1\", expected 2.2 or 4.1"},
        {"$MeshFormat\n4 0 8\n$EndMeshFormat\n", ST_UNSUPPORTED, "version \"4\""},
        {"$MeshFormat\n2.2 2 8\n$EndMeshFormat\n", ST_CORRUPT, "line 2: \"2\", expected 0 (text)"},
        {"$MeshFormat\n2.2 1 8\n$End\n", ST_CORRUPT, "expected the number 1 in either byte order"},
        {"$MeshFormat\n2.2 0 8\n", ST_CORRUPT, "ends in the section of line 1, expected $EndMeshF"},
        {"$Comments\n$EndComments\n" NODE2, ST_CORRUPT, "\"$Nodes\", expected $MeshFormat"},
        {TWO TWO, ST_CORRUPT, "expected one section $MeshFormat"},
        {TWO, ST_CORRUPT, "b.msh: expected the section $Nodes"},
        {TWO NODE2, ST_CORRUPT, "b.msh: expected the section $Elements"},
        {TWO NODE2 TET2 NODE2, ST_CORRUPT, "line 15: \"$Nodes\", expected one section $Nodes"},
        {TWO "Nodes\n", ST_CORRUPT, "line 4: \"Nodes\", expected a section"},
        {TWO "$Nodes\n4\n1 0 0 0\n$EndNodes\n" TET2, ST_CORRUPT,
         "\"$EndNodes\", expected a node's"},
        {TWO "$Nodes\n1\n1 0 0 0\n2 0 0 0\n$EndNodes\n" TET2, ST_CORRUPT,
         "line 7: expected $EndNodes behind"},
        {TWO "$Nodes\n1\n1 0 x 0\n$EndNodes\n" TET2, ST_CORRUPT,
         "line 6: \"x\", expected a coordinate"},
        {TWO "$Nodes\n1\n1 0 inf 0\n$EndNodes\n" TET2, ST_CORRUPT, "point 0 (counted from 0)"},
        {TWO "$Nodes\n2\n1 0 0 0\n1 0 0 0\n$EndNodes\n" TET2, ST_CORRUPT, "node 1 is there twice"},
        {TWO "$Nodes\n-2\n1 0 0 0\n$EndNodes\n" TET2, ST_UNSUPPORTED, "points, expected at most"},
        {TWO NODE2 "$Elements\n1\n7 11 0 1 2 3 4\n$EndElements\n", ST_UNSUPPORTED,
         "line 13: an element of type 11, expected tets"},
        {TWO NODE2 "$Elements\n1\n7 -4 0 1 2 3 4\n$EndElements\n", ST_UNSUPPORTED, "of type -4"},
        {TWO NODE2 "$Elements\n1\n7 99 0 1 2 3 4\n$EndElements\n", ST_UNSUPPORTED, "of type 99"},
        {TWO NODE2 "$Elements\n1\n7 4 -1 1 2 3 4\n$EndElements\n", ST_CORRUPT, "-1 tags"},
        {TWO NODE2 "$Elements\n2\n7 4 0 1 2 3 4\n$EndElements\n", ST_CORRUPT,
         "line 14: \"$EndElements\", expected an element's number"},
        {TWO NODE2 "$Elements\n1\n7 4 0 1 2 3\n$EndElements\n", ST_CORRUPT,
         "expected the number of"},
        {TWO NODE2 TET2 "$NodeData\n1\n\"f\"\n0\n2\n0\n1\n$EndNodeData\n", ST_CORRUPT,
         "expected the number of integer tags"},
        {TWO NODE2 TET2 "$NodeData\n1\n\"f\"\n0\n3\n0\n10\n1\n$EndNodeData\n", ST_CORRUPT,
         "\"10\", expected 1 to 9 components"},
        {TWO NODE2 TET2 DATA "1 x\n$EndNodeData\n", ST_CORRUPT, "line 23: \"x\", expected a value"},
        {TWO NODE2 TET2 DATA "1 5\n2 5\n$EndNodeData\n", ST_CORRUPT,
         "expected $EndNodeData behind"},
        {TWO NODE2 TET2 "$ElementNodeData\n0\n0\n3\n0\n1\n1\n7 3 1 1 1\n$EndElementNodeData\n",
         ST_CORRUPT, "element 7 has values for 3 nodes, expected 4"},
        {TWO NODE2 TET2 "$ElementNodeData\n0\n0\n3\n0\n1\n1\n7 0\n$EndElementNodeData\n",
         ST_CORRUPT, "an element of 0 nodes"},
        {TWO NODE2 TET2 "$ElementNodeData\n0\n0\n3\n0\n1\n2\n7 1 1\n7 1 1\n$EndElementNodeData\n",
         ST_CORRUPT, "element 7 has two rows"},
        {FOUR "$Nodes\n1 4 1 4\n3 1 0 5\n$EndNodes\n" TET4, ST_CORRUPT, "a block of 5 nodes"},
        {FOUR "$Nodes\n1 1 1 1\n4 1 0 1\n$EndNodes\n" TET4, ST_CORRUPT, "expected a dimension of"},
        {FOUR "$Nodes\n0 1 1 1\n$EndNodes\n" TET4, ST_CORRUPT, "0 nodes in all blocks, expected 1"},
        {FOUR NODE4 "$Elements\n1 1 7 7\n3 1 4 2\n7 1 2 3 4\n$EndElements\n", ST_CORRUPT,
         "a block of 2 elements, expected at most 1"},
        {FOUR NODE4 "$Elements\n1 2 7 7\n3 1 4 1\n7 1 2 3 4\n$EndElements\n", ST_CORRUPT,
         "expected 1 elements more"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        mesh_files_refused(scratch_text("b.msh", cases[i].text), NULL, cases[i].st, cases[i].said);
    mesh_files_good(scratch_text("b.msh", TWO NODE2 TET2), NULL);
    mesh_files_good(scratch_text("b.msh", FOUR NODE4 TET4 DATA "1 5\n$EndNodeData"), NULL);
}

static void test_left_out(void **state) {
    (void)state;
    const mesh_copy *a = mesh_files_good(
        scratch_text("b.msh", TWO NODE2 "$Elements\n4\n7 4 0 1 2 3 4\n8 4 0 1 2 3 5\n"
                                        "9 4 1 0 1 2 2 3\n10 6 0 1 2 3 4 -1 6\n$EndElements\n"),
        NULL);
    assert_int_equal(a->report.tets, 1);
    assert_int_equal(a->report.bad_indices, 2);
    assert_int_equal(a->report.repeated, 1);
    assert_string_equal(a->report.field, "");
}

/* ---- the map of numbers ---- */

static void test_id_map(void **state) {
    (void)state;
    mem m;
    mem_init(&m, 0);
    enum { IDS = 5000 };
    uint64_t twice = 0;
    for (uint64_t step = 1; step < 20; step += 3) {
        /* step is prime to 5003: all different, in runs of one for a step above 1. */
        id_map map = {.m = &m};
        for (uint64_t i = 0; i < IDS; i++)
            assert_int_equal(id_map_add(&map, 10 + i * step % 5003), ST_OK);
        assert_true(id_map_seal(&map, &twice));
        for (uint64_t i = 0; i < IDS; i++)
            assert_int_equal(id_map_find(&map, 10 + i * step % 5003), i);
        assert_int_equal(id_map_find(&map, 9), UINT64_MAX);
        assert_int_equal(id_map_find(&map, 0), UINT64_MAX);
        assert_int_equal(id_map_find(&map, 10 + 5003), UINT64_MAX);
        assert_int_equal(id_map_find(&map, UINT64_MAX), UINT64_MAX);
        assert_int_equal(id_map_add(&map, 10 + 77 * step % 5003), ST_OK);
        assert_false(id_map_seal(&map, &twice));
        assert_int_equal(twice, 10 + 77 * step % 5003);
        id_map_release(&map);
    }
    id_map ends = {.m = &m};
    assert_int_equal(id_map_find(&ends, 0), UINT64_MAX);
    assert_int_equal(id_map_add(&ends, UINT64_MAX), ST_OK);
    assert_int_equal(id_map_add(&ends, 0), ST_OK);
    assert_true(id_map_seal(&ends, &twice));
    assert_int_equal(id_map_find(&ends, UINT64_MAX), 0);
    assert_int_equal(id_map_find(&ends, 0), 1);
    id_map_release(&ends);
    assert_int_equal(mem_used(&m), 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_variants), cmocka_unit_test(test_refused_hints),
        cmocka_unit_test(test_steps),    cmocka_unit_test(test_sweeps),
        cmocka_unit_test(test_refused),  cmocka_unit_test(test_left_out),
        cmocka_unit_test(test_id_map),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
