/* bench_suite.h - a suite of `leafcast bench`: a row of the table (bench_suites.h), and its
 * subjects. */
#ifndef RENDER_BENCH_BENCH_SUITE_H
#define RENDER_BENCH_BENCH_SUITE_H

#include "formats/base/mem.h"
#include "formats/base/progress.h"
#include "formats/base/status.h"
#include "render/app/view_options.h"
#include "render/bench/bench_baseline.h"
#include "render/bench/bench_curve.h"
#include "render/bench/bench_plot.h"
#include "render/bench/bench_store.h"
#include "render/bench/bench_table.h"

enum { BENCH_TRANSFERS = 8 };

/* What the command line says, and the table under way. */
typedef struct bench_job {
    mem m;
    bench_store *store; /* volumes to measure on; for suites that need none, NULL */
    view_options view;
    const char *target; /* a treelet file or a field; NULL: the suite's own volumes */
    const char *output; /* figure49: its picture */
    bool force;
    bool brief;      /* small volumes: to see that all works */
    int largest;     /* figure414: no larger volume than this along an axis */
    int runs;        /* of each, interleaved */
    int count;       /* ray-cells at most */
    int threads;     /* of suites whose subject they are, as the common flag says */
    uint64_t memory; /* likewise, of volumes; 0: no limit */
    const char *transfers[BENCH_TRANSFERS]; /* media: so many of them; none: its own */
    int transfer_count;
    const progress *progress;
    bench_table table;
} bench_job;

enum { BENCH_SUITE_CHARTS = 3 };

typedef struct bench_suite {
    const char *name;
    const char *takes; /* what may follow the name */
    const char *about; /* lines for --help, '\n' between them */
    status (*run)(bench_job *job);
    const char *view;                       /* flags of a view that it goes by, and */
    const char *surfaces;                   /* those of a file that it is given; NULL: takes none */
    bool several;                           /* isovalues at a time */
    bool once;                              /* whatever --runs says */
    bool picture;                           /* -o is a picture, not the table */
    bool series;                            /* of a field's time steps */
    bool media;                             /* of transfer functions */
    bool budget;                            /* with the common flag's memory for volumes */
    int labels;                             /* columns that name a row */
    const bench_count *counts;              /* columns that have a baseline; NULL: none */
    bench_chart charts[BENCH_SUITE_CHARTS]; /* bars; ends at a NULL column */
    bench_curve curve;                      /* or points and lines; x NULL: none */
} bench_suite;

/* What is measured: a treelet file, and what to draw of it. */
typedef struct bench_subject {
    char label[BENCH_TEXT];
    const char *name; /* in the store; NULL: a target */
    const char *path;
    view_options view; /* checked: with at least one isovalue */
} bench_subject;

/* bench_suite_subject() - the i-th subject of a suite: the target as the view's flags say, and no
 * other; or without a target, volumes by name, brief_names where the job is brief. Lists end at
 * NULL. ST_AGAIN behind the last. */
CHECKED status bench_suite_subject(bench_job *job, const char *const *names,
                                   const char *const *brief_names, int i, bench_subject *out);

/* bench_suite_each() - measure() with all of them in turn, until it fails. */
CHECKED status bench_suite_each(bench_job *job, const char *const *names,
                                const char *const *brief_names,
                                status (*measure)(bench_job *job, const bench_subject *s));

#endif
