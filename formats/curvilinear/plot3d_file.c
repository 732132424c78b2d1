#include "formats/curvilinear/plot3d_file.h"

#include <stdio.h>
#include <string.h>

#include "formats/base/name_list.h"
#include "formats/base/sample.h"
#include "formats/input/binary_fields.h"

enum { BEHIND_MAX = 4095 }; /* bytes that fill a last disk block */

static const char *const contents[] = {"grid", "solution", "file of functions"};

/* ---- numbers ---- */

/* Read whole numbers or reals, all of a type, that lie side by side in the file. */
static status read_run(plot3d_file *p, uint64_t at, sample_type type, size_t count, void *to) {
    status st = file_read_at(p->f, at, to, count * sample_size(type));
    if (st == ST_OK && !(p->layout & PLOT3D_LITTLE) != (__BYTE_ORDER == __BIG_ENDIAN))
        sample_swap(type, to, count);
    return st;
}

/* Where numbers of a zone's nodes lie from node `first` on, and how many up to `most` side by side.
 * before: bytes that a node has before this number. */
static uint64_t find_run(const plot3d_file *p, uint32_t zone, uint64_t before, uint64_t width,
                         uint64_t first, size_t *most) {
    const plot3d_block *b = &p->blocks[zone];
    const uint64_t piece = first / b->nodes, node = first % b->nodes;
    const uint64_t mark = plot3d_layout_mark(p->layout);
    if (*most > b->nodes - node)
        *most = (size_t)(b->nodes - node);
    return b->at + piece * (b->bytes + 2 * mark) + mark + before * b->nodes + node * width;
}

/* Read reals that lie side by side in the file. */
static status read_reals(plot3d_file *p, uint64_t at, size_t count, double *out) {
    const sample_type type = plot3d_layout_width(p->layout) == 8 ? SAMPLE_F64 : SAMPLE_F32;
    if (p->text)
        return plot3d_text_read(p->text, at, count, out);
    const status st = read_run(p, at, type, count, p->buffer);
    if (st == ST_OK)
        sample_to_doubles(type, p->buffer, out, count);
    return st;
}

/* Read whole numbers; of text their signs. */
static status read_wholes(plot3d_file *p, uint64_t at, size_t count, int32_t *out) {
    if (!p->text)
        return read_run(p, at, SAMPLE_I32, count, out);
    double *reals = p->buffer;
    const status st = plot3d_text_read(p->text, at, count, reals);
    for (size_t i = 0; st == ST_OK && i < count; i++)
        out[i] = (reals[i] > 0) - (reals[i] < 0);
    return st;
}

status plot3d_file_read(plot3d_file *p, uint32_t zone, uint32_t number, uint64_t first,
                        size_t count, double *out) {
    const uint32_t width = plot3d_layout_width(p->layout);
    for (size_t done = 0, n; done < count; done += n) {
        n = count - done;
        const uint64_t at = find_run(p, zone, (uint64_t)number * width, width, first + done, &n);
        status st = read_reals(p, at, n, out + done);
        if (st != ST_OK)
            return st;
    }
    return ST_OK;
}

status plot3d_file_blanks(plot3d_file *p, uint32_t zone, uint64_t first, size_t count,
                          int32_t *out) {
    const uint64_t before = (uint64_t)p->numbers * plot3d_layout_width(p->layout);
    status st = ST_OK;
    for (size_t done = 0, n; st == ST_OK && done < count; done += n) {
        n = count - done;
        const uint64_t at =
            find_run(p, zone, before, plot3d_layout_blank(p->layout), first + done, &n);
        st = read_wholes(p, at, n, out + done);
    }
    return st;
}

status plot3d_file_conditions(plot3d_file *p, double out[PLOT3D_CONDITIONS]) {
    const uint32_t width = plot3d_layout_width(p->layout), mark = plot3d_layout_mark(p->layout);
    return read_reals(p, p->blocks[0].at - mark - PLOT3D_CONDITIONS * width, PLOT3D_CONDITIONS,
                      out);
}

/* ---- the layout ---- */

/* A file whose layout is looked for. */
typedef struct search {
    const char *path;
    plot3d_content content;
    const plot3d_words *words;
    const plot3d_file *grid; /* NULL: the file is the grid */
    unsigned text;           /* PLOT3D_TEXT: it is text; else 0 */
    plot3d_head heads[PLOT3D_LAYOUTS];
    uint32_t found;
    uint8_t start[PLOT3D_HEAD_MAX];
} search;

static bool fits_grid(const plot3d_head *h, const plot3d_file *grid) {
    bool same = h->zones == grid->zones;
    for (uint32_t z = 0; z < h->zones && same; z++) {
        uint32_t nodes[3];
        plot3d_head_nodes(h, z, nodes);
        same = memcmp(nodes, grid->nodes[z], sizeof nodes) == 0;
    }
    return same;
}

static void find_heads(search *s, size_t size, uint64_t bytes, uint64_t behind) {
    const uint32_t found =
        plot3d_head_find(s->content, s->words, s->text, s->start, size, bytes, behind, s->heads);
    s->found = 0;
    for (uint32_t i = 0; i < found; i++)
        if (!s->grid || fits_grid(&s->heads[i], s->grid))
            s->heads[s->found++] = s->heads[i];
}

/* Check that zeros lie behind the numbers. */
static status check_behind(file *f, uint64_t from, bool *zeros) {
    uint8_t bytes[BEHIND_MAX];
    const size_t size = (size_t)(file_size(f) - from);
    status st = file_read_at(f, from, bytes, size);
    *zeros = st == ST_OK;
    for (size_t i = 0; i < size && *zeros; i++)
        *zeros = bytes[i] == 0;
    return st;
}

static status find_padded(search *s, size_t size, file *f) {
    find_heads(s, size, file_size(f), BEHIND_MAX);
    uint32_t kept = 0;
    for (uint32_t i = 0; i < s->found; i++) {
        bool zeros;
        status st = check_behind(f, s->heads[i].length, &zeros);
        if (st != ST_OK)
            return st;
        if (zeros)
            s->heads[kept++] = s->heads[i];
    }
    s->found = kept;
    return ST_OK;
}

static status refuse_none(const search *s, const plot3d_file *p) {
    char of[160] = "";
    const uint32_t *n = s->grid ? s->grid->nodes[0] : NULL;
    if (n)
        snprintf(of, sizeof of, " of the grid's %u zone%s, the first with %u x %u x %u nodes",
                 s->grid->zones, s->grid->zones > 1 ? "s" : "", n[0], n[1], n[2]);
    if (p->text)
        return status_describe(ST_CORRUPT,
                               "%s: expected a PLOT3D %s%s: its first numbers and how many it has, "
                               "%llu, fit no layout%s of text",
                               s->path, contents[s->content], of,
                               (unsigned long long)plot3d_text_count(p->text),
                               s->words->said ? " of those words" : "");
    return status_describe(
        ST_CORRUPT,
        "%s: expected a PLOT3D %s%s: its first bytes and its size of %llu bytes fit no layout%s "
        "(C binary or Fortran records of 4-byte marks; big or little endian; f32 or f64)",
        s->path, contents[s->content], of, (unsigned long long)file_size(p->f),
        s->words->said ? " of those words" : "");
}

static status refuse_several(const search *s) {
    name_list names = {0};
    char text[PLOT3D_LAYOUT_TEXT];
    for (uint32_t i = 0; i < s->found; i++)
        name_list_add(&names, plot3d_layout_print(s->content, s->heads[i].layout, text));
    return status_describe(
        ST_USAGE, "%s: a PLOT3D %s of several layouts: %s; --plot3d with these words chooses one",
        s->path, contents[s->content], name_list_print(&names));
}

/* Whether the file is text, by the words or its first bytes. */
static bool is_text(const search *s, size_t size) {
    const unsigned bytes = PLOT3D_RECORDS | PLOT3D_LITTLE | PLOT3D_F64;
    return s->words->said & PLOT3D_TEXT ||
           (!(s->words->said & bytes) && plot3d_text_known(s->start, size));
}

static status find_text(search *s, plot3d_file *p) {
    size_t count = 0;
    s->text = PLOT3D_TEXT;
    status st = plot3d_text_open(p->m, p->f, &p->text);
    if (st == ST_OK)
        st = plot3d_text_wholes(p->text, PLOT3D_HEAD_MAX / 4, s->start, &count);
    if (st == ST_OK)
        find_heads(s, 4 * count, plot3d_text_count(p->text), 0);
    return st;
}

static status find_bytes(search *s, size_t size, file *f) {
    find_heads(s, size, file_size(f), 0);
    return s->found ? ST_OK : find_padded(s, size, f);
}

static status find_layout(search *s, plot3d_file *p) {
    const uint64_t bytes = file_size(p->f);
    const size_t size = bytes < PLOT3D_HEAD_MAX ? (size_t)bytes : (size_t)PLOT3D_HEAD_MAX;
    status st = file_read_at(p->f, 0, s->start, size);
    if (st == ST_OK)
        st = is_text(s, size) ? find_text(s, p) : find_bytes(s, size, p->f);
    return st != ST_OK     ? st
           : s->found == 0 ? refuse_none(s, p)
           : s->found > 1  ? refuse_several(s)
                           : ST_OK;
}

/* ---- what it says ---- */

static status take_nodes(plot3d_file *p, const plot3d_head *h, uint32_t zone) {
    uint32_t *n = p->nodes[zone];
    plot3d_head_nodes(h, zone, n);
    for (int a = 0; a < 3; a++)
        if (n[a] < 2)
            return status_describe(ST_UNSUPPORTED,
                                   "%s: zone %u has %u x %u x %u nodes, expected 2 or more along "
                                   "each axis",
                                   file_path(p->f), zone + 1, n[0], n[1], n[2]);
    if (plot3d_head_numbers(h, zone) != p->numbers)
        return status_describe(ST_UNSUPPORTED,
                               "%s: zone %u has %u functions, expected %u as in the first",
                               file_path(p->f), zone + 1, plot3d_head_numbers(h, zone), p->numbers);
    return ST_OK;
}

static status check_record(plot3d_file *p, uint64_t at, uint64_t bytes) {
    for (int side = 0; side < 2; side++) {
        const uint64_t place = at + (side ? 4 + bytes : 0);
        uint32_t mark;
        status st = read_run(p, place, SAMPLE_U32, 1, &mark);
        if (st != ST_OK)
            return st;
        if (mark != bytes)
            return status_describe(
                ST_CORRUPT, "%s: byte %llu: a record's length of %u, expected %llu",
                file_path(p->f), (unsigned long long)place, mark, (unsigned long long)bytes);
    }
    return ST_OK;
}

/* Check the lengths on both sides of all records of a zone. */
static status check_records(plot3d_file *p, plot3d_content content, const plot3d_block *b) {
    const uint64_t conditions = PLOT3D_CONDITIONS * plot3d_layout_width(p->layout);
    status st = ST_OK;
    if (content == PLOT3D_SOLUTION)
        st = check_record(p, b->at - conditions - 8, conditions);
    for (uint32_t i = 0; st == ST_OK && i < b->pieces; i++)
        st = check_record(p, b->at + i * (b->bytes + 8), b->bytes);
    return st;
}

static status take_zones(plot3d_file *p, const plot3d_head *h) {
    uint64_t at = h->bytes;
    p->layout = h->layout;
    p->zones = h->zones;
    p->numbers = plot3d_head_numbers(h, 0);
    p->behind = p->text ? 0 : file_size(p->f) - h->length;
    p->nodes = mem_array(p->m, h->zones, sizeof *p->nodes);
    p->blocks = mem_array(p->m, h->zones, sizeof *p->blocks);
    p->buffer = mem_alloc(p->m, PLOT3D_CHUNK * sizeof(double));
    if (!p->nodes || !p->blocks || !p->buffer)
        return ST_NOMEM;
    if (h->layout & PLOT3D_FLAT)
        return status_describe(
            ST_UNSUPPORTED, "%s: a PLOT3D grid of two dimensions, expected three", file_path(p->f));
    for (uint32_t z = 0; z < h->zones; z++) {
        status st = take_nodes(p, h, z);
        at = plot3d_head_block(h, z, at, &p->blocks[z]);
        if (st == ST_OK && p->layout & PLOT3D_RECORDS)
            st = check_records(p, h->content, &p->blocks[z]);
        if (st != ST_OK)
            return st;
    }
    return ST_OK;
}

status plot3d_file_open(mem *m, const char *path, plot3d_content content, const plot3d_words *words,
                        const plot3d_file *grid, plot3d_file *out) {
    *out = (plot3d_file){.m = m};
    search *s = mem_zalloc(m, sizeof *s);
    if (!s)
        return ST_NOMEM;
    s->path = path;
    s->content = content;
    s->words = words;
    s->grid = grid;
    status st = file_open(m, path, &out->f);
    if (st == ST_OK)
        st = find_layout(s, out);
    if (st == ST_OK)
        st = take_zones(out, &s->heads[0]);
    mem_free(m, s);
    return st;
}

void plot3d_file_release(plot3d_file *p) {
    plot3d_text_close(p->text);
    file_close(p->f);
    if (p->m) {
        mem_free(p->m, p->nodes);
        mem_free(p->m, p->blocks);
        mem_free(p->m, p->buffer);
    }
    *p = (plot3d_file){0};
}
