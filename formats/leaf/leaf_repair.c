#include "formats/leaf/leaf_repair.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "formats/base/file.h"
#include "formats/base/file_guard.h"
#include "formats/base/hash.h"
#include "formats/leaf/leaf_check.h"
#include "formats/leaf/leaf_damage.h"
#include "formats/leaf/leaf_order.h"
#include "formats/leaf/leaf_verify.h"

typedef struct repair {
    mem *m;
    const leaf_repair_job *job;
    leaf_repair_result *result;
    file *copy[LEAF_REPAIR_COPIES];
    out_file *out;
    char *buffer; /* of `room` bytes */
    size_t room;
    leaf_damage lost; /* damaged in both copies */
    /* Whether bad is a copy of the same file: proven by its header, by the checksums in it, or by
     * most of its payloads. */
    bool same;
    uint64_t same_bytes; /* of payloads taken from bad */
    uint64_t all_bytes;  /* of the file */
} repair;

/* A treelet file within the copies: all of it, or a segment (SERIES.md 4), or a coarse grid. */
typedef struct region {
    uint64_t base;
    const leaf_part *part; /* of a coarse grid, else NULL */
    const char *where;     /* for names: leaf_damage_where() */
    leaf_header header;
    leaf_section table[LEAF_SECTIONS_MAX];
} region;

/* Whether a region is the file, or its first segment. */
static bool is_first(const region *g) {
    return !g->part && g->base == 0;
}

/* ---- parts ---- */

static status reserve(repair *r, uint64_t size) {
    if (size <= r->room)
        return ST_OK;
    mem_free(r->m, r->buffer);
    r->room = 0;
    r->buffer = mem_alloc(r->m, (size_t)size);
    if (!r->buffer)
        return ST_NOMEM;
    r->room = (size_t)size;
    return ST_OK;
}

/* Read bytes of a copy. A place that cannot be read is as good as a damaged one. */
static bool read_copy(const repair *r, int i, uint64_t at, void *into, size_t size) {
    return file_read_at(r->copy[i], at, into, size) == ST_OK;
}

static bool copy_holds(const repair *r, int i, uint64_t at, uint64_t size) {
    const uint64_t end = file_size(r->copy[i]);
    return at <= end && size <= end - at;
}

/* Read a part into the buffer, from the first copy that has it with this checksum. *from: which
 * one; LEAF_REPAIR_COPIES: none. */
static status find_part(repair *r, uint64_t at, uint64_t size, uint64_t sum, int *from) {
    for (*from = 0; *from < LEAF_REPAIR_COPIES; ++*from) {
        if (!copy_holds(r, *from, at, size))
            continue;
        status st = reserve(r, size);
        if (st != ST_OK)
            return st;
        if (read_copy(r, *from, at, r->buffer, (size_t)size) &&
            hash_bytes(r->buffer, (size_t)size) == sum)
            return ST_OK;
    }
    return ST_OK;
}

/* Count gaps in which bad has something else than zeros. */
static void look_at_gap(repair *r, uint64_t from, uint64_t to) {
    static const char zeros[4096];
    char bytes[sizeof zeros];
    while (from < to) {
        const size_t size = to - from < sizeof bytes ? (size_t)(to - from) : sizeof bytes;
        if (!read_copy(r, LEAF_REPAIR_BAD, from, bytes, size) || memcmp(bytes, zeros, size)) {
            r->result->gaps++;
            return;
        }
        from += size;
    }
}

/* ---- header and section table ---- */

/* Read a copy's header. Returns whether it is sound and, of a coarse grid, has the id that
 * the file around it gives. note: why not. */
static bool read_header(const repair *r, const region *g, int i, leaf_header *h,
                        status_note *note) {
    leaf_layout layout;
    const char *path = file_path(r->copy[i]);
    status st = file_read_at(r->copy[i], g->base, h, sizeof *h);
    if (st == ST_OK)
        st = leaf_check_header(path, h, g->part ? g->part->bytes : h->file_bytes);
    if (st == ST_OK)
        st = leaf_check_layout(path, h, &layout);
    status_note_take(note, st);
    return st == ST_OK && (!g->part || memcmp(h->id, g->part->id, sizeof h->id) == 0);
}

static status refuse_ids(const repair *r, const leaf_header h[LEAF_REPAIR_COPIES]) {
    char text[LEAF_REPAIR_COPIES][LEAF_ID_TEXT];
    return status_describe(ST_USAGE,
                           "%s has the id %s, and %s the id %s: they are not copies of one file",
                           file_path(r->copy[0]), leaf_id_text(&h[0], text[0]),
                           file_path(r->copy[1]), leaf_id_text(&h[1], text[1]));
}

static status refuse_headers(const status_note note[LEAF_REPAIR_COPIES]) {
    return status_describe(ST_CORRUPT, "the headers of both copies are damaged: %.400s; %.400s",
                           note[0].text, note[1].text);
}

/* Write the header. Before the file's, or a segment's, give the output its length, with zeros. */
static status write_header(repair *r, const region *g) {
    status st = ST_OK;
    if (!g->part)
        st = out_file_write_at(r->out, g->base + g->header.file_bytes - 1, "", 1);
    return st == ST_OK ? out_file_write_at(r->out, g->base, &g->header, sizeof g->header) : st;
}

/* Take the header of a region. *found: whether there is one; the first one must be. */
static status take_header(repair *r, region *g, bool *found) {
    leaf_header h[LEAF_REPAIR_COPIES] = {0};
    status_note note[LEAF_REPAIR_COPIES];
    bool sound[LEAF_REPAIR_COPIES];
    for (int i = 0; i < LEAF_REPAIR_COPIES; i++)
        sound[i] = read_header(r, g, i, &h[i], &note[i]);
    *found = sound[0] || sound[1];
    if (!*found && !is_first(g))
        leaf_damage_add(&r->lost, g->where, "its header");
    if (!*found)
        return is_first(g) ? refuse_headers(note) : ST_OK;
    if (sound[0] && sound[1] && memcmp(h[0].id, h[1].id, sizeof h[0].id) != 0)
        return refuse_ids(r, h);
    const int from = sound[LEAF_REPAIR_BAD] ? LEAF_REPAIR_BAD : LEAF_REPAIR_FROM;
    g->header = h[from];
    r->result->directory[from]++;
    /* A damaged header may still tell its id. */
    if (is_first(g))
        r->same = memcmp(h[0].id, h[1].id, sizeof h[0].id) == 0 || sound[LEAF_REPAIR_BAD];
    return write_header(r, g);
}

/* Take the section table. The header's id is a hash of both, so it proves the table. */
static status take_table(repair *r, region *g, bool *found, uint64_t *end) {
    const size_t size = g->header.sections * sizeof *g->table;
    for (int i = 0; i < LEAF_REPAIR_COPIES; i++)
        if (read_copy(r, i, g->base + leaf_table_at(&g->header), g->table, size) &&
            leaf_check_sections(file_path(r->copy[i]), &g->header, g->table, end) == ST_OK) {
            r->result->directory[i]++;
            return out_file_write_at(r->out, g->base + leaf_table_at(&g->header), g->table, size);
        }
    *found = false;
    leaf_damage_add(&r->lost, g->where, "the section table");
    return ST_OK;
}

static status take_section(repair *r, const region *g, const leaf_section *s) {
    char name[32];
    int from;
    status st = find_part(r, g->base + s->offset, s->bytes, s->checksum, &from);
    if (st != ST_OK)
        return st;
    if (from == LEAF_REPAIR_COPIES) {
        snprintf(name, sizeof name, "section %u", s->kind);
        leaf_damage_add(&r->lost, g->where, name);
        return ST_OK;
    }
    r->result->directory[from]++;
    if (is_first(g) && s->kind == LEAF_SECTION_CHECKSUMS && g->header.payload_bytes)
        r->same |= from == LEAF_REPAIR_BAD;
    return out_file_write_at(r->out, g->base + s->offset, r->buffer, (size_t)s->bytes);
}

/* Take header, section table and sections of a region. *found: whether all of them were there. */
static status take_directory(repair *r, region *g, bool *found) {
    const uint64_t lost = r->lost.count;
    uint64_t end;
    status st = take_header(r, g, found);
    if (st == ST_OK && *found)
        st = take_table(r, g, found, &end);
    if (st != ST_OK || !*found)
        return st;
    end = leaf_table_at(&g->header) + g->header.sections * sizeof *g->table;
    for (uint32_t i = 0; i < g->header.sections && st == ST_OK; i++) {
        look_at_gap(r, g->base + end, g->base + g->table[i].offset);
        st = take_section(r, g, &g->table[i]);
        end = g->table[i].offset + g->table[i].bytes;
    }
    *found = r->lost.count == lost;
    return st;
}

/* ---- payloads ---- */

static status take_payload(repair *r, const region *g, const leaf_file *f, uint32_t p) {
    char name[LEAF_NAME_MAX];
    int from;
    const uint64_t at = g->base + f->offsets[p];
    status st = find_part(r, at, f->sizes[p], f->checksums[p], &from);
    if (st != ST_OK)
        return st;
    if (from == LEAF_REPAIR_COPIES) {
        leaf_damage_add(&r->lost, g->where, leaf_layout_payload_name(&f->layout, p, name));
        return ST_OK;
    }
    r->result->payloads[from]++;
    if (!g->part && from == LEAF_REPAIR_BAD)
        r->same_bytes += f->sizes[p];
    /* Once something is lost, only look for what else is. */
    return r->lost.count ? ST_OK : out_file_write_at(r->out, at, r->buffer, (size_t)f->sizes[p]);
}

static status take_payloads(repair *r, const region *g, const leaf_file *f) {
    status st = reserve(r, leaf_layout_stored_max(&f->layout));
    const uint64_t table = f->header.directory;
    uint64_t end = leaf_payloads_at(&f->header, f->directory_end);
    for (leaf_order o = leaf_order_begin(&f->layout); o.p < f->layout.payloads && st == ST_OK;
         leaf_order_next(&o, &f->layout)) {
        if (!leaf_file_is_home(f, o.p))
            continue;
        look_at_gap(r, g->base + end, g->base + f->offsets[o.p]);
        end = f->offsets[o.p] + f->sizes[o.p];
        st = progress_step(r->job->progress, "repair",
                           0.5 * (double)(g->base + end) / (double)r->all_bytes);
        if (st == ST_OK)
            st = take_payload(r, g, f, o.p);
    }
    look_at_gap(r, g->base + end, g->base + (table ? table : f->payloads_end));
    if (table)
        look_at_gap(r, g->base + f->directory_end, g->base + f->payloads_end);
    return st;
}

/* ---- files ---- */

static status repair_all_coarse(repair *r, const region *of, const leaf_file *f);

/* Repair the coarse grid of a set, of f, whose own directory is in the output, and what that has
 * inside. of: the region of f. */
static status repair_coarse(repair *r, const region *of, const leaf_file *f, uint32_t set) {
    char where[LEAF_WHERE_MAX];
    region g = {.base = of->base + f->coarse[set].offset,
                .part = &f->coarse[set],
                .where = f->stands_in ? of->where : leaf_damage_where(set, where)};
    leaf_file *coarse = NULL;
    bool found;
    status st = take_directory(r, &g, &found);
    if (st != ST_OK || !found)
        return st;
    st = leaf_file_open_coarse(r->m, f, set, &coarse);
    if (st == ST_OK)
        st = take_payloads(r, &g, coarse);
    if (st == ST_OK)
        st = repair_all_coarse(r, &g, coarse);
    leaf_file_close(coarse);
    return st;
}

static status repair_all_coarse(repair *r, const region *of, const leaf_file *f) {
    status st = ST_OK;
    for (uint32_t set = 0; set < f->layout.sets && st == ST_OK; set++)
        if (leaf_file_has_coarse(f, set))
            st = repair_coarse(r, of, f, set);
    return st;
}

/* Take the directories of all segments, or of the file without any: g, its first one. A segment
 * lies where the one before it ends. *end: where the last one does. */
static status take_directories(repair *r, region *g, bool *found, uint64_t *end) {
    status st = take_directory(r, g, found);
    *end = g->header.file_bytes;
    for (uint32_t i = 1; st == ST_OK && *found && i < g->header.segments; i++) {
        char where[LEAF_WHERE_MAX];
        region next = {.base = *end, .where = leaf_damage_segment(i, where)};
        st = take_directory(r, &next, found);
        *end += next.header.file_bytes;
    }
    return st;
}

/* Steps may have been added to bad that the other copy has not. Only bad's header tells. */
static status check_longer(const repair *r, const region *g, uint64_t end) {
    leaf_header bad;
    status_note note;
    if (!g->header.segments || file_size(r->copy[LEAF_REPAIR_BAD]) <= end ||
        read_header(r, g, LEAF_REPAIR_BAD, &bad, &note))
        return ST_OK;
    return status_describe(
        ST_CORRUPT,
        "%s: its header is damaged, and it is longer than %s: that may lack steps "
        "that were added since",
        file_path(r->copy[0]), file_path(r->copy[1]));
}

/* Give the output its directory, and open it. *f stays NULL where the directory is lost. */
static status begin_output(repair *r, region *g, leaf_file **f) {
    bool found;
    uint64_t end;
    status st = take_directories(r, g, &found, &end);
    if (st == ST_OK && found)
        st = check_longer(r, g, end);
    return st == ST_OK && found ? leaf_file_open(r->m, out_file_temporary(r->out), f) : st;
}

/* Take the payloads of a file, segment by segment where it has several. */
static status take_segments(repair *r, const region *g, const leaf_file *f) {
    status st = ST_OK;
    if (f->header.segments < 2)
        return take_payloads(r, g, f);
    for (uint32_t i = 0; i < f->header.segments && st == ST_OK; i++) {
        char where[LEAF_WHERE_MAX];
        const region own = {.base = f->segments[i].base, .where = leaf_damage_segment(i, where)};
        leaf_file *part = NULL;
        st = leaf_file_open_segment(r->m, f, &f->segments[i], &part);
        if (st == ST_OK)
            st = take_payloads(r, &own, part);
        leaf_file_close(part);
    }
    return st;
}

static status refuse_lost(repair *r) {
    return status_describe(ST_CORRUPT, "%llu parts are damaged in both %s and %s: %s",
                           (unsigned long long)r->lost.count, file_path(r->copy[0]),
                           file_path(r->copy[1]), leaf_damage_names(&r->lost));
}

/* Check that bad, whose header may be damaged, was the same file. Otherwise the output would be
 * a mere copy of the other. */
static status check_same(const repair *r, const leaf_header *h) {
    if (r->same || (h->payload_bytes && r->same_bytes > h->payload_bytes / 2))
        return ST_OK;
    return status_describe(ST_CORRUPT,
                           "%s: its header is damaged, and nothing else tells that %s is a copy of "
                           "the same file",
                           file_path(r->copy[0]), file_path(r->copy[1]));
}

/* Fill the output. */
static status fill(repair *r) {
    region g = {.where = ""};
    leaf_file *f = NULL;
    status st = begin_output(r, &g, &f);
    if (f && st == ST_OK) {
        r->all_bytes = f->header.file_bytes;
        st = take_segments(r, &g, f);
        g.header = f->header;
    }
    if (f && st == ST_OK)
        st = repair_all_coarse(r, &g, f);
    leaf_file_close(f);
    if (st == ST_OK && r->lost.count)
        st = refuse_lost(r);
    if (st == ST_OK)
        st = check_same(r, &g.header);
    r->result->header = g.header;
    if (!g.header.segments) /* else what is behind the last one does not count */
        r->result->gaps += file_size(r->copy[LEAF_REPAIR_BAD]) > g.header.file_bytes;
    return st;
}

/* ---- the output ---- */

/* leaf_verify() reports the second half. */
static void report_second(void *ctx, const char *stage, double fraction) {
    const progress *p = ctx;
    if (p->report)
        p->report(p->ctx, stage, 0.5 + 0.5 * fraction);
}

static bool stop_second(void *ctx) {
    const progress *p = ctx;
    return p->stop && p->stop(p->ctx);
}

/* Check every byte of the output, as it is on the disk. */
static status prove(const repair *r) {
    progress outer = r->job->progress ? *r->job->progress : (progress){0};
    const progress second = {.report = report_second, .stop = stop_second, .ctx = &outer};
    leaf_file *f = NULL;
    status st = leaf_file_open(r->m, out_file_temporary(r->out), &f);
    if (st == ST_OK)
        st = leaf_verify(r->m, f, r->job->threads, &second);
    leaf_file_close(f);
    return st;
}

/* Give the output the permissions of the file that it replaces. */
static void keep_mode(const repair *r) {
    struct stat info;
    if (fstat(file_descriptor(r->copy[LEAF_REPAIR_BAD]), &info) == 0)
        (void)chmod(out_file_temporary(r->out), info.st_mode & 07777);
}

static status finish(repair *r) {
    leaf_repair_result *result = r->result;
    result->mended =
        result->payloads[LEAF_REPAIR_FROM] || result->directory[LEAF_REPAIR_FROM] || result->gaps;
    status st = prove(r);
    file_guard_forget(out_file_temporary(r->out));
    if (st != ST_OK || (!r->job->output && !result->mended))
        return st;
    if (!r->job->output)
        keep_mode(r);
    st = out_file_commit(r->out);
    r->out = NULL;
    return st;
}

static status create_output(repair *r) {
    const leaf_repair_job *job = r->job;
    if (job->output)
        return out_file_create(r->m, job->output, job->force, &r->out);
    /* Where bad is a symbolic link, replace what it leads to. */
    char *path = realpath(job->bad, NULL);
    status st = path ? out_file_create(r->m, path, true, &r->out)
                     : status_describe(ST_IO, "%s: cannot find its place", job->bad);
    free(path);
    return st;
}

static status open_copies(repair *r) {
    file_mark mark[LEAF_REPAIR_COPIES] = {0};
    const char *const path[] = {r->job->bad, r->job->from};
    for (int i = 0; i < LEAF_REPAIR_COPIES; i++) {
        status st = file_open(r->m, path[i], &r->copy[i]);
        if (st == ST_OK)
            st = file_mark_take(r->copy[i], &mark[i]);
        if (st != ST_OK)
            return st;
    }
    if (mark[0].device != mark[1].device || mark[0].inode != mark[1].inode)
        return ST_OK;
    return status_describe(ST_USAGE, "%s: is the same file as %s; another copy of it is needed",
                           path[1], path[0]);
}

status leaf_repair(mem *m, const leaf_repair_job *job, leaf_repair_result *result) {
    *result = (leaf_repair_result){0};
    repair r = {.m = m, .job = job, .result = result};
    status st = open_copies(&r);
    if (st == ST_OK)
        st = create_output(&r);
    if (st == ST_OK)
        st = fill(&r);
    mem_free(m, r.buffer);
    if (st == ST_OK)
        st = finish(&r);
    out_file_discard(r.out);
    file_close(r.copy[0]);
    file_close(r.copy[1]);
    return st;
}
