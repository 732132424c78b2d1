/* fixture.h - fields as treelet files in the scratch folder, opened. Trouble fails the running
 * test.
 */
#ifndef TESTS_SUPPORT_FIXTURE_H
#define TESTS_SUPPORT_FIXTURE_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/leaf/leaf_packer.h"
#include "render/leafcast_experimental.h"
#include "tests/support/fields.h"

/* fixture_leaf() - convert a field with treelets of 2^cells_log2 cells and deviations; the file's
 * path, which stays valid. fixture_leaf_of() - by other parameters. */
const char *fixture_leaf(const field *f, uint32_t cells_log2, uint32_t halo, bool compressed);
const char *fixture_leaf_of(const field *f, const leaf_parameters *how);

/* EXPERIMENTS() - a pointer to a leafcast_experiments with these members; it lives as long as the
 * block around it. INTERSECTOR() - to a leafcast_scene_experiments. */
#define EXPERIMENTS(...) \
    (&(leafcast_experiments){.size = sizeof(leafcast_experiments), __VA_ARGS__})
#define INTERSECTOR(how)                                                       \
    (&(leafcast_scene_experiments){.size = sizeof(leafcast_scene_experiments), \
                                   .intersector = (how)})

/* fixture_open() - options may be NULL. */
leafcast *fixture_open(const char *path, const leafcast_options *options);

#endif
