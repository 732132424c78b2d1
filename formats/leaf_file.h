/* leaf_file.h - open a treelet file: everything but the payloads, checked and in memory.
 *
 * After leaf_file_open() the header, the directory and every offset and size have been validated
 * against the file's length, so users need no checks of their own. Immutable afterwards: any thread
 * may read it. Payload bytes are checked by leaf_file_load().
 */
#ifndef FORMATS_LEAF_FILE_H
#define FORMATS_LEAF_FILE_H

#include <stdbool.h>

#include "formats/base/file.h"
#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/leaf.h"
#include "formats/leaf_layout.h"

typedef struct leaf_file {
    leaf_header header;
    leaf_layout layout;
    /* The directory, an element a treelet. */
    float (*ranges)[2]; /* merged */
    float (*own)[2];
    uint8_t *flags;
    uint64_t *offsets;
    uint64_t *sizes;
    uint64_t *checksums;
    /* Level-0 node coordinates in grid space, always there (0, 1, 2, ... for a regular grid). */
    double *axis[3];
    file *source;
    mem *m;
    uint64_t directory_bytes; /* in the file: header, section table, sections */
} leaf_file;

/* leaf_file_open() - ST_CORRUPT names file, byte and what was expected. */
CHECKED status leaf_file_open(mem *m, const char *path, leaf_file **out);
void leaf_file_close(leaf_file *f); /* NULL is fine */

/* leaf_file_is_raw() - whether treelet t's stored bytes are its payload as they are: always with
 * the raw codec, and with a compressed one for payloads that would not have got smaller. */
bool leaf_file_is_raw(const leaf_file *f, uint32_t t);

/* leaf_file_load() - read treelet t's stored bytes, check them, and decode into payload
 * (leaf_layout_payload(t).bytes; 64-byte aligned). stored: room for sizes[t] bytes; may be NULL
 * when leaf_file_is_raw(), bytes are then read straight into payload. ST_CORRUPT names file, byte
 * and treelet. Thread-safe. */
CHECKED status leaf_file_load(leaf_file *f, uint32_t t, void *stored, void *payload);

/* leaf_file_decode() - the same from bytes that are in memory already (a mapping): check, and
 * unless leaf_file_is_raw() decode into payload; *view becomes the payload (stored itself when
 * raw). Thread-safe. */
CHECKED status leaf_file_decode(const leaf_file *f, uint32_t t, const void *stored, void *payload,
                                const void **view);

#endif
