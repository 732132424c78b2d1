/* volumes.h - what the tests of all input formats share: small known samples, reading them back,
 * and the sweeps.
 */
#ifndef TESTS_SUPPORT_VOLUMES_H
#define TESTS_SUPPORT_VOLUMES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/grid/grid.h"
#include "formats/grid/volume.h"

/* The test volume: 4 x 3 x 2 samples. Sample n of a signed or real type is 7 n - 50, of another 7
 * n. */
enum { VOLUMES_NX = 4, VOLUMES_NY = 3, VOLUMES_NZ = 2, VOLUMES_SAMPLES = 24 };

/* volumes_samples() - its samples in a type and byte order; returns their bytes. out has room for
 * VOLUMES_SAMPLES doubles. */
size_t volumes_samples(sample_type type, bool big_endian, void *out);

/* volumes_text() - its samples as decimal numbers. out has room for 4 bytes a sample and a NUL. */
size_t volumes_text(sample_type type, char *out);

/* volumes_deflate() - compressed as gzip (or zlib), split into so many members; malloc'ed. */
uint8_t *volumes_deflate(const void *data, size_t size, bool gzip, int members, size_t *compressed);

/* volumes_file() - a file in the scratch folder of a header and the data behind it; returns its
 * path. */
const char *volumes_file(const char *name, const char *header, const void *data, size_t size);

/* volumes_read() - open, read slice by slice, finish, close: the status; the grid without axes.
 * samples has room for the test volume of any type; a larger one is refused with ST_FAILED. Fails
 * the test when memory is not given back. */
status volumes_read(const char *path, const volume_hints *hints, grid *g, void *samples);

/* volumes_check() - it is the test volume of this type; to_world is the given one (NULL: the
 * identity). */
void volumes_check(const char *path, const volume_hints *hints, sample_type type,
                   const double (*to_world)[4]);

/* volumes_refused() - opening or reading fails with this status, and the description holds `said`.
 */
void volumes_refused(const char *path, const volume_hints *hints, status st, const char *said);

/* volumes_truncate() - every prefix of a file gives an error, but for the last `spare` bytes. */
void volumes_truncate(const char *path, const volume_hints *hints, size_t spare);

/* volumes_damage() - with any byte changed, reading ends in an error or in a result; never in
 * anything else. Returns how many changes went unnoticed. */
size_t volumes_damage(const char *path, const volume_hints *hints);

/* volumes_faults() - with each allocation and each read failing in turn: an error, a description,
 * nothing leaked. */
void volumes_faults(const char *path, const volume_hints *hints);

#endif
