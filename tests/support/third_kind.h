/* third_kind.h - the tables of kinds with one more row, for a program of its own: a program has its
 * own tables instead of the library's where it defines these three functions. All rows of the
 * library's are in them, too.
 */
#ifndef TESTS_SUPPORT_THIRD_KIND_H
#define TESTS_SUPPORT_THIRD_KIND_H

#include "formats/leaf/curvilinear_geometry.h"
#include "formats/leaf/grid_geometry.h"
#include "formats/leaf/mesh_geometry.h"
#include "formats/leaf/mixed_geometry.h"
#include "formats/leaf/triangle_geometry.h"
#include "render/curvilinear/curvilinear_kind.h"
#include "render/grid/grid_kind.h"
#include "render/heights/heights_kind.h"
#include "render/mesh/mesh_kind.h"
#include "render/mixed/mixed_kind.h"
#include "render/triangle/triangle_kind.h"
#include "stream/cell_resident.h"
#include "stream/curvilinear_resident.h"
#include "stream/grid_resident.h"
#include "stream/mesh_resident.h"
#include "stream/mixed_resident.h"
#include "stream/triangle_resident.h"

/* Define the tables with a row for one more kind of records (leaf_cells.h). number_: any above
 * LEAF_KIND_HEIGHTS; programs do not see each other's. */
#define THIRD_KIND(number_, geometry_, kind_)                                                   \
    const leaf_geometry *leaf_geometry_of(uint32_t number) {                                    \
        static const leaf_geometry *const rows[] = {[LEAF_KIND_GRID] = &grid_geometry,          \
                                                    [LEAF_KIND_MESH] = &mesh_geometry,          \
                                                    [LEAF_KIND_CURVILINEAR] =                   \
                                                        &curvilinear_geometry,                  \
                                                    [LEAF_KIND_MIXED] = &mixed_geometry,        \
                                                    [LEAF_KIND_TRIANGLES] = &triangle_geometry, \
                                                    [LEAF_KIND_HEIGHTS] = &grid_geometry,       \
                                                    [number_] = &geometry_};                    \
        return number < sizeof rows / sizeof *rows ? rows[number] : NULL;                       \
    }                                                                                           \
    const resident_kind *resident_kind_of(const leaf_file *f) {                                 \
        static const resident_kind *const rows[] = {[LEAF_KIND_GRID] = &grid_resident,          \
                                                    [LEAF_KIND_MESH] = &mesh_resident,          \
                                                    [LEAF_KIND_CURVILINEAR] =                   \
                                                        &curvilinear_resident,                  \
                                                    [LEAF_KIND_MIXED] = &mixed_resident,        \
                                                    [LEAF_KIND_TRIANGLES] = &triangle_resident, \
                                                    [LEAF_KIND_HEIGHTS] = &grid_resident,       \
                                                    [number_] = &cell_resident};                \
        return rows[f->header.kind];                                                            \
    }                                                                                           \
    const kind *kind_of(const leaf_file *f) {                                                   \
        static const kind *const rows[] = {[LEAF_KIND_GRID] = &grid_kind,                       \
                                           [LEAF_KIND_MESH] = &mesh_kind,                       \
                                           [LEAF_KIND_CURVILINEAR] = &curvilinear_kind,         \
                                           [LEAF_KIND_MIXED] = &mixed_kind,                     \
                                           [LEAF_KIND_TRIANGLES] = &triangle_kind,              \
                                           [LEAF_KIND_HEIGHTS] = &heights_kind,                 \
                                           [number_] = &kind_};                                 \
        return rows[f->header.kind];                                                            \
    }

#endif
