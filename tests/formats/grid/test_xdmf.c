/* test_xdmf.c - grids of XDMF over raw samples: steps and fields; cut and damaged files; faults.
 * What they hold, and HDF5, is in tests/cli/xdmf.sh.
 */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdio.h>
#include <string.h>

#include "tests/support/scratch.h"
#include "tests/support/volumes.h"

#define GRID(more, name)                                                                        \
    "<Grid>" more "<Topology TopologyType='3DCoRectMesh' Dimensions='2 3 4'/>\n"                \
    "<Geometry GeometryType='ORIGIN_DXDYDZ'><DataItem>3 2 1</DataItem>\n"                       \
    "<DataItem>1 0.5 2</DataItem></Geometry>\n"                                                 \
    "<Attribute Name='" name "'><DataItem Format='Binary' Dimensions='2 3 4' NumberType='Int' " \
    "Precision='2' Endian='Big'>s.raw</DataItem></Attribute></Grid>\n"
#define XDMF(grids)   "<Xdmf><Domain>" grids "</Domain></Xdmf>\n"
#define SERIES(grids) XDMF("<Grid GridType='Collection' CollectionType='Temporal'>" grids "</Grid>")

static const double place[3][4] = {{2, 0, 0, 1}, {0, 0.5, 0, 2}, {0, 0, 1, 3}};

static void write_samples(void) {
    double samples[VOLUMES_SAMPLES];
    scratch_write("s.raw", samples, volumes_samples(SAMPLE_I16, true, samples));
}

static void test_read(void **state) {
    (void)state;
    write_samples();
    volumes_check(scratch_text("a.xdmf", XDMF(GRID("", "a"))), NULL, SAMPLE_I16, place);
    const char *path = scratch_text(
        "a.xdmf", SERIES(GRID("<Time Value='1'/>", "a") GRID("<Time Value='2'/>", "b")));
    volumes_check(path, &(volume_hints){.field = "a"}, SAMPLE_I16, place);
    volumes_check(path, &(volume_hints){.field = "b", .step = 1}, SAMPLE_I16, place);
    volumes_refused(path, &(volume_hints){.field = "b"}, ST_USAGE, "it has \"a\"");
    volumes_refused(path, &(volume_hints){.step = 2}, ST_USAGE, "no step 2: there are 2");
}

static void test_sweeps(void **state) {
    (void)state;
    static const char *const texts[] = {
        XDMF(GRID("", "a")),
        SERIES("<Time TimeType='List'><DataItem Dimensions='1'>7</DataItem></Time>" GRID("", "a")),
        XDMF(
            "<Grid><Topology TopologyType='3DRectMesh' Dimensions='2 3 4'/><Geometry Type='VXVYVZ'>"
            "<DataItem>1 2 4 5</DataItem><DataItem>3 2 1</DataItem><DataItem>0 9</DataItem>"
            "</Geometry><Attribute Name='a'><DataItem Format='Binary' Dimensions='2 3 4' "
            "NumberType='Int' Precision='2'>s.raw</DataItem></Attribute></Grid>"),
    };
    write_samples();
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        const char *path = scratch_text("a.xdmf", texts[i]);
        volumes_faults(path, NULL);
        volumes_damage(path, NULL);
        volumes_truncate(path, NULL, 1);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_read),
        cmocka_unit_test(test_sweeps),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
