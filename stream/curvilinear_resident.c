#include "stream/curvilinear_resident.h"

#include "formats/leaf/curvilinear_geometry.h"

static curvilinear_lattice *lattice_of(resident_hexes *tr) {
    return &((resident_curvilinear *)tr)->lattice;
}

static size_t bytes(const leaf_file *f, uint32_t t) {
    return curvilinear_lattice_bytes(curvilinear_directory_of(f)->counts[t]);
}

static status make(resident_hexes *tr, mem *m, const hex_treelet *h) {
    const curvilinear_directory *d = curvilinear_directory_of(h->f);
    const float *const p[3] = {hex_treelet_coordinates(h, 0), hex_treelet_coordinates(h, 1),
                               hex_treelet_coordinates(h, 2)};
    const status st = curvilinear_lattice_init(lattice_of(tr), m, d->counts[h->id], p,
                                               (const uint8_t *)(h->places + 3 * (size_t)h->nodes));
    if (st == ST_OK)
        lattice_of(tr)->first = d->first[h->id];
    return st;
}

static void release(resident_hexes *tr) {
    curvilinear_lattice_release(lattice_of(tr));
}

static void move(resident_hexes *tr) {
    curvilinear_lattice_move(lattice_of(tr));
}

static void fill(resident_hexes *tr, const float *values) {
    curvilinear_lattice_fill(lattice_of(tr), values);
}

static void activate(resident_hexes *tr, const interest *in) {
    curvilinear_lattice_select(lattice_of(tr), in);
}

static const hex_blocks blocks = {
    sizeof(resident_curvilinear), bytes, make, release, move, fill, activate};

const resident_kind curvilinear_resident = {HEX_RESIDENT_FUNCTIONS, .hexes = &blocks};
