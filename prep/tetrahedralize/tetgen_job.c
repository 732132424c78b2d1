#include "prep/tetrahedralize/tetgen_job.h"

#include <signal.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/clock.h"
#include "formats/base/sibling.h"

static const char WORKER[] = "leafcast-tetgen";

enum { SWITCHES_MAX = 128, CHUNK = 4096 };
/* Exit codes of the worker. */
enum { CODE_NO_MEMORY = 4, TETGEN_FAILED = 20, TETGEN_NO_MEMORY = 21 };
enum { TETGEN_INTERSECTION = 23, TETGEN_SMALL = 24, TETGEN_CLOSE = 25, TETGEN_INPUT = 30 };

/* Measured: 880 bytes per point for a million points, 6.7 tets per point. */
enum { BYTES_A_POINT = 900, BYTES_AT_LEAST = 64 << 20, DIAGNOSE_SECONDS = 60 };

uint64_t tetgen_job_memory(uint64_t points) {
    return BYTES_AT_LEAST + points * BYTES_A_POINT;
}

status tetgen_job_available(void) {
    char program[SIBLING_PATH];
    if (sibling_find(WORKER, program))
        return ST_OK;
    return status_describe(ST_UNSUPPORTED, "%s is not there: it is built where TetGen is installed",
                           WORKER);
}

/* ---- starting ---- */

static void make_switches(const tetgen_job *job, char switches[SWITCHES_MAX]) {
    const tetgen_options *o = &job->options;
    const plc *x = job->input;
    bool varied = false;
    int n = snprintf(switches, SWITCHES_MAX, "%szQJ", x->facets.count ? "p" : "");
    for (size_t i = 0; i < x->regions.count; i++)
        varied = varied || ((const double *)x->regions.data)[5 * i + 4] > 0;
    if (o->ratio > 0)
        n += snprintf(switches + n, (size_t)(SWITCHES_MAX - n), "q%.9g/%.9g", o->ratio, o->angle);
    if (o->max_volume > 0)
        n += snprintf(switches + n, (size_t)(SWITCHES_MAX - n), "a%.17g", o->max_volume);
    if (varied)
        snprintf(switches + n, (size_t)(SWITCHES_MAX - n), "a");
}

static bool feed_list(child *c, const plc_list *list, size_t size) {
    return list->count == 0 || child_feed(c, list->data, list->count * size);
}

/* Which count of facets or polygons is sent. */
typedef enum fed_count { FED_POLYGONS, FED_HOLES, FED_CORNERS } fed_count;

static uint32_t count_of(const plc *x, fed_count what, size_t i) {
    switch (what) {
    case FED_POLYGONS: return (uint32_t)(plc_polygons_end(x, i) - plc_facet_at(x, i)->polygon);
    case FED_HOLES: return (uint32_t)(plc_facet_holes_end(x, i) - plc_facet_at(x, i)->hole);
    default: return (uint32_t)(plc_corners_begin(x, i + 1) - plc_corners_begin(x, i));
    }
}

static bool feed_counts(child *c, const plc *x, fed_count what) {
    const size_t count = what == FED_CORNERS ? x->polygons.count : x->facets.count;
    uint32_t buffer[CHUNK];
    for (size_t first = 0; first < count; first += CHUNK) {
        const size_t n = count - first < CHUNK ? count - first : CHUNK;
        for (size_t i = 0; i < n; i++)
            buffer[i] = count_of(x, what, first + i);
        if (!child_feed(c, buffer, n * sizeof *buffer))
            return false;
    }
    return true;
}

static bool feed_request(child *c, const plc *x) {
    const uint64_t counts[7] = {x->points.count,  x->facets.count,      x->polygons.count,
                                x->corners.count, x->facet_holes.count, x->holes.count,
                                x->regions.count};
    return child_feed(c, "LFTGREQ1", 8) && child_feed(c, counts, sizeof counts) &&
           feed_list(c, &x->points, 3 * sizeof(double)) && feed_counts(c, x, FED_POLYGONS) &&
           feed_counts(c, x, FED_HOLES) && feed_counts(c, x, FED_CORNERS) &&
           feed_list(c, &x->corners, sizeof(uint32_t)) &&
           feed_list(c, &x->facet_holes, 3 * sizeof(double)) &&
           feed_list(c, &x->holes, 3 * sizeof(double)) &&
           feed_list(c, &x->regions, 5 * sizeof(double));
}

static status start(tetgen_job *job, const char *wanted, double seconds) {
    char program[SIBLING_PATH], bytes[32], switches[SWITCHES_MAX];
    status st = tetgen_job_available();
    if (st != ST_OK || !sibling_find(WORKER, program))
        return st;
    snprintf(switches, sizeof switches, "%s", wanted);
    snprintf(bytes, sizeof bytes, "%llu", (unsigned long long)job->options.memory);
    char *argv[] = {program, switches, bytes, NULL};
    st = child_start(program, argv, true, &job->c);
    job->running = st == ST_OK;
    job->until = seconds > 0 ? clock_seconds() + seconds : 0;
    if (job->running && feed_request(&job->c, job->input))
        child_fed(&job->c); /* if that fails, the exit code tells why */
    return st;
}

/* ---- waiting ---- */

static status wait_for(void *ctx) {
    const tetgen_job *job = ctx;
    if (job->until > 0 && clock_seconds() > job->until)
        return status_describe(ST_UNSUPPORTED,
                               "%s: TetGen did not come to an end within %g s (--timeout)",
                               job->options.file, job->options.seconds);
    /* TetGen does not report progress: only check for a stop. */
    const progress *p = job->options.progress;
    return p && p->stop && p->stop(p->ctx) ? status_describe(ST_STOPPED, "stopped while meshing")
                                           : ST_OK;
}

/* Kill the process, or let it end. */
static status end_process(tetgen_job *job, bool kill, int *code) {
    if (kill)
        child_kill(&job->c);
    job->running = false;
    return child_end(&job->c, code);
}

/* ---- errors ---- */

/* MeshFix removes crossings, slivers and holes from a surface (its manual: meshfix(7)). */
#define REPAIR \
    "; `meshfix in.ply -o out' repairs such surfaces into out.off (iso2mesh-tools, or pymeshfix)"

/* The hint on repair; points have no surface to be repaired. */
static const char *repair(const tetgen_job *job) {
    return job->input->facets.count > 0 ? REPAIR : "";
}

/* Find facets A and B that intersect. Returns false unless TetGen's own search finds them in
 * time. */
static bool find_intersection(tetgen_job *job, unsigned pair[2]) {
    char byte;
    size_t got;
    int code = 0;
    if (job->input->facets.count == 0 || start(job, "dz", DIAGNOSE_SECONDS) != ST_OK)
        return false;
    const status st = child_read(&job->c, &byte, 1, &got, wait_for, job);
    if (end_process(job, st != ST_OK, &code) != ST_OK || code != TETGEN_INTERSECTION)
        return false;
    const char *line = strstr(job->c.words, "facets ");
    return line && sscanf(line, "facets %u %u", &pair[0], &pair[1]) == 2 &&
           pair[0] < job->input->facets.count && pair[1] < job->input->facets.count;
}

static status intersection(const tetgen_job *job, const unsigned pair[2]) {
    const plc *x = job->input;
    const double *p = plc_point(
        x, ((const uint32_t *)
                x->corners.data)[plc_corners_begin(x, plc_facet_at(x, pair[0])->polygon)]);
    return status_describe(
        ST_CORRUPT,
        "%s: the surface cuts itself: facets %u and %u (counted from %u), near "
        "(%.9g %.9g %.9g), expected facets that meet in common edges and corners "
        "alone" REPAIR,
        job->options.file, plc_facet_at(x, pair[0])->number + x->counted_from,
        plc_facet_at(x, pair[1])->number + x->counted_from, x->counted_from, p[0], p[1], p[2]);
}

static status no_memory(const tetgen_job *job, bool killed) {
    return status_describe(ST_NOMEM, "%s: TetGen %s %.0f MiB it was given%s", job->options.file,
                           killed ? "was killed, as by a system short of memory, within the"
                                  : "needs more than the",
                           (double)job->options.memory / 0x1p20,
                           killed ? "" : "; --memory gives it more, larger tets need less");
}

/* The last line that the process printed. */
static const char *last_words(const tetgen_job *job) {
    const char *line = strrchr(job->c.words, '\n');
    return line ? line + 1 : job->c.words;
}

static status explain(tetgen_job *job, int code) {
    const char *file = job->options.file;
    unsigned pair[2];
    char said[200];
    if (code == CODE_NO_MEMORY || code == TETGEN_NO_MEMORY)
        return no_memory(job, false);
    if (code == 128 + SIGKILL)
        return no_memory(job, true);
    if (code == 128 + SIGINT || code == 128 + SIGTERM || code == 128 + SIGHUP)
        return status_describe(ST_STOPPED, "%s: %s was ended by signal %d", file, WORKER,
                               code - 128);
    if (code < TETGEN_FAILED)
        return status_describe(ST_FAILED, "%s: %s ended with exit code %d: %s", file, WORKER, code,
                               last_words(job));
    snprintf(said, sizeof said, "%.199s", last_words(job));
    if (find_intersection(job, pair))
        return intersection(job, pair);
    if (code == TETGEN_INTERSECTION)
        return status_describe(ST_CORRUPT,
                               "%s: the surface cuts itself, expected facets that meet in common "
                               "edges and corners alone" REPAIR,
                               file);
    if (code == TETGEN_SMALL || code == TETGEN_CLOSE)
        return status_describe(
            ST_CORRUPT, "%s: TetGen finds %s, expected a surface without such places%s", file,
            code == TETGEN_SMALL ? "a detail too small to be meshed"
                                 : "two facets all but on top of each other",
            repair(job));
    if (code == TETGEN_INPUT)
        return status_describe(ST_CORRUPT, "%s: TetGen refuses the input: %s", file, said);
    return status_describe(ST_UNSUPPORTED, "%s: TetGen %s on this input%s%s%s", file,
                           code > 128 ? "crashed" : "failed", said[0] ? ": " : "", said,
                           repair(job));
}

/* Read the next `size` bytes of the reply. */
static status read_reply(tetgen_job *job, void *data, size_t size) {
    size_t got;
    int code = 0;
    status st = child_read(&job->c, data, size, &got, wait_for, job);
    if (st == ST_OK && got == size)
        return ST_OK;
    const status ended = end_process(job, st != ST_OK, &code);
    if (st != ST_OK || ended != ST_OK)
        return st != ST_OK ? st : ended;
    return explain(job, code);
}

static status read_head(tetgen_job *job) {
    char magic[8];
    uint64_t counts[3] = {0};
    status st = read_reply(job, magic, sizeof magic);
    if (st == ST_OK)
        st = read_reply(job, counts, sizeof counts);
    if (st == ST_OK && (memcmp(magic, "LFTGREP1", 8) != 0 || counts[0] > INT32_MAX ||
                        counts[1] > INT32_MAX || counts[2] > INT32_MAX))
        return status_describe(ST_FAILED, "%s: %s gave no reply of its kind", job->options.file,
                               WORKER);
    job->points = counts[0];
    job->triangles = counts[1];
    job->tets = counts[2];
    return st;
}

status tetgen_job_run(tetgen_job *job, mem *m, const plc *input, const tetgen_options *options) {
    char switches[SWITCHES_MAX];
    *job = (tetgen_job){.m = m, .input = input, .options = *options};
    make_switches(job, switches);
    status st = start(job, switches, options->seconds);
    if (st == ST_OK)
        st = read_head(job);
    if (st != ST_OK)
        return st;
    job->xyz = mem_array(m, job->points + 1, sizeof *job->xyz);
    job->triangle = mem_array(m, job->triangles + 1, sizeof *job->triangle);
    if (!job->xyz || !job->triangle)
        return ST_NOMEM;
    st = read_reply(job, job->xyz, job->points * sizeof *job->xyz);
    return st == ST_OK ? read_reply(job, job->triangle, job->triangles * sizeof *job->triangle)
                       : st;
}

status tetgen_job_tets(tetgen_job *job, uint32_t (*tets)[4], size_t count) {
    status st = read_reply(job, tets, count * sizeof *tets);
    for (size_t i = 0; st == ST_OK && i < 4 * count; i++)
        if (tets[i / 4][i % 4] >= job->points)
            return status_describe(ST_FAILED, "%s: %s gave a tet with a corner that is no point",
                                   job->options.file, WORKER);
    return st;
}

void tetgen_job_end(tetgen_job *job) {
    int code;
    if (job->running && end_process(job, true, &code) != ST_OK)
        job->running = false; /* nothing more can be done */
    if (job->m) {
        mem_free(job->m, job->xyz);
        mem_free(job->m, job->triangle);
    }
    *job = (tetgen_job){0};
}
