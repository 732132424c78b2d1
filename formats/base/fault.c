#include "formats/base/fault.h"

#include <stdatomic.h>
#include <time.h>

/* Operations left until the one that fails; 0: off, negative: has fired. */
static atomic_long countdown[FAULT_ALL];

static atomic_long delay_us[FAULT_ALL];

void fault_arm(fault_kind kind, long k) {
    atomic_store(&countdown[kind], k);
}

bool fault_fired(fault_kind kind) {
    return atomic_load(&countdown[kind]) < 0;
}

void fault_delay(fault_kind kind, long us) {
    atomic_store(&delay_us[kind], us);
}

static void take_longer(fault_kind kind) {
    const long us = atomic_load_explicit(&delay_us[kind], memory_order_relaxed);
    struct timespec left = {us / 1000000, us % 1000000 * 1000};
    while (us > 0 && nanosleep(&left, &left) != 0) {}
}

bool fault_hit(fault_kind kind) {
    take_longer(kind);
    if (atomic_load_explicit(&countdown[kind], memory_order_relaxed) <= 0)
        return false;
    /* The operation that counts from 1 to 0 fails; the marker -1 keeps later ones from firing. */
    if (atomic_fetch_sub(&countdown[kind], 1) != 1)
        return false;
    atomic_store(&countdown[kind], -1);
    return true;
}
