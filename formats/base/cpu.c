#include "formats/base/cpu.h"

#include <stddef.h>
#include <string.h>

cpu_isa cpu_best(void) {
#if defined __x86_64__ || defined __i386__
    /* Ask for just the instruction sets that the compiler uses for each ISA (see Makefile). */
    const bool bits = __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2") &&
                      __builtin_cpu_supports("popcnt");
    if (bits && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
        __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl") &&
        __builtin_cpu_supports("avx512cd"))
        return CPU_AVX512;
    if (bits && __builtin_cpu_supports("avx2"))
        return CPU_AVX2;
    if (__builtin_cpu_supports("sse4.2") && __builtin_cpu_supports("popcnt"))
        return CPU_SSE42;
#endif
    return CPU_SCALAR;
}

const char *cpu_isa_name(cpu_isa isa) {
    static const char *const names[CPU_ISAS] = {"scalar", "sse42", "avx2", "avx512"};
    return names[isa];
}

bool cpu_isa_find(const char *name, cpu_isa *isa) {
    *isa = cpu_best();
    if (!name || !strcmp(name, "auto"))
        return true;
    for (int i = 0; i <= (int)cpu_best(); i++) {
        if (!strcmp(name, cpu_isa_name((cpu_isa)i))) {
            *isa = (cpu_isa)i;
            return true;
        }
    }
    return false;
}
