/* test_refresh.c - volumes whose files grow: what was drawn, is drawn, and is in memory stays what
 * it is; the steps that have come are what a file that is opened then has; what is no further step
 * changes nothing. Two fields, so that sets get other numbers.
 */
/* marks: threads */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "formats/base/fault.h"
#include "formats/leaf/leaf_grow.h"
#include "render/door/leafcast_volume.h"
#include "tests/support/leaf_files.h"
#include "tests/support/mesh_movies.h"
#include "tests/support/pictures.h"
#include "tests/support/scratch.h"
#include "tests/support/watched.h"

enum { STEPS = 7, FIRST = 2, FIELDS = 2, N = WATCHED ? 32 : 44 };

static const double ISO = 120;

/* A ball that moves along x, and becomes brighter. Far from it all is one value, which changes
 * once. */
static uint8_t *samples_of(int step) {
    uint8_t *v = malloc((size_t)N * N * N);
    for (int i = 0; i < N * N * N; i++) {
        const int x = i % N - N / 4 - N * step / 13, y = i / N % N - N / 2, z = i / N / N - N / 2;
        const int d = x * x + y * y + z * z;
        v[i] = (uint8_t)(d > N * N / 2 ? 2 - step / 3 : 240 + step - 460 * d / (N * N));
    }
    return v;
}

/* The series: files of samples, and what its pictures are like. */
typedef struct stage {
    const char *paths[STEPS];
    leaf_case c;
    uint32_t fields;
    const char *path; /* of the file that grows */
    leafcast_camera view;
    leafcast_scene scene;
    picture want[STEPS];
} stage;

static grid_series steps_of(const stage *s, uint32_t first, uint32_t count) {
    static const char *const names[FIELDS] = {"speed", "heat"};
    static double times[STEPS];
    for (int i = 0; i < STEPS; i++)
        times[i] = 10 * i;
    return (grid_series){
        .of = {.paths = s->paths + first, .sets = {s->fields, count, names, times + first, NULL}},
        .hints = {.dims = {N, N, N}, .type = SAMPLE_U8}};
}

static void begin(stage *s, uint32_t steps, const char *name) {
    const grid_series of = steps_of(s, 0, steps);
    convert_options o = s->c.options;
    o.grows = true;
    o.force = true;
    s->path = leaf_files_series(&of, &o, name);
}

static void add(const stage *s, uint32_t first, uint32_t count) {
    const grid_series of = steps_of(s, first, count);
    if (leaf_files_add(&of, &s->c.options, s->path) != ST_OK)
        fail_msg("%s", status_text());
}

static leafcast *open_it(const char *path, const leafcast_options *o) {
    const leafcast_surface surface = leafcast_surface_default(ISO);
    leafcast *v;
    if (leafcast_open(path, o, &v) != LEAFCAST_OK)
        fail_msg("%s", leafcast_error_text());
    assert_int_equal(leafcast_select(v, &surface, 1), LEAFCAST_OK);
    return v;
}

static stage *stage_of(leaf_codec codec, uint32_t fields) {
    const leafcast_options o = {.size = sizeof o, .threads = 2};
    stage *s = calloc(1, sizeof *s);
    s->fields = fields;
    s->c = leaf_files_case(N, N, N, SAMPLE_U8);
    s->c.options.file.codec = codec;
    s->c.options.file.zstd_level = 1;
    s->scene = leafcast_scene_default();
    s->view = (leafcast_camera){.size = sizeof s->view,
                                .eye = {2.5 * N, 1.7 * N, 2.1 * N},
                                .look_at = {N / 2.0, N / 2.0, N / 2.0},
                                .up = {0, 0, 1},
                                .fov = 30,
                                .width = PICTURE_WIDTH,
                                .height = PICTURE_HEIGHT};
    for (int step = 0; step < STEPS; step++) {
        char name[32];
        uint8_t *samples = samples_of(step);
        snprintf(name, sizeof name, "step%d.bin", step);
        s->paths[step] = strdup(scratch_write(name, samples, (size_t)N * N * N));
        s->c.samples = samples;
        snprintf(name, sizeof name, "alone%d.leaf", step);
        s->c.options.force = true;
        leafcast *v = open_it(leaf_files_make(&s->c, name), &o);
        pictures_draw(v, &s->scene, &s->view, &s->want[step], NULL);
        leafcast_close(v);
        free(samples);
    }
    return s;
}

static stage *stage_make(leaf_codec codec) {
    stage *s = stage_of(codec, FIELDS);
    begin(s, FIRST, "grown.leaf");
    return s;
}

static void stage_free(stage *s) {
    for (int step = 0; step < STEPS; step++)
        free((void *)(uintptr_t)s->paths[step]);
    free(s);
}

static void check(const stage *s, const picture *p, uint32_t step) {
    for (int i = 0; i < PICTURE_PIXELS; i++)
        if (!pictures_same_pixel(p, &s->want[step], i))
            fail_msg("step %u: pixel %d", step, i);
}

/* Draw a set, and check it. Returns how many treelets were read for it. */
static uint64_t draw(const stage *s, leafcast *v, uint32_t of, uint32_t step) {
    picture *p = malloc(sizeof *p);
    leafcast_stats stats = {.size = sizeof stats};
    assert_int_equal(leafcast_select_set(v, of, step), LEAFCAST_OK);
    pictures_draw(v, &s->scene, &s->view, p, &stats);
    check(s, p, step);
    free(p);
    return stats.treelets_loaded;
}

static uint32_t refreshed(leafcast *v) {
    uint32_t steps = 0;
    if (leafcast_refresh(v, &steps) != LEAFCAST_OK)
        fail_msg("%s", leafcast_error_text());
    return steps;
}

/* All that is told of a volume is what one says that is opened now. */
static void check_told(const leafcast *v, const char *path) {
    leafcast *now;
    assert_int_equal(leafcast_open(path, NULL, &now), LEAFCAST_OK);
    const leafcast_info a = leafcast_describe(v), b = leafcast_describe(now);
    assert_int_equal(a.steps, b.steps);
    assert_int_equal(a.file_bytes, b.file_bytes);
    assert_int_equal(a.payload_bytes, b.payload_bytes);
    assert_true(a.value_min == b.value_min && a.value_max == b.value_max);
    for (uint32_t of = 0; of < FIELDS; of++)
        for (uint32_t step = 0; step < a.steps; step++) {
            double range[2][2];
            leafcast_histogram *h = calloc(2, sizeof *h);
            assert_int_equal(leafcast_range(v, of, step, range[0]), LEAFCAST_OK);
            assert_int_equal(leafcast_range(now, of, step, range[1]), LEAFCAST_OK);
            assert_memory_equal(range[0], range[1], sizeof range[0]);
            assert_int_equal(leafcast_get_histogram(v, of, step, &h[0]), LEAFCAST_OK);
            assert_int_equal(leafcast_get_histogram(now, of, step, &h[1]), LEAFCAST_OK);
            assert_memory_equal(&h[0], &h[1], sizeof *h);
            free(h);
            assert_true(leafcast_step_time(v, step) == 10.0 * step);
        }
    leafcast_close(now);
}

/* ---- growing ---- */

/* Draw; begin a frame; let the file grow; end the frame; draw all. */
static void grow(const stage *s, const leafcast_options *o) {
    leafcast *v = open_it(s->path, o);
    picture *p = calloc(1, sizeof *p);
    const leafcast_image image = {.size = sizeof image,
                                  .r = p->rgba[0],
                                  .g = p->rgba[1],
                                  .b = p->rgba[2],
                                  .a = p->rgba[3],
                                  .id = p->id,
                                  .z = p->z,
                                  .normal = {p->normal[0], p->normal[1], p->normal[2]},
                                  .provisional = p->provisional};
    leafcast_frame *frame;
    bool done;
    (void)draw(s, v, 0, 1);
    assert_true(draw(s, v, 1, 0) > 3 || o->memory);
    (void)draw(s, v, 0, 1); /* also reads what the rays of the set before have touched */
    assert_int_equal(draw(s, v, 1, 0) && !o->memory, 0);
    assert_int_equal(refreshed(v), FIRST);
    for (uint32_t steps = FIRST; steps < STEPS; steps += 2) {
        assert_int_equal(leafcast_frame_begin(v, &s->scene, &s->view, &image, &frame), LEAFCAST_OK);
        assert_int_equal(leafcast_frame_advance(frame, 0, &done, NULL), LEAFCAST_OK);
        const uint32_t more = steps + 2 < STEPS ? 2 : STEPS - steps;
        assert_int_equal(leafcast_select_set(v, 0, steps), LEAFCAST_USAGE);
        add(s, steps, more);
        assert_int_equal(leafcast_describe(v).steps, steps);
        assert_int_equal(refreshed(v), steps + more);
        assert_int_equal(refreshed(v), steps + more);
        assert_int_equal(leafcast_frame_advance(frame, INFINITY, &done, NULL), LEAFCAST_OK);
        assert_true(done);
        leafcast_frame_end(frame);
        check(s, p, 0);
        check_told(v, s->path);
        /* What was in memory still is. */
        assert_int_equal(draw(s, v, 1, 0) && !o->memory, 0);
        assert_int_equal(draw(s, v, 0, 1) && !o->memory, 0);
        (void)draw(s, v, 1, 0);
        memset(p, 0, sizeof *p);
    }
    for (uint32_t step = STEPS; step-- > 0;)
        for (uint32_t of = FIELDS; of-- > 0;)
            (void)draw(s, v, of, step);
    free(p);
    leafcast_close(v);
}

static void test_grow(void **state) {
    (void)state;
    for (int codec = WATCHED_THREADS ? LEAF_CODEC_ZSTD : LEAF_CODEC_RAW; codec <= LEAF_CODEC_ZSTD;
         codec++) {
        stage *s = stage_make((leaf_codec)codec);
        for (int backend = LEAFCAST_BACKEND_MAPPED; backend <= LEAFCAST_BACKEND_ARENA; backend++)
            for (uint64_t memory = 0; memory <= (WATCHED_THREADS ? 0 : 8 << 20);
                 memory += 8 << 20) {
                const leafcast_options o = {.size = sizeof o,
                                            .threads = 2,
                                            .memory = memory,
                                            .backend = (leafcast_backend)backend};
                begin(s, FIRST, "grown.leaf");
                grow(s, &o);
            }
        stage_free(s);
    }
}

/* ---- times between steps ---- */

static void draw_between(const stage *s, leafcast *v, uint32_t of, uint32_t step, picture *p) {
    assert_int_equal(leafcast_select_between(v, of, step, 0.375), LEAFCAST_OK);
    pictures_draw(v, &s->scene, &s->view, p, NULL);
}

/* What a moment shows is what a volume shows that is opened now. */
static void check_between(const stage *s, leafcast *v, uint32_t of, uint32_t step) {
    picture *p = malloc(2 * sizeof *p);
    leafcast *now = open_it(s->path, NULL);
    draw_between(s, v, of, step, &p[0]);
    draw_between(s, now, of, step, &p[1]);
    for (int i = 0; i < PICTURE_PIXELS; i++)
        assert_true(pictures_same_pixel(&p[0], &p[1], i));
    leafcast_close(now);
    free(p);
}

/* What threads keep decoded of one set is not taken for another's, whose payloads now have those
 * numbers. */
static void test_shells(void **state) {
    (void)state;
    skip_under_thread();
    stage *s = stage_of(LEAF_CODEC_ZSTD, 1);
    begin(s, STEPS - 1, "shells.leaf");
    leafcast *v = open_it(s->path, NULL);
    for (uint32_t step = STEPS - 3; step < STEPS - 1; step++)
        (void)draw(s, v, 0, step);
    picture *p = malloc(sizeof *p);
    for (uint32_t step = STEPS - 4; step < STEPS - 2; step++)
        draw_between(s, v, 0, step, p);
    free(p);
    add(s, STEPS - 1, 1);
    assert_int_equal(refreshed(v), STEPS);
    for (uint32_t step = 0; step < STEPS; step++)
        (void)draw(s, v, 0, step);
    for (uint32_t step = 0; step < STEPS - 1; step++)
        check_between(s, v, 0, step);
    leafcast_close(v);
    stage_free(s);
}

/* A frame between two steps ends as it began; moments after it have their steps' payloads. */
static void test_between(void **state) {
    (void)state;
    for (int codec = WATCHED_THREADS ? LEAF_CODEC_ZSTD : LEAF_CODEC_RAW; codec <= LEAF_CODEC_ZSTD;
         codec++) {
        stage *s = stage_make((leaf_codec)codec);
        const leafcast_options o = {.size = sizeof o, .threads = 2, .memory = 48 << 20};
        leafcast *v = open_it(s->path, &o); /* what is given up must be counted */
        picture *p = calloc(2, sizeof *p);
        draw_between(s, v, 1, 0, &p[0]);
        leafcast_frame *frame;
        bool done;
        const leafcast_image image = {.size = sizeof image, .id = p[1].id, .z = p[1].z};
        for (uint32_t steps = FIRST; steps < STEPS; steps++) {
            assert_int_equal(leafcast_select_between(v, 1, 0, 0.375), LEAFCAST_OK);
            assert_int_equal(leafcast_frame_begin(v, &s->scene, &s->view, &image, &frame),
                             LEAFCAST_OK);
            assert_int_equal(leafcast_frame_advance(frame, 0, &done, NULL), LEAFCAST_OK);
            add(s, steps, 1);
            assert_int_equal(refreshed(v), steps + 1);
            assert_int_equal(leafcast_frame_advance(frame, INFINITY, &done, NULL), LEAFCAST_OK);
            leafcast_frame_end(frame);
            assert_memory_equal(p[0].id, p[1].id, sizeof p->id);
            assert_memory_equal(p[0].z, p[1].z, sizeof p->z);
            check_between(s, v, 0, steps - 1);
            check_between(s, v, 1, steps - 1);
        }
        free(p);
        leafcast_close(v);
        stage_free(s);
    }
}

/* ---- meshes ---- */

enum { MESH_STEPS = 5, MESH_FIELDS = 2 };

static void put_mesh(mesh_movie *all, uint32_t first, uint32_t count, const char *path) {
    mem m;
    mesh_result r;
    mesh_series some = all->series;
    mesh_movie part = *all;
    mem_init(&m, 0);
    some.of.paths += first;
    some.of.sets.steps = count;
    some.of.sets.times += first;
    part.c.options.series = &some;
    part.c.options.grows = true;
    part.c.options.force = first == 0;
    if (first > 0)
        assert_int_equal(leaf_grow_open(&m, path, &part.c.options.grow), ST_OK);
    if (mesh_movies_convert(&m, &part, path, &r, false) != ST_OK)
        fail_msg("%s", status_text());
    leaf_grow_close(part.c.options.grow);
}

/* The middle of a set's values. */
static void draw_mesh(leafcast *v, uint32_t of, uint32_t step, picture *p, leafcast_stats *stats) {
    const leafcast_scene scene = leafcast_scene_default();
    leafcast_camera view = {.size = sizeof view};
    double range[2], iso = 0.4;
    assert_int_equal(leafcast_fit_view(v, 0, 0, &iso, 1, 0, PICTURE_WIDTH, PICTURE_HEIGHT, &view),
                     LEAFCAST_OK);
    assert_int_equal(leafcast_select_set(v, of, step), LEAFCAST_OK);
    assert_int_equal(leafcast_range(v, of, step, range), LEAFCAST_OK);
    const leafcast_surface surface = leafcast_surface_default(0.5 * (range[0] + range[1]));
    assert_int_equal(leafcast_select(v, &surface, 1), LEAFCAST_OK);
    pictures_draw(v, &scene, &view, p, stats);
}

/* Between a step and the next one. */
static void draw_mesh_between(leafcast *v, uint32_t of, uint32_t step, picture *p) {
    const leafcast_scene scene = leafcast_scene_default();
    draw_mesh(v, of, step, p, NULL); /* selects the surface */
    leafcast_camera view = {.size = sizeof view};
    const double iso = 0.4;
    assert_int_equal(leafcast_fit_view(v, 0, 0, &iso, 1, 0, PICTURE_WIDTH, PICTURE_HEIGHT, &view),
                     LEAFCAST_OK);
    assert_int_equal(leafcast_select_between(v, of, step, 0.375), LEAFCAST_OK);
    pictures_draw(v, &scene, &view, p, NULL);
}

/* Moments show what a volume shows that is opened now. */
static void check_mesh_between(leafcast *v, const char *path, uint32_t step) {
    picture *p = malloc(3 * sizeof *p);
    leafcast *now = open_it(path, NULL);
    for (uint32_t of = 0; of < MESH_FIELDS; of++) {
        int differ = 0;
        draw_mesh_between(v, of, step, &p[0]);
        draw_mesh_between(now, of, step, &p[1]);
        draw_mesh(now, of, step, &p[2], NULL);
        for (int i = 0; i < PICTURE_PIXELS; i++) {
            assert_true(pictures_same_pixel(&p[0], &p[1], i));
            differ += !pictures_same_pixel(&p[0], &p[2], i);
        }
        assert_true(differ > 20);
    }
    leafcast_close(now);
    free(p);
}

/* Of a mesh, too, what is in memory stays, and all sets are those of the file. */
static void grow_mesh(mesh_movie *all, const char *path, leafcast_schema schema) {
    const leafcast_experiments e = {.size = sizeof e, .schema = schema};
    const leafcast_options o = {.size = sizeof o, .threads = 2, .experiments = &e};
    picture *p = calloc(2, sizeof *p);
    leafcast *v, *now;
    leafcast_stats stats = {.size = sizeof stats};
    put_mesh(all, 0, 2, path);
    assert_int_equal(leafcast_open(path, &o, &v), LEAFCAST_OK);
    for (uint32_t steps = 2; steps < MESH_STEPS; steps++) {
        draw_mesh(v, 1, 1, &p[0], NULL);
        assert_int_equal(leafcast_select_set(v, 0, steps), LEAFCAST_USAGE);
        put_mesh(all, steps, 1, path);
        assert_int_equal(refreshed(v), steps + 1);
        draw_mesh(v, 1, 1, &p[1], &stats);
        assert_int_equal(stats.treelets_loaded, 0);
        for (int i = 0; i < PICTURE_PIXELS; i++)
            assert_true(pictures_same_pixel(&p[0], &p[1], i));
        check_mesh_between(v, path, 0); /* whose payloads have other numbers now */
        check_mesh_between(v, path, steps - 1);
    }
    assert_int_equal(leafcast_open(path, &o, &now), LEAFCAST_OK);
    for (uint32_t set = 0; set < MESH_STEPS * MESH_FIELDS; set++) {
        uint64_t hits = 0;
        draw_mesh(v, set % 2, set / 2, &p[0], NULL);
        draw_mesh(now, set % 2, set / 2, &p[1], NULL);
        for (int i = 0; i < PICTURE_PIXELS; i++) {
            assert_true(pictures_same_pixel(&p[0], &p[1], i));
            hits += isfinite(p[0].z[i]);
        }
        assert_true(hits > 100);
    }
    leafcast_close(now);
    leafcast_close(v);
    free(p);
}

static void test_mesh(void **state) {
    (void)state;
    for (int codec = WATCHED_THREADS ? LEAF_CODEC_ZSTD : LEAF_CODEC_RAW; codec <= LEAF_CODEC_ZSTD;
         codec++) {
        mesh_case c = mesh_cases_kuhn(9, 8, 7);
        mesh_cases_shuffle(&c, MESH_FIELDS);
        c.options.treelet_tets = 300;
        c.options.gradients = codec == LEAF_CODEC_ZSTD;
        c.options.file.codec = (leaf_codec)codec;
        c.options.file.zstd_level = 1;
        mesh_movie all = mesh_movies_make(c, MESH_FIELDS, MESH_STEPS, MESH_STEPS, 0);
        mesh_movies_write(&all);
        grow_mesh(&all, scratch_path("mesh.leaf"), LEAFCAST_SCHEMA_TREES);
        grow_mesh(&all, scratch_path("mesh.leaf"), LEAFCAST_SCHEMA_REFIT);
        mesh_movies_release(&all);
    }
}

/* ---- what changes nothing ---- */

static void fails(leafcast *v, const char *said) {
    const uint32_t before = leafcast_describe(v).steps;
    uint32_t steps = 77;
    assert_int_equal(leafcast_refresh(v, &steps), LEAFCAST_CORRUPT);
    if (!strstr(leafcast_error_text(), said))
        fail_msg("expected \"%s\": %s", said, leafcast_error_text());
    assert_int_equal(steps, 77);
    assert_int_equal(leafcast_describe(v).steps, before);
}

/* Overwrite a byte of the file. */
static void spoil(const char *path, long at) {
    FILE *f = fopen(path, "r+b");
    assert_non_null(f);
    assert_int_equal(fseek(f, at, SEEK_SET), 0);
    const int was = fgetc(f);
    assert_int_equal(fseek(f, at, SEEK_SET), 0);
    assert_int_equal(fputc(was ^ 0x55, f), was ^ 0x55);
    fclose(f);
}

static void test_refused(void **state) {
    (void)state;
    skip_under_thread();
    stage *s = stage_make(LEAF_CODEC_ZSTD);
    leafcast *v = open_it(s->path, NULL);
    assert_int_equal(leafcast_refresh(v, NULL), LEAFCAST_USAGE);
    /* Bytes behind the end are of a step that is being written. */
    const leafcast_info before = leafcast_describe(v);
    add(s, FIRST, 1);
    /* What has come is damaged: first its header, then its directory. */
    spoil(s->path, (long)before.file_bytes + 100);
    fails(v, "grown.leaf");
    spoil(s->path, (long)before.file_bytes + 100);
    (void)draw(s, v, 0, 1);
    assert_int_equal(refreshed(v), FIRST + 1);
    /* What is known is no longer there. */
    assert_int_equal(truncate(s->path, (off_t)before.file_bytes), 0);
    fails(v, "changed while it was open");
    leafcast_close(v);
    /* Another file has taken its place, with more steps. */
    begin(s, FIRST, "grown.leaf");
    v = open_it(s->path, NULL);
    (void)draw(s, v, 0, 1);
    const char *old = s->path;
    begin(s, FIRST, "other.leaf");
    add(s, FIRST, 2);
    assert_int_equal(rename(s->path, old), 0);
    fails(v, "another file has taken its place");
    leafcast_close(v);
    stage_free(s);
}

/* Write other bytes into a file that is open. */
static void overwrite(const char *path, const char *bytes, size_t size) {
    FILE *f = fopen(path, "wb");
    assert_non_null(f);
    assert_int_equal(fwrite(bytes, 1, size, f), size);
    fclose(f);
}

/* A file of the same name and inode, of other steps: from the first segment on, or from the second.
 */
static void test_rewritten(void **state) {
    (void)state;
    skip_under_thread();
    size_t size;
    stage *s = stage_make(LEAF_CODEC_ZSTD);
    char *bytes = scratch_read(s->path, &size);
    add(s, FIRST, 1);
    leafcast *v = open_it(s->path, NULL);
    const char *path = s->path;
    overwrite(path, bytes, size);
    free(bytes);
    add(s, FIRST + 1, 1);
    add(s, FIRST + 2, 1);
    fails(v, "its first 3 steps are not what they were");
    leafcast_close(v);
    v = open_it(s->path, NULL);
    s->c.options.file.cells_log2 = 5;
    begin(s, FIRST, "other.leaf");
    add(s, FIRST, 1);
    add(s, FIRST + 1, 1);
    add(s, FIRST + 2, 1);
    bytes = scratch_read(s->path, &size);
    overwrite(path, bytes, size);
    free(bytes);
    fails(v, "changed while it was open");
    leafcast_close(v);
    stage_free(s);
}

/* Whatever allocation or read fails: the volume is as it was, and takes the steps in later. */
static void test_faults(void **state) {
    (void)state;
    skip_under_thread();
    stage *s = stage_make(LEAF_CODEC_ZSTD);
    const leafcast_options o = {.size = sizeof o, .threads = 1, .backend = LEAFCAST_BACKEND_MAPPED};
    leafcast *v = open_it(s->path, &o);
    uint32_t steps = 0;
    int failed[2] = {0};
    (void)draw(s, v, 1, 1);
    add(s, FIRST, STEPS - FIRST);
    for (int kind = 0; kind < 2; kind++) {
        bool fired = true;
        for (long k = 1; fired; k++) {
            fault_arm(kind ? FAULT_READ : FAULT_ALLOC, k);
            const leafcast_status st = leafcast_refresh(v, &steps);
            fired = fault_fired(kind ? FAULT_READ : FAULT_ALLOC);
            fault_arm(kind ? FAULT_READ : FAULT_ALLOC, 0);
            if (st == LEAFCAST_OK)
                break;
            assert_true(fired);
            assert_int_equal(st, kind ? LEAFCAST_IO : LEAFCAST_NOMEM);
            assert_int_equal(leafcast_describe(v).steps, FIRST);
            failed[kind]++;
            if (k % 8 == 0)
                assert_int_equal(draw(s, v, 1, 1), 0);
        }
        if (kind == 0) { /* taken in: begin again */
            assert_int_equal(steps, STEPS);
            (void)draw(s, v, 0, 4);
            leafcast_close(v);
            begin(s, FIRST, "again.leaf");
            v = open_it(s->path, &o);
            (void)draw(s, v, 1, 1);
            add(s, FIRST, STEPS - FIRST);
        }
    }
    assert_int_equal(steps, STEPS);
    assert_true(failed[0] > 20 && failed[1] > 5);
    assert_int_equal(draw(s, v, 1, 1), 0);
    (void)draw(s, v, 1, 4);
    leafcast_close(v);
    stage_free(s);
}

/* ---- others ---- */

typedef struct reader {
    const stage *s;
    leafcast *v;
    atomic_bool ends;
} reader;

/* Ask for all that is told without the device's lock, of the newest step. */
static void *ask(void *ctx) {
    reader *r = ctx;
    while (!atomic_load(&r->ends)) {
        const leafcast_info info = leafcast_describe(r->v);
        const uint32_t last = info.steps - 1;
        leafcast_camera view = {.size = sizeof view};
        leafcast_histogram h;
        double range[2], iso[4];
        int count;
        bool right = leafcast_range(r->v, 1, last, range) == LEAFCAST_OK;
        right &= leafcast_data_range(r->v, 1, last, range) == LEAFCAST_OK;
        right &= leafcast_get_histogram(r->v, 1, last, &h) == LEAFCAST_OK;
        right &= leafcast_suggested_isovalues(r->v, 0, last, iso, 4, &count) == LEAFCAST_OK;
        right &= leafcast_fit_view(r->v, 1, last, &ISO, 1, 0, 10, 10, &view) == LEAFCAST_OK;
        right &= leafcast_step_time(r->v, last) == 10.0 * last;
        right &= strcmp(leafcast_field_name(r->v, 1), "heat") == 0;
        if (!right)
            return r;
    }
    return NULL;
}

/* Draw without an end; each picture is of its step. */
static void *paint(void *ctx) {
    reader *r = ctx;
    picture *p = malloc(sizeof *p);
    bool right = true;
    const leafcast_image image = {.size = sizeof image, .z = p->z, .id = p->id};
    while (!atomic_load(&r->ends) && right) {
        const leafcast_surface surface = leafcast_surface_default(ISO);
        const uint32_t last = leafcast_describe(r->v).steps - 1;
        const leafcast_shown shown = {r->v, 1, last, &surface, 1, 0.0, NULL, NULL, NULL};
        leafcast_scene scene = r->s->scene;
        scene.volumes = &shown;
        scene.volume_count = 1;
        right = leafcast_trace(r->v, &scene, &r->s->view, &image, NULL, NULL, NULL) == LEAFCAST_OK;
        for (int i = 0; i < PICTURE_PIXELS && right; i++)
            right = p->id[i] == r->s->want[last].id[i] && p->z[i] == r->s->want[last].z[i];
    }
    free(p);
    return right ? NULL : r;
}

static void test_threads(void **state) {
    (void)state;
    static void *(*const run[])(void *) = {ask, paint, ask};
    enum { THREADS = sizeof run / sizeof *run };
    stage *s = stage_make(LEAF_CODEC_ZSTD);
    const leafcast_options o = {.size = sizeof o, .threads = 2};
    reader r = {.s = s, .v = open_it(s->path, &o)};
    pthread_t threads[THREADS];
    for (int i = 0; i < THREADS; i++)
        assert_int_equal(pthread_create(&threads[i], NULL, run[i], &r), 0);
    for (uint32_t steps = FIRST; steps < STEPS; steps++) {
        add(s, steps, 1);
        assert_int_equal(refreshed(r.v), steps + 1);
    }
    atomic_store(&r.ends, true);
    for (int i = 0; i < THREADS; i++) {
        void *wrong;
        pthread_join(threads[i], &wrong);
        assert_null(wrong);
    }
    (void)draw(s, r.v, 1, STEPS - 1);
    leafcast_close(r.v);
    stage_free(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_grow),    cmocka_unit_test(test_shells),
        cmocka_unit_test(test_between), cmocka_unit_test(test_mesh),
        cmocka_unit_test(test_refused), cmocka_unit_test(test_rewritten),
        cmocka_unit_test(test_faults),  cmocka_unit_test(test_threads),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
