/* cpu.h - which kernels this CPU can run.
 *
 * Every kernel exists as plain C, which is the truth, and as translation units for newer
 * instructions (x_sse42.c, x_avx2.c, x_avx512.c) that give the same bits. Which of them runs is
 * chosen at run time.
 */
#ifndef FORMATS_BASE_CPU_H
#define FORMATS_BASE_CPU_H

#include <stdbool.h>
#include <stddef.h>

/* In ascending order: a CPU that can run one can run those before it. */
typedef enum cpu_isa { CPU_SCALAR, CPU_SSE42, CPU_AVX2, CPU_AVX512, CPU_ISAS } cpu_isa;

/* cpu_best() - the newest that this CPU runs and this build has. */
cpu_isa cpu_best(void);

/* cpu_isa_name() - "scalar", "sse42", "avx2", "avx512". */
const char *cpu_isa_name(cpu_isa isa);

/* cpu_isa_find() - by name; NULL or "auto": the best. False for names unknown, and for what this
 * CPU or this build has not. */
bool cpu_isa_find(const char *name, cpu_isa *isa);

/* CPU_KERNELS() - defines `const FN table[CPU_ISAS]`, the versions of one function by ISA: scalar,
 * which may be NULL where there is none, and name_sse42, name_avx2, name_avx512, which it declares;
 * on a CPU that is no x86, scalar alone. FN: a pointer to a function. */
#if defined __x86_64__ || defined __i386__
#define CPU_KERNELS(FN, table, scalar, name)                               \
    extern __typeof__(*(FN)NULL) name##_sse42, name##_avx2, name##_avx512; \
    const FN table[CPU_ISAS] = {scalar, name##_sse42, name##_avx2, name##_avx512}
#else
#define CPU_KERNELS(FN, table, scalar, name) \
    const FN table[CPU_ISAS] = {scalar, scalar, scalar, scalar}
#endif

#endif
