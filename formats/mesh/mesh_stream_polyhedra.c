#include "formats/mesh/mesh_stream_polyhedra.h"

#include <endian.h>

#include "formats/mesh/mesh_polyhedron.h"
#include "formats/mesh/mesh_stream.h"

typedef struct reading {
    const mesh_stream_polyhedra *s;
    uint64_t at, numbers, middles; /* done: polyhedra, their numbers, their middles */
    uint32_t *words;               /* MESH_STREAM_POLYHEDRON_MAX, as they are in the file */
    uint64_t *stream;              /* the same */
    mesh_polyhedron_room room;
} reading;

static status wrong(const reading *x, const char *what) {
    return status_describe(ST_CORRUPT, "%s: polyhedron %llu (counted from 0) %s",
                           byte_stream_name(x->s->data), (unsigned long long)x->at, what);
}

static status read_words(reading *x, size_t count) {
    size_t got = 0;
    const status st = byte_stream_read(x->s->data, x->words, count * 4, &got);
    return st == ST_OK && got < count * 4
               ? status_describe(ST_CORRUPT,
                                 "%s: ends at byte %llu, inside polyhedron %llu (counted from 0)",
                                 byte_stream_name(x->s->data),
                                 (unsigned long long)byte_stream_position(x->s->data),
                                 (unsigned long long)x->at)
               : st;
}

static status next(reading *x, mesh_polyhedron *p) {
    const uint64_t left = x->s->numbers - x->numbers;
    if (left < 1)
        return wrong(x, "begins behind the numbers that the header tells of");
    status st = read_words(x, 1);
    if (st != ST_OK)
        return st;
    const size_t size = le32toh(x->words[0]);
    if (size < 1 || size >= MESH_STREAM_POLYHEDRON_MAX)
        return wrong(x, "has no numbers, or more than 65535");
    if (size > left - 1)
        return wrong(x, "ends behind the numbers that the header tells of");
    st = read_words(x, size);
    if (st != ST_OK)
        return st;
    for (size_t i = 0; i < size; i++)
        x->stream[i] = le32toh(x->words[i]);
    *p =
        (mesh_polyhedron){.faces = (size_t)x->stream[0], .stream = x->stream + 1, .size = size - 1};
    x->numbers += 1 + size;
    const char *fault = mesh_polyhedron_fault(p);
    return fault ? wrong(x, fault) : ST_OK;
}

static status feed_one(reading *x, const mesh_polyhedron *p, mesh_feed *feed) {
    const mesh_stream_polyhedra *s = x->s;
    const uint64_t middles = mesh_polyhedron_middles(p), first = s->points + x->middles;
    if (!mesh_polyhedron_inside(p, s->points)) {
        feed->report->bad_indices++;
        return ST_OK;
    }
    if (middles > s->middles - x->middles)
        return wrong(x, "adds more points than the header tells of");
    x->middles += middles;
    status st = mesh_polyhedron_reserve(&x->room, p);
    if (st == ST_OK)
        st = mesh_polyhedron_feed_middles(p, feed, s->fields, &x->room);
    return st == ST_OK ? mesh_polyhedron_feed(p, feed, 0, first) : st;
}

static status check_sums(const reading *x) {
    const mesh_stream_polyhedra *s = x->s;
    if (x->numbers == s->numbers && x->middles == s->middles)
        return ST_OK;
    return status_describe(
        ST_CORRUPT,
        "%s: its polyhedra have %llu numbers and add %llu points, expected %llu and %llu",
        byte_stream_name(s->data), (unsigned long long)x->numbers, (unsigned long long)x->middles,
        (unsigned long long)s->numbers, (unsigned long long)s->middles);
}

status mesh_stream_polyhedra_read(const mesh_stream_polyhedra *s, mesh_feed *feed) {
    reading x = {.s = s, .room = {.m = s->m}};
    status st = ST_OK;
    if (s->count > 0) {
        x.words = mem_array(s->m, MESH_STREAM_POLYHEDRON_MAX, sizeof *x.words);
        x.stream = mem_array(s->m, MESH_STREAM_POLYHEDRON_MAX, sizeof *x.stream);
        st = x.words && x.stream ? ST_OK : ST_NOMEM;
    }
    for (; x.at < s->count && st == ST_OK; x.at++) {
        mesh_polyhedron p;
        st = next(&x, &p);
        if (st == ST_OK)
            st = feed_one(&x, &p, feed);
    }
    mesh_polyhedron_release(&x.room);
    mem_free(s->m, x.words);
    mem_free(s->m, x.stream);
    return st == ST_OK ? check_sums(&x) : st;
}
