#include "formats/leaf/float_lattice.h"

#include <assert.h>
#include <string.h>

#include "formats/leaf/float_planes.h"

static const float outside[FLOAT_LATTICE_ROW];

/* The rows before one: on axis j, k, both. */
typedef struct rows {
    const float *j, *k, *jk;
} rows;

static rows rows_before(const float *row, const uint32_t nodes[3], uint32_t j, uint32_t k) {
    const size_t line = nodes[0], plane = line * nodes[1];
    return (rows){.j = j ? row - line : outside,
                  .k = k ? row - plane : outside,
                  .jk = j && k ? row - plane - line : outside};
}

/* The bits that predict node i of a row. */
static uint32_t predict(const rows *r, const float *row, uint32_t i) {
    const float before = i ? row[i - 1] : 0.0F;
    const float ij = i ? r->j[i - 1] : 0.0F, ik = i ? r->k[i - 1] : 0.0F,
                ijk = i ? r->jk[i - 1] : 0.0F;
    const float p = float_lattice_predict3(before, r->j[i], r->k[i], ij, ik, r->jk[i], ijk);
    return float_planes_predicted(p);
}

void float_lattice_encode(const float *floats, const uint32_t nodes[3], size_t stride,
                          uint8_t *planes) {
    const float *row = floats;
    assert(nodes[0] <= FLOAT_LATTICE_ROW);
    for (uint32_t k = 0; k < nodes[2]; k++)
        for (uint32_t j = 0; j < nodes[1]; j++, row += nodes[0]) {
            const rows before = rows_before(row, nodes, j, k);
            for (uint32_t i = 0; i < nodes[0]; i++) {
                uint32_t bits;
                memcpy(&bits, &row[i], sizeof bits);
                float_planes_put(planes++, stride, bits, predict(&before, row, i));
            }
        }
}

void float_lattice_decode(const uint8_t *planes, const uint32_t nodes[3], size_t stride,
                          float *floats) {
    float *row = floats;
    assert(nodes[0] <= FLOAT_LATTICE_ROW);
    for (uint32_t k = 0; k < nodes[2]; k++)
        for (uint32_t j = 0; j < nodes[1]; j++, row += nodes[0]) {
            const rows before = rows_before(row, nodes, j, k);
            for (uint32_t i = 0; i < nodes[0]; i++) {
                const uint32_t bits = float_planes_get(planes++, stride, predict(&before, row, i));
                memcpy(&row[i], &bits, sizeof bits);
            }
        }
}
