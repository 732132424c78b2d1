/* implied_payload.h - payloads of grids that follow from the directory: empty space costs no bytes.
 *
 * If all samples of a treelet, halo included, are one value, or all are NaN, the file stores no
 * payload for it. Readers get the bytes that would be there (FORMAT.md 4).
 */
#ifndef FORMATS_LEAF_IMPLIED_PAYLOAD_H
#define FORMATS_LEAF_IMPLIED_PAYLOAD_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/leaf/leaf_layout.h"

/* implied_payload_may() - whether a treelet with this own range and these flags can have an implied
 * payload. */
bool implied_payload_may(const float own[2], uint8_t flags);

/* implied_payload_is() - whether this payload of treelet t is implied. */
bool implied_payload_is(const leaf_layout *l, uint32_t t, const float own[2], uint8_t flags,
                        const void *payload);

/* implied_payload_fill() - write the implied payload: leaf_layout_payload(t).bytes. */
void implied_payload_fill(const leaf_layout *l, uint32_t t, const float own[2], void *payload);

#endif
