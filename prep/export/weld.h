/* weld.h - one number for each vertex of all pieces, however many have it.
 *
 * The first piece that has a vertex owns it. Numbers are in the order of the output: pieces
 * in order, of each first those of its own that others could have, then those that none can. Which
 * shares are the same is found by sorting their keys, within the budget: in scratch files beside
 * the output where memory does not suffice.
 *
 * Held all the time: 24 bytes a piece, a bit for each share.
 */
#ifndef PREP_EXPORT_WELD_H
#define PREP_EXPORT_WELD_H

#include "formats/base/pool.h"
#include "prep/export/piece.h"

typedef struct weld weld;

/* weld_create() - beside: the path beside which scratch files may be, kept by reference. */
CHECKED status weld_create(mem *m, pool *workers, const char *beside, uint32_t pieces, weld **out);
void weld_destroy(weld *w); /* NULL is fine */

/* weld_add() - the next piece: how many vertices it has, and the keys of those that it shares. */
CHECKED status weld_add(weld *w, uint32_t vertices, const hash_id *keys, uint32_t shares);

/* weld_end() - all pieces have been added. Until it returns, it takes up to what m's limit leaves,
 * less `spare` bytes. */
CHECKED status weld_end(weld *w, uint64_t spare);

/* weld_vertices() - of all pieces, each once. weld_first() - the number of the first one that a
 * piece owns. */
uint64_t weld_vertices(const weld *w);
uint64_t weld_first(const weld *w, uint32_t index);

/* weld_knows() - whether a piece that was made again has as many vertices and shares as before: the
 * functions below take no other. */
bool weld_knows(const weld *w, uint32_t index, const piece *p);

/* weld_owned() - the vertices that piece `index` owns, in the order of their numbers; returns how
 * many. order: room for its vertices. Thread-safe. */
uint32_t weld_owned(const weld *w, uint32_t index, const piece *p, uint32_t *order);

/* weld_numbers() - the number of each of its vertices; scratch: room for as many. Thread-safe. */
CHECKED status weld_numbers(const weld *w, uint32_t index, const piece *p, uint64_t *numbers,
                            uint64_t *scratch);

#endif
