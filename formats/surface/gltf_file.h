/* gltf_file.h - the triangles of a glTF 2.0 file: where their arrays lie, and how they are placed.
 *
 * The meshes of the default scene, each as often as a node places it. Without a scene: those of all
 * nodes that are no one's children. Skins, morph targets and materials are ignored. ST_UNSUPPORTED
 * by name: sparse accessors, required extensions that change how geometry is stored (Draco,
 * meshopt, quantization), buffers of a .glb outside the file, and buffers as data: URIs.
 */
#ifndef FORMATS_SURFACE_GLTF_FILE_H
#define FORMATS_SURFACE_GLTF_FILE_H

#include "formats/mesh/mesh_reader.h"

typedef enum gltf_type { GLTF_I8, GLTF_U8, GLTF_I16, GLTF_U16, GLTF_U32, GLTF_F32 } gltf_type;

/* An accessor, checked against the size of its file. */
typedef struct gltf_array {
    const char *path; /* NULL: there is no such array */
    uint64_t at;      /* byte of the file */
    uint64_t count;
    uint32_t stride, components;
    gltf_type type;
} gltf_array;

typedef enum gltf_mode { GLTF_TRIANGLES = 4, GLTF_STRIP = 5, GLTF_FAN = 6 } gltf_mode;

/* A primitive at one of its places. */
typedef struct gltf_part {
    gltf_array positions; /* 3 f32 */
    gltf_array normals;   /* 3 f32 */
    gltf_array colours;   /* 3 or 4 f32, u8 or u16 */
    gltf_array indices;   /* 1 u8, u16 or u32 */
    gltf_mode mode;
    double to[3][4]; /* to the world: rows */
    bool mirrored;   /* triangles turn the other way */
} gltf_part;

typedef struct gltf_file {
    mem *m;
    char **paths; /* of buffers that are files of their own */
    size_t path_count, path_room;
    gltf_part *parts;
    size_t count, room;
    uint64_t points; /* of all parts */
    uint64_t faces;
    uint64_t skipped; /* vertices and edges */
} gltf_file;

/* gltf_file_read() - read a .glb or .gltf. Release in any case. */
CHECKED status gltf_file_read(const mesh_source *source, gltf_file *out);
void gltf_file_release(gltf_file *f);

/* gltf_file_is_binary() - returns whether these are the first bytes of a .glb. */
bool gltf_file_is_binary(const uint8_t *start, size_t size);

/* gltf_file_width() - returns the bytes of a number. */
uint32_t gltf_file_width(gltf_type type);

#endif
