/* leaf_shells.h - decoded shells of families (grid_family.h), kept for several threads that load
 * treelets of one file: siblings are seldom loaded together, and each needs it.
 *
 * A shell in use stays. Of the others, the one not needed for longest makes room.
 */
#ifndef FORMATS_LEAF_LEAF_SHELLS_H
#define FORMATS_LEAF_LEAF_SHELLS_H

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/leaf/leaf_layout.h"

typedef struct leaf_shells leaf_shells;

/* leaf_shells_create() - room for shells of this layout, for so many threads at a time: as many as
 * fit into `bytes`, at least one for each thread. NULL: the layout has none. */
CHECKED status leaf_shells_create(mem *m, const leaf_layout *l, int threads, size_t bytes,
                                  leaf_shells **out);
void leaf_shells_destroy(leaf_shells *s); /* NULL is fine */

/* leaf_shells_memory() - the bytes that leaf_shells_create() takes. */
size_t leaf_shells_memory(const leaf_layout *l, int threads, size_t bytes);

/* leaf_shells_hold() - hold the shell that is payload p; wait while another thread decodes it.
 * Returns true if *samples are decoded. If false, the caller must decode into *samples.
 * leaf_shells_release() - let go. made: whether *samples are valid; if not, the next holder decodes
 * them. */
bool leaf_shells_hold(leaf_shells *s, uint32_t p, void **samples);
void leaf_shells_release(leaf_shells *s, uint32_t p, bool made);

/* leaf_shells_copy() - copy the shell that is payload p, if it is there, decoded. Returns whether
 * it was. The caller may hold another one. */
bool leaf_shells_copy(leaf_shells *s, uint32_t p, void *samples);

#endif
