/* loaded.h - loads payloads one at a time, with an unpacker for each. */
#ifndef TESTS_SUPPORT_LOADED_H
#define TESTS_SUPPORT_LOADED_H

#include "formats/leaf/leaf_unpacker.h"

/* payload: leaf_layout_payload_bytes(p) bytes, aligned to 64. */
static inline status loaded(leaf_file *f, uint32_t p, void *payload) {
    leaf_unpacker *u = NULL;
    status st = leaf_unpacker_create(f->m, f, &u);
    if (st == ST_OK)
        st = leaf_file_load(f, p, u, payload);
    leaf_unpacker_destroy(u);
    return st;
}

#endif
