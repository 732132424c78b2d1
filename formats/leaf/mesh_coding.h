/* mesh_coding.h - compressed payloads of meshes (FORMAT.md 6): zstd frames of coded streams
 * (mesh_coder.h). */
#ifndef FORMATS_LEAF_MESH_CODING_H
#define FORMATS_LEAF_MESH_CODING_H

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/mesh/mesh_coder.h"

/* A compressor of one thread. */
typedef struct mesh_coding mesh_coding;

/* mesh_coding_create() - for payloads of treelets with up to so many tets, vertices, nodes and
 * leaves. level: of zstd.
 * mesh_coding_memory() - the bytes that it takes from a mem.
 * mesh_coding_outside() - and those that zstd takes elsewhere: right after mesh_coding_pack(). */
CHECKED status mesh_coding_create(mem *m, const uint32_t counts[4], int level, mesh_coding **out);
void mesh_coding_destroy(mesh_coding *c); /* NULL is fine */
size_t mesh_coding_memory(const uint32_t counts[4]);
size_t mesh_coding_outside(const mesh_coding *c);

/* mesh_coding_room() - the most bytes of the streams of any payload with these counts. */
size_t mesh_coding_room(const uint32_t counts[4]);

/* mesh_coding_pack() - compress a payload into pack, of mesh_coder_bytes() bytes. counts, bounds:
 * as for mesh_coder_encode(). Returns the bytes it takes; 0: it does not get smaller. */
size_t mesh_coding_pack(mesh_coding *c, mesh_block block, const uint32_t counts[4],
                        const float bounds[6], const void *payload, void *pack);

#endif
