/* cpu.h - which kernels this CPU can run.
 *
 * Every kernel exists as plain C, the reference, and as translation units for newer instructions
 * (x_sse42.c, x_avx2.c, x_avx512.c) that give the same bits. Which of them runs is chosen at run
 * time.
 */
#ifndef FORMATS_BASE_CPU_H
#define FORMATS_BASE_CPU_H

#include <stdbool.h>
#include <stddef.h>

/* In ascending order: a CPU that runs one also runs those before it. */
typedef enum cpu_isa { CPU_SCALAR, CPU_SSE42, CPU_AVX2, CPU_AVX512, CPU_ISAS } cpu_isa;

/* cpu_best() - the newest ISA that both this CPU and this build have. */
cpu_isa cpu_best(void);

/* cpu_isa_name() - "scalar", "sse42", "avx2", "avx512". */
const char *cpu_isa_name(cpu_isa isa);

/* cpu_isa_find() - the ISA of a name; NULL or "auto": the best. Returns false for an unknown name,
 * or an ISA that this CPU or build lacks. */
bool cpu_isa_find(const char *name, cpu_isa *isa);

/* CPU_KERNELS() - defines `const FN table[CPU_ISAS]`: the versions of one function by ISA. It
 * declares name_sse42, name_avx2 and name_avx512. scalar may be NULL where there is no scalar
 * version. On CPUs other than x86, scalar fills every entry. FN: a pointer to a function. */
#if defined __x86_64__ || defined __i386__
#define CPU_KERNELS(FN, table, scalar, name)                               \
    extern __typeof__(*(FN)NULL) name##_sse42, name##_avx2, name##_avx512; \
    const FN table[CPU_ISAS] = {scalar, name##_sse42, name##_avx2, name##_avx512}
#else
#define CPU_KERNELS(FN, table, scalar, name) \
    const FN table[CPU_ISAS] = {scalar, scalar, scalar, scalar}
#endif

#endif
