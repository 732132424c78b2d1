/* tetgen_worker_main.cpp - the process that TetGen runs in: leafcast-tetgen.
 *
 *   leafcast-tetgen SWITCHES BYTES < request > reply
 *
 * TetGen is AGPL, throws integers, and may crash, loop or eat all memory on some input. So it is
 * linked into this program alone. The program gets points and facets through a pipe, may take BYTES
 * of address space (0: any), and dies with its parent. SWITCHES are TetGen's own. Numbers are in
 * native byte order: both ends are on one machine. See tetgen_job.h for the other end.
 *
 * Request: magic "LFTGREQ1"; u64 counts of points, facets, polygons, corners, facets' holes, holes,
 * regions; then f64 xyz of the points; u32 polygons of each facet; u32 holes of each facet; u32
 * corners of each polygon; u32 points of all corners; f64 xyz of the facets' holes; f64 xyz of the
 * holes; f64[5] of the regions.
 *
 * Reply: magic "LFTGREP1"; u64 counts of points, triangles, tets; f64 xyz of the points; u32[3] of
 * the triangles on facets; u32[4] of the tets. The points of the request come first, in their
 * order.
 *
 * If SWITCHES begin with d, nothing is meshed. If two facets intersect, it exits with 23, and the
 * last line of standard error is "facets A B", counted from 0. Else it exits with 0 without a
 * reply.
 *
 * Exit codes: 0; 2 usage; 3 malformed request; 4 no memory; 5 cannot write; 20 + N when TetGen gave
 * up with N: 1 no memory, 2 an internal error, 3 facets intersect, 4 a very small feature, 5 facets
 * very close, 10 bad input.
 */
#include <climits>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include <exception>
#include <new>

#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

/* The library's own function frees the mesh and throws. While that unwinds, the mesh is freed
 * again: a crash instead of a code. So the linker finds this function first. */
#define TETLIBRARY
#define terminatetetgen tetgen_terminate_and_crash
#include <tetgen.h>
#undef terminatetetgen
void terminatetetgen(tetgenmesh *mesh, int code);

namespace {

enum { COUNTS = 7, TETGEN_FAILED = 20, TETGEN_INTERSECTION = 3 };
enum { POINTS, FACETS, POLYGONS, CORNERS, FACET_HOLES, HOLES, REGIONS };

struct failure {
    int code;
    const char *what;
};

void end_with(int code) {
    fflush(stdout);
    _exit(TETGEN_FAILED + code);
}
void (*give_up)(int code) = end_with;

FILE *reply; /* the original standard output: TetGen prints to stdout even if told to be quiet */

void get(void *to, size_t size, uint64_t count) {
    if (count > 0 && fread(to, size, count, stdin) != count)
        throw failure{3, "the request ends early"};
}

template <typename T> T *get_array(uint64_t count, int each) {
    if (count > uint64_t(INT_MAX) / uint64_t(each))
        throw failure{3, "the request is too large"};
    T *array = new T[count * each + 1];
    get(array, sizeof(T) * each, count);
    return array;
}

/* Read the facets. The polygons' corners point into one array. TetGen deletes none of it, since the
 * process ends first. */
void get_facets(tetgenio &in, const uint64_t *count) {
    uint32_t *polygons = get_array<uint32_t>(count[FACETS], 1);
    uint32_t *holes = get_array<uint32_t>(count[FACETS], 1);
    uint32_t *corners = get_array<uint32_t>(count[POLYGONS], 1);
    int *ids = get_array<int>(count[CORNERS], 1);
    double *hole = get_array<double>(count[FACET_HOLES], 3);
    tetgenio::polygon *polygon = new tetgenio::polygon[count[POLYGONS] + 1];
    uint64_t p = 0, c = 0, h = 0;
    in.facetlist = new tetgenio::facet[count[FACETS] + 1];
    in.numberoffacets = int(count[FACETS]);
    for (uint64_t f = 0; f < count[FACETS]; f++) {
        if (polygons[f] > count[POLYGONS] - p || holes[f] > count[FACET_HOLES] - h)
            throw failure{3, "facets of more polygons than there are"};
        in.facetlist[f] = {polygon + p, int(polygons[f]), holes[f] ? hole + 3 * h : nullptr,
                           int(holes[f])};
        for (uint32_t i = 0; i < polygons[f]; i++, p++) {
            if (corners[p] > count[CORNERS] - c)
                throw failure{3, "polygons of more corners than there are"};
            polygon[p] = {ids + c, int(corners[p])};
            c += corners[p];
        }
        h += holes[f];
    }
    for (uint64_t i = 0; i < count[CORNERS]; i++)
        if (ids[i] < 0 || uint64_t(ids[i]) >= count[POINTS])
            throw failure{3, "a corner that is no point"};
}

void get_request(tetgenio &in) {
    char magic[8];
    uint64_t count[COUNTS];
    get(magic, 1, sizeof magic);
    get(count, sizeof *count, COUNTS);
    if (memcmp(magic, "LFTGREQ1", 8) != 0)
        throw failure{3, "not a request"};
    in.pointlist = get_array<double>(count[POINTS], 3);
    in.numberofpoints = int(count[POINTS]);
    get_facets(in, count);
    in.holelist = get_array<double>(count[HOLES], 3);
    in.numberofholes = int(count[HOLES]);
    in.regionlist = get_array<double>(count[REGIONS], 5);
    in.numberofregions = int(count[REGIONS]);
}

void put(const void *from, size_t size, uint64_t count) {
    if (count > 0 && fwrite(from, size, count, reply) != count)
        throw failure{5, "cannot write the reply"};
}

void put_reply(const tetgenio &out) {
    const uint64_t count[3] = {uint64_t(out.numberofpoints),
                               out.trifacelist ? uint64_t(out.numberoftrifaces) : 0,
                               uint64_t(out.numberoftetrahedra)};
    put("LFTGREP1", 1, 8);
    put(count, sizeof *count, 3);
    put(out.pointlist, 3 * sizeof(double), count[0]);
    put(out.trifacelist, 3 * sizeof(int), count[1]);
    put(out.tetrahedronlist, 4 * sizeof(int), count[2]);
    if (fflush(reply) != 0)
        throw failure{5, "cannot write the reply"};
}

/* Find the first "Facet #A .. facet #B" that TetGen printed; it counts from 1. */
bool find_pair(FILE *printed, int pair[2]) {
    char line[512];
    rewind(printed);
    while (fgets(line, sizeof line, printed)) {
        const char *first = strstr(line, "acet #");
        const char *second = first ? strstr(first + 1, "acet #") : nullptr;
        if (second && sscanf(first, "acet #%d", &pair[0]) == 1 &&
            sscanf(second, "acet #%d", &pair[1]) == 1)
            return true;
    }
    return false;
}

/* Switch "d": run TetGen's own search for facets that intersect, and read what it prints. */
int diagnose(char *switches, tetgenio *in, tetgenio *out) {
    int pair[2];
    FILE *printed = tmpfile();
    if (!printed)
        throw failure{5, "no place for a temporary file"};
    dup2(fileno(printed), STDOUT_FILENO);
    give_up = [](int) { throw 0; };
    try {
        tetrahedralize(switches, in, out);
    } catch (...) {
        /* the output so far may suffice */
    }
    fflush(stdout);
    if (!find_pair(printed, pair))
        return 0;
    fprintf(stderr, "facets %d %d\n", pair[0] - 1, pair[1] - 1);
    return TETGEN_FAILED + TETGEN_INTERSECTION;
}

int run(char *switches) {
    tetgenio *in = new tetgenio, *out = new tetgenio;
    get_request(*in);
    if (switches[0] == 'd')
        return diagnose(switches, in, out);
    tetrahedralize(switches, in, out);
    put_reply(*out);
    return 0;
}

void limit_memory(const char *bytes) {
    const unsigned long long limit = strtoull(bytes, nullptr, 10);
    const struct rlimit to = {rlim_t(limit), rlim_t(limit)};
    if (limit > 0)
        setrlimit(RLIMIT_AS, &to);
    const struct rlimit none = {0, 0};
    setrlimit(RLIMIT_CORE, &none);
}

} // namespace

/* Replaces the library's own function, so it must be visible to the library. */
__attribute__((visibility("default"))) void terminatetetgen(tetgenmesh *, int code) {
    give_up(code);
}

int main(int argc, char **argv) {
    if (argc == 2 && strcmp(argv[1], "--version") == 0)
        return puts("leafcast-tetgen " LEAFCAST_VERSION) < 0;
    if (argc != 3)
        return fputs("Usage: leafcast-tetgen SWITCHES BYTES < request > reply\n"
                     "Run TetGen (the helper of leafcast tetrahedralize).\n",
                     stderr),
               2;
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    const int fd = dup(STDOUT_FILENO);
    if (fd < 0 || dup2(STDERR_FILENO, STDOUT_FILENO) < 0 || !(reply = fdopen(fd, "wb")))
        return 5;
    limit_memory(argv[2]);
    int code;
    try {
        code = run(argv[1]);
    } catch (const failure &f) {
        fprintf(stderr, "%s\n", f.what);
        code = f.code;
    } catch (const std::bad_alloc &) {
        code = 4;
    } catch (...) {
        code = TETGEN_FAILED + 2;
    }
    fflush(stdout);
    _exit(code); /* skip all destructors: much of the data is not TetGen's to delete */
}
