#include "render/bench/bench_suite.h"

#include <string.h>

status bench_suite_subject(bench_job *job, const char *const *names, const char *const *brief_names,
                           int i, bench_subject *out) {
    out->view = job->view;
    out->name = NULL;
    if (job->target) {
        if (i > 0)
            return ST_AGAIN;
        const char *slash = strrchr(job->target, '/');
        snprintf(out->label, sizeof out->label, "%s", slash ? slash + 1 : job->target);
        out->path = job->target;
        return view_options_check(&out->view);
    }
    const char *name = (job->brief ? brief_names : names)[i];
    if (!name)
        return ST_AGAIN;
    bench_stored stored;
    status st = bench_store_get(job->store, name, &stored);
    snprintf(out->label, sizeof out->label, "%s", stored.label);
    out->name = name;
    out->path = stored.path;
    out->view.surfaces[0] = leafcast_surface_default(stored.isovalue);
    out->view.isos = 1;
    return st;
}

status bench_suite_each(bench_job *job, const char *const *names, const char *const *brief_names,
                        status (*measure)(bench_job *job, const bench_subject *s)) {
    bench_subject s;
    status st = ST_OK;
    for (int i = 0; st == ST_OK; i++) {
        st = bench_suite_subject(job, names, brief_names, i, &s);
        if (st == ST_OK)
            st = measure(job, &s);
    }
    return st == ST_AGAIN ? ST_OK : st;
}
