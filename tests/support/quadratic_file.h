/* quadratic_file.h - files of quadratic tets: of quadratic_lab.h, as mesh streams. Trouble fails
 * the running test.
 */
#ifndef TESTS_SUPPORT_QUADRATIC_FILE_H
#define TESTS_SUPPORT_QUADRATIC_FILE_H

#include "tests/support/quadratic_lab.h"

/* quadratic_file_write() - all cells of a lab, and `hexahedra` cubes beside them, each of nodes of
 * its own. */
enum { QUADRATIC_FILE_HEXAHEDRA_MAX = 64 };
void quadratic_file_write(const quadratic_lab *s, int hexahedra, const char *path);

#endif
