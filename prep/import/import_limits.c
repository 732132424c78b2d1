#include "prep/import/import_limits.h"

#include <stdatomic.h>
#include <stdio.h>
#include <sys/resource.h>

#include "formats/base/mem.h"
#include "formats/base/pool.h"

/* Sanitizers reserve address space by rules of their own. */
#if defined __SANITIZE_ADDRESS__ || defined __SANITIZE_THREAD__
#define OWN_RULES 1
#elif defined __has_feature
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define OWN_RULES 1
#endif
#endif
#ifndef OWN_RULES
#define OWN_RULES 0
#endif

/* ---- memory ---- */

/* More than fits any machine's address space. */
static const size_t any_size = (size_t)1 << 46;

static atomic_size_t first_refused;

static void lower(int what, rlim_t to) {
    struct rlimit limit;
    if (getrlimit(what, &limit) != 0 || (limit.rlim_cur != RLIM_INFINITY && limit.rlim_cur <= to))
        return;
    limit.rlim_cur = to;
    if (setrlimit(what, &limit) != 0)
        return; /* then the limit stays as it is */
}

/* Bytes that count against the limit already; 0: unknown. */
static uint64_t data_bytes(void) {
    char line[128];
    unsigned long long kib = 0;
    FILE *facts = fopen("/proc/self/status", "r");
    while (facts && !kib && fgets(line, sizeof line, facts))
        if (sscanf(line, "VmData: %llu", &kib) != 1)
            kib = 0;
    if (facts)
        fclose(facts);
    return kib << 10;
}

static void limit_memory(size_t budget) {
    enum { STACK_MIB = 8, MORE_MIB = 256 };
    const uint64_t stacks = (uint64_t)pool_default_threads() * STACK_MIB << 20;
    if (!OWN_RULES)
        lower(RLIMIT_DATA, data_bytes() + 2 * (uint64_t)budget + stacks + (MORE_MIB << 20));
}

void import_limits_refused(size_t bytes) {
    size_t none = 0;
    if (bytes < any_size)
        atomic_compare_exchange_strong(&first_refused, &none, bytes);
}

bool import_limits_short(size_t *bytes) {
    enum { THREAD = 16 << 20 }; /* a thread's stack, and more: libraries crash if they get none */
    *bytes = first_refused;
    return *bytes || !mem_room(THREAD);
}

/* ---- time ---- */

static struct {
    atomic_uint_least32_t patience; /* seconds; 0: no limit */
    atomic_uint_least64_t opened, since;
} allowed;

static uint64_t used_seconds(void) {
    struct rusage used;
    getrusage(RUSAGE_SELF, &used);
    return (uint64_t)(used.ru_utime.tv_sec + used.ru_stime.tv_sec);
}

static void extend(void) {
    struct rlimit limit;
    if (!allowed.patience || getrlimit(RLIMIT_CPU, &limit) != 0)
        return;
    /* The clock cuts each part of the time used to whole seconds, so allow 2 more. */
    const rlim_t until = allowed.since + 2 + allowed.patience + (allowed.opened >> 20);
    limit.rlim_cur = until < limit.rlim_max ? until : limit.rlim_max;
    if (setrlimit(RLIMIT_CPU, &limit) != 0)
        allowed.patience = 0;
}

void import_limits_progress(void) {
    allowed.since = used_seconds();
    extend();
}

void import_limits_opened(uint64_t bytes) {
    allowed.opened += bytes;
    extend();
}

void import_limits_begin(size_t budget, uint32_t seconds) {
    struct rlimit limit;
    limit_memory(budget);
    const bool own = getrlimit(RLIMIT_CPU, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY;
    allowed.patience = own ? 0 : seconds;
    /* Stop before the hard limit, where the system kills without a message. */
    if (own && limit.rlim_max != RLIM_INFINITY && limit.rlim_max > 1)
        lower(RLIMIT_CPU, limit.rlim_max - 1);
    import_limits_progress();
}
