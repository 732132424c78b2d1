#include "formats/mesh/mesh_corner_coder.h"

#include <string.h>

#include "formats/leaf/float_planes.h"

size_t mesh_corners_room(const mesh_shape *s) {
    return (size_t)s->tets * 4 + (size_t)s->vertices * sizeof(float[3]) +
           (size_t)s->tets * 4 * sizeof(uint16_t);
}

size_t mesh_corners_scratch(const mesh_shape *s) {
    return (size_t)s->vertices + (size_t)s->tets * 4;
}

/* ---- the list of recent vertices ----
 *
 * The latest vertex is the array's last, so that taking vertices out moves only those in front of
 * the farthest one. A vertex behind MESH_RECENT is never reached again, and is dropped only when
 * the array is full. */

enum { ROOM = 2048, EIGHT = 8 };

typedef struct recent {
    uint32_t count;
    uint16_t at[ROOM];
} recent;

static inline uint32_t recent_length(const recent *r) {
    return r->count < MESH_RECENT ? r->count : MESH_RECENT;
}

/* Copy vertices eight at a time: at least one eight, so up to 8 too many. */
static inline void copy_eights(uint16_t *to, const uint16_t *from, uint32_t count) {
    uint32_t i = 0;
    do {
        memcpy(to + i, from + i, EIGHT * sizeof to[0]);
        i += EIGHT;
    } while (i < count);
}

/* Take out the vertices at `known` places, ascending and counted from 1, and append the tet's four.
 * Copy the runs between these places from `old`: copy_eights() writes up to 8 vertices too many,
 * and would overwrite some that have not moved yet. */
static inline void recent_use(recent *r, const uint32_t place[4], uint32_t known,
                              const uint16_t vertex[4]) {
    uint16_t old[MESH_RECENT + EIGHT];
    const uint32_t most = known ? place[known - 1] : 0;
    uint32_t to = r->count - most;
    if (known)
        copy_eights(old, r->at + to, most);
    for (uint32_t k = known; k-- > 0;) {
        const uint32_t from = most - place[k] + 1, end = most - (k ? place[k - 1] : 0);
        copy_eights(r->at + to, old + from, end - from);
        to += end - from;
    }
    for (int k = 3; k >= 0; k--)
        r->at[to++] = vertex[k];
    r->count = to;
    if (r->count > ROOM - 4 - EIGHT) {
        memmove(r->at, r->at + r->count - MESH_RECENT, MESH_RECENT * sizeof r->at[0]);
        r->count = MESH_RECENT;
    }
}

/* ---- words: a vertex as its distance from another ---- */

static inline uint16_t word_of(uint16_t vertex, uint16_t base) {
    const uint16_t d = (uint16_t)(vertex - base);
    return (uint16_t)((uint16_t)(d << 1) ^ (0 - (d >> 15)));
}

static inline uint16_t word_vertex(uint16_t word, uint16_t base) {
    return (uint16_t)(base + ((word >> 1) ^ (0 - (word & 1))));
}

/* ---- encoding ---- */

/* What a vertex is: not used yet; used; of the tet at hand, and not found in the list yet. */
enum { NEW, USED, WANTED };

typedef struct encoder {
    const mesh_shape *s;
    const float (*positions)[3];
    recent list;
    uint8_t *code[4];    /* of each corner */
    uint8_t *planes;     /* of positions */
    uint8_t *low, *high; /* of words */
    uint8_t *state;      /* of each vertex */
    uint32_t words, told;
    uint16_t last; /* the vertex told last */
} encoder;

static void put_position(encoder *e, uint16_t vertex, uint16_t base) {
    const size_t stride = (size_t)e->s->vertices * 3;
    for (size_t a = 0; a < 3; a++) {
        uint32_t bits, predicted = 0;
        memcpy(&bits, &e->positions[vertex][a], sizeof bits);
        if (e->told)
            memcpy(&predicted, &e->positions[base][a], sizeof predicted);
        float_planes_put(e->planes + a * e->s->vertices + e->told, stride, bits, predicted);
    }
    e->told++;
    e->state[vertex] = USED;
    e->last = vertex;
}

static void put_word(encoder *e, uint16_t vertex, uint16_t base) {
    const uint16_t word = word_of(vertex, base);
    e->low[e->words] = (uint8_t)word;
    e->high[e->words++] = (uint8_t)(word >> 8);
}

/* A tet's corners in the order in which they are coded. */
typedef struct corners {
    uint16_t vertex[4];
    uint32_t place[4]; /* of the first `known`, counted from 1 */
    uint32_t known, far;
} corners;

/* Find those of `wanted` vertices that are in the list, by place. They are WANTED before, USED
 * then. */
static void find_known(encoder *e, uint32_t wanted, corners *c) {
    const uint16_t *end = e->list.at + e->list.count;
    const uint32_t length = recent_length(&e->list);
    for (uint32_t place = 1; place <= length && c->known < wanted; place++) {
        const uint16_t vertex = end[-(int)place];
        if (e->state[vertex] != WANTED)
            continue;
        e->state[vertex] = USED;
        c->place[c->known] = place;
        c->vertex[c->known++] = vertex;
    }
}

/* Sort a tet's corners: of the list by place; others that have been used; new ones. */
static corners sort_corners(encoder *e, const uint16_t tet[4]) {
    corners c = {.known = 0};
    uint32_t wanted = 0;
    for (int k = 0; k < 4; k++)
        if (e->state[tet[k]] == USED) {
            e->state[tet[k]] = WANTED;
            wanted++;
        }
    find_known(e, wanted, &c);
    uint32_t far = c.known, fresh = wanted;
    for (int k = 0; k < 4; k++)
        if (e->state[tet[k]] == WANTED) {
            e->state[tet[k]] = USED;
            c.vertex[far++] = tet[k];
        } else if (e->state[tet[k]] == NEW) {
            c.vertex[fresh++] = tet[k];
        }
    c.far = far - c.known;
    return c;
}

static void encode_tet(encoder *e, uint32_t t, const uint16_t tet[4]) {
    const corners c = sort_corners(e, tet);
    /* Say where in the list the first corners are, each by its distance from the one before. */
    for (uint32_t k = 0, place = 0; k < c.known; place = c.place[k++])
        e->code[k][t] = (uint8_t)(c.place[k] - place);
    /* Say which vertices the others are. Tell those that are new with their positions. */
    for (uint32_t k = c.known; k < 4; k++) {
        const uint16_t base = k ? c.vertex[0] : e->last;
        const bool is_far = k < c.known + c.far;
        e->code[k][t] = is_far ? MESH_CORNER_FAR : MESH_CORNER_NEW;
        put_word(e, c.vertex[k], base);
        if (!is_far)
            put_position(e, c.vertex[k], base);
    }
    recent_use(&e->list, c.place, c.known, c.vertex);
}

static bool are_sound(const mesh_shape *s, const uint16_t (*tets)[4]) {
    for (uint32_t t = 0; t < s->tets; t++)
        if (tets[t][0] >= tets[t][1] || tets[t][1] >= tets[t][2] || tets[t][2] >= tets[t][3] ||
            tets[t][3] >= s->vertices)
            return false;
    return true;
}

static encoder begin_encoding(const mesh_shape *s, const void *topology, uint8_t *scratch,
                              coded_streams *out) {
    encoder e = {.s = s, .positions = mesh_leaf_positions(s, topology)};
    for (int k = 0; k < 4; k++) {
        e.code[k] = coded_streams_take(out, s->tets);
        if (k >= 2)
            coded_streams_end(out);
    }
    e.planes = coded_streams_take(out, 0);
    for (int b = 0; b < FLOAT_PLANES; b++) {
        (void)coded_streams_take(out, (size_t)s->vertices * 3);
        coded_streams_end(out);
    }
    e.low = coded_streams_take(out, 0);
    e.state = scratch;
    e.high = scratch + s->vertices;
    memset(e.state, NEW, s->vertices);
    return e;
}

bool mesh_corners_encode(const mesh_shape *s, const void *topology, uint8_t *scratch,
                         coded_streams *out) {
    const uint16_t(*tets)[4] = mesh_leaf_tets(s, topology);
    if (!are_sound(s, tets))
        return false;
    encoder e = begin_encoding(s, topology, scratch, out);
    for (uint32_t t = 0; t < s->tets; t++)
        encode_tet(&e, t, tets[t]);
    (void)coded_streams_take(out, e.words);
    coded_streams_end(out);
    memcpy(coded_streams_take(out, e.words), e.high, e.words);
    coded_streams_end(out);
    return e.told == s->vertices;
}

/* ---- decoding ---- */

typedef struct decoder {
    const mesh_shape *s;
    float (*positions)[3];
    const uint8_t *code[4], *planes, *low, *high;
    size_t words;  /* that are left */
    uint32_t told; /* vertices */
    uint16_t last; /* the vertex told last */
    recent list;
} decoder;

static inline void order(uint16_t *a, uint16_t *b) {
    const uint16_t low = *a < *b ? *a : *b, high = *a < *b ? *b : *a;
    *a = low;
    *b = high;
}

static inline void place_tet(uint16_t to[4], const uint16_t vertex[4]) {
    memcpy(to, vertex, sizeof(uint16_t[4]));
    order(&to[0], &to[1]);
    order(&to[2], &to[3]);
    order(&to[0], &to[2]);
    order(&to[1], &to[3]);
    order(&to[1], &to[2]);
}

static inline void get_position(decoder *d, uint16_t vertex, uint16_t base) {
    const size_t stride = (size_t)d->s->vertices * 3;
    for (size_t a = 0; a < 3; a++) {
        uint32_t bits;
        memcpy(&bits, &d->positions[base][a], sizeof bits);
        bits = float_planes_get(d->planes + a * d->s->vertices + d->told, stride, bits);
        memcpy(&d->positions[vertex][a], &bits, sizeof bits);
    }
    d->told++;
    d->last = vertex;
}

/* Take the vertex of a corner that is not in the list, and its position if it is new. Returns false
 * if there is none. */
static inline bool get_other(decoder *d, uint8_t code, uint16_t base, uint16_t *vertex) {
    if (!d->words)
        return false;
    d->words--;
    *vertex = word_vertex((uint16_t)(*d->low++ | *d->high++ << 8), base);
    if (*vertex >= d->s->vertices)
        return false;
    if (code == MESH_CORNER_FAR)
        return true;
    if (code != MESH_CORNER_NEW || d->told == d->s->vertices)
        return false;
    get_position(d, *vertex, base);
    return true;
}

static inline bool decode_tet(decoder *d, uint32_t t, uint16_t tet[4]) {
    const uint32_t length = recent_length(&d->list);
    uint32_t known = 0, at = 0, place[4];
    uint16_t vertex[4];
    /* Find the corners that are in the list. Places ascend, so none is there twice. */
    for (; known < 4; known++) {
        const uint8_t code = d->code[known][t];
        if (code == MESH_CORNER_NEW || code == MESH_CORNER_FAR)
            break;
        at += code;
        if (at > length)
            return false;
        place[known] = at;
        vertex[known] = d->list.at[d->list.count - at];
    }
    /* Take the others from words. */
    for (uint32_t k = known; k < 4; k++)
        if (!get_other(d, d->code[k][t], k ? vertex[0] : d->last, &vertex[k]))
            return false;
    recent_use(&d->list, place, known, vertex);
    place_tet(tet, vertex);
    return true;
}

/* Find the parts. All that is left behind the positions is words. */
static bool begin_decoding(const mesh_shape *s, coded_input *in, void *topology, decoder *d) {
    d->s = s;
    d->positions = (float(*)[3])((char *)topology + s->positions_at);
    d->list.count = 0;
    d->told = d->last = 0;
    for (int k = 0; k < 4; k++)
        d->code[k] = coded_input_take(in, s->tets);
    d->planes = coded_input_take(in, s->vertices * sizeof(float[3]));
    if (!d->code[3] || !d->planes || in->left % 2)
        return false;
    d->words = in->left / 2;
    d->low = coded_input_take(in, d->words);
    d->high = coded_input_take(in, d->words);
    return true;
}

bool mesh_corners_decode(const mesh_shape *s, coded_input *in, void *topology) {
    uint16_t(*tets)[4] = (uint16_t(*)[4])((char *)topology + s->tets_at);
    decoder d;
    if (!begin_decoding(s, in, topology, &d))
        return false;
    for (uint32_t t = 0; t < s->tets; t++)
        if (!decode_tet(&d, t, tets[t]))
            return false;
    return d.told == s->vertices && d.words == 0;
}
