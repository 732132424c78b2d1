/* tool_field.c - write a test field as NRRD, for script tests.
 *
 *   tool_field                        the names of all fields
 *   tool_field NAME N SEED OUT.nrrd   write one; prints the isovalue, and whether it is
 *                                     rectilinear, then with axis files OUT.nrrd.x, .y, .z
 */
#include <stdio.h>
#include <stdlib.h>

#include "tests/support/fields.h"

int main(int argc, char **argv) {
    if (argc == 1) {
        for (int i = 0; i < field_count(); i++)
            puts(field_name(i));
        return 0;
    }
    field f;
    if (argc != 5 || !field_make(&f, argv[1], atol(argv[2]), strtoull(argv[3], NULL, 10))) {
        fprintf(stderr, "tool_field: NAME N SEED OUT.nrrd, please\n");
        return 2;
    }
    bool good = field_write_nrrd(&f, argv[4]);
    printf("%.17g %s\n", f.iso, f.axis[0] ? "rectilinear" : "regular");
    field_release(&f);
    return good ? 0 : 1;
}
