/* export_pieces.h - how the verb export writes pieces, of whatever kind they are. */
#ifndef PREP_EXPORT_EXPORT_PIECES_H
#define PREP_EXPORT_EXPORT_PIECES_H

#include "prep/export/export_request.h"
#include "prep/export/piece.h"

/* export_pieces_threads() - reduce the threads until their needs take at most half of the free
 * budget. each: bytes that one needs.
 * export_pieces_write() - write a source's pieces to the output. */
int export_pieces_threads(const export_request *a, const mem *m, uint64_t each);
CHECKED status export_pieces_write(export_request *a, mem *m, const piece_source *source,
                                   int threads, piece_info *info);

#endif
