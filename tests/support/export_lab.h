/* export_lab.h - surfaces of treelet files to the scratch file "surface", and what is asked of all
 * of them. Trouble fails the running test, but where a status is returned.
 */
#ifndef TESTS_SUPPORT_EXPORT_LAB_H
#define TESTS_SUPPORT_EXPORT_LAB_H

#include "prep/export/piece_export.h"
#include "tests/support/ply_surface.h"

/* How a surface is made. */
typedef struct export_how {
    const char *format;
    double isovalues[2];
    uint32_t count;
    int threads;
    size_t memory; /* beside the open file; 0: any */
    const uint32_t *box;
    uint32_t level;
} export_how;

/* export_lab_plain() - as PLY, one isovalue, two threads, any memory. */
export_how export_lab_plain(double isovalue);

/* export_lab_pieces() - all of a source to the scratch file. export_lab_try() - the surface of the
 * file `path`: of a grid, or of the first field of a mesh or of hexahedra. */
status export_lab_pieces(mem *m, const export_how *h, const piece_source *source, piece_info *info);
status export_lab_try(mem *m, const char *path, const export_how *h, piece_info *info);

/* export_lab_bytes() - its bytes; free them. export_lab_surface() - a PLY, read back. */
char *export_lab_bytes(const char *path, const export_how *h, size_t *size);
ply_surface export_lab_surface(const char *path, const export_how *h);

/* export_lab_array() - where the elements of an array begin in the bytes of a .vtp or .vtu, by its
 * name as it stands there. */
const char *export_lab_array(const char *bytes, const char *name);

/* export_lab_by_point() - for qsort(), of three doubles each. */
int export_lab_by_point(const void *a, const void *b);

/* export_lab_check_ball() - closed, in one piece, turned outwards, of the volume of a ball; normals
 * point away from `middle` on each axis but for 1 - cosine < tolerance. */
void export_lab_check_ball(const ply_surface *s, double middle, double radius, double tolerance);

/* export_lab_check_same() - the same bytes with other threads, and with so little memory. */
void export_lab_check_same(const char *path, double iso, const char *format, size_t little);

/* export_lab_malice() - the file `path` with a few bytes changed at random and its checksums made
 * right, so many times: each is exported or refused, in words, and gives all memory back. */
void export_lab_malice(const char *path, const export_how *h, uint64_t seed, int times);

#endif
