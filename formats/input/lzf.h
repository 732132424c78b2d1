/* lzf.h - what LZF packed: literal bytes, and references to bytes that are out already.
 *
 * The stream has no head. Each item begins with a control byte c:
 *
 * - c < 32: c + 1 literal bytes follow.
 * - c >= 32: bytes that are out already come again. Their number is (c >> 5) + 2, and where c >> 5
 *   is 7 the next byte more. The first lies 1 + 256 (c & 31) + the byte behind that before the end.
 *   They may overlap with what they become.
 */
#ifndef FORMATS_INPUT_LZF_H
#define FORMATS_INPUT_LZF_H

#include <stddef.h>

/* lzf_size() - how many bytes a stream is unpacked: at most 88 times its own. NULL, or why it is
 * none: a static text. Nothing is written. */
const char *lzf_size(const void *packed, size_t size, size_t *unpacked);

/* lzf_unpack() - a stream that lzf_size() has measured, into as many bytes. */
void lzf_unpack(const void *packed, size_t size, void *to);

#endif
