/* weld.h - gives each vertex of all pieces one number, however many pieces have it.
 *
 * The first piece that has a vertex owns it. Numbers follow the output: piece by piece, and in each
 * piece first the vertices it owns that other pieces could have (shares), then the others. Equal
 * shares are found by sorting their keys. If memory does not suffice, they are sorted in scratch
 * files beside the output.
 *
 * Permanent memory: 24 bytes per piece, a bit per share.
 */
#ifndef PREP_EXPORT_WELD_H
#define PREP_EXPORT_WELD_H

#include "formats/base/pool.h"
#include "prep/export/piece.h"

typedef struct weld weld;

/* weld_create() - beside: path beside which scratch files may lie; kept by reference. */
CHECKED status weld_create(mem *m, pool *workers, const char *beside, uint32_t pieces, weld **out);
void weld_destroy(weld *w); /* NULL is fine */

/* weld_add() - add the next piece: its number of vertices, and the keys of its shared vertices. */
CHECKED status weld_add(weld *w, uint32_t vertices, const hash_id *keys, uint32_t shares);

/* weld_end() - call it when all pieces have been added. While it runs, it takes up to what m's
 * limit leaves, less `spare` bytes. */
CHECKED status weld_end(weld *w, uint64_t spare);

/* weld_vertices() - vertices of all pieces, each counted once. weld_first() - number of the first
 * vertex that a piece owns. */
uint64_t weld_vertices(const weld *w);
uint64_t weld_first(const weld *w, uint32_t index);

/* weld_knows() - returns whether a piece that was made again has as many vertices and shares as
 * when it was added. Check it before calling the functions below. */
bool weld_knows(const weld *w, uint32_t index, const piece *p);

/* weld_owned() - write the vertices that piece `index` owns, in the order of their numbers. Returns
 * how many. order: room for all its vertices. Thread-safe. */
uint32_t weld_owned(const weld *w, uint32_t index, const piece *p, uint32_t *order);

/* weld_numbers() - write the number of each of the piece's vertices. scratch: room for as many.
 * Thread-safe. */
CHECKED status weld_numbers(const weld *w, uint32_t index, const piece *p, uint64_t *numbers,
                            uint64_t *scratch);

#endif
