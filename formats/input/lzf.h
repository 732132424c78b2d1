/* lzf.h - unpack LZF: literal bytes, and references to bytes that are out already.
 *
 * The stream has no head. Each item begins with a control byte c:
 *
 * - c < 32: c + 1 literal bytes follow.
 * - c >= 32: copy bytes that are out already. Their number is (c >> 5) + 2; where c >> 5 is 7, the
 *   next byte is added. The first lies 1 + 256 (c & 31) + b before the end, b being the byte that
 *   follows. The copy may overlap with its source.
 */
#ifndef FORMATS_INPUT_LZF_H
#define FORMATS_INPUT_LZF_H

#include <stddef.h>

/* lzf_size() - find the size of an unpacked stream: at most 88 times its own. Returns NULL, or a
 * static text that says why it is no LZF. Nothing is written. */
const char *lzf_size(const void *packed, size_t size, size_t *unpacked);

/* lzf_unpack() - unpack a stream that lzf_size() has measured, into as many bytes. */
void lzf_unpack(const void *packed, size_t size, void *to);

#endif
