/* bench_machine.h - on what a table was measured. */
#ifndef RENDER_BENCH_BENCH_MACHINE_H
#define RENDER_BENCH_BENCH_MACHINE_H

#include "formats/base/cpu.h"

enum { BENCH_MACHINE_MAX = 256 };

/* bench_machine() - "EPYC 7B13 (family 25, model 1), 2 CPUs, avx2; 2026-11-21; leafcast 0.1.0,
 * 1d25f59": the CPU as the kernel calls it, how many this process may use, the kernels that were
 * used; today's date (UTC); the program's version, and the commit that it was built from ("": not
 * known). */
void bench_machine(cpu_isa isa, const char *commit, char text[BENCH_MACHINE_MAX]);

#endif
