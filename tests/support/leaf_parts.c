#include "tests/support/leaf_parts.h"

#include <setjmp.h>
#include <stdarg.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>

#include "formats/leaf/leaf_file.h"
#include "formats/leaf/leaf_order.h"

static void add(leaf_parts *p, leaf_range_kind kind, bool coarse, uint64_t at, uint64_t bytes) {
    p->all = realloc(p->all, (p->count + 1) * sizeof *p->all);
    assert_non_null(p->all);
    p->all[p->count++] = (leaf_range){kind, coarse, at, bytes};
}

static void add_file(leaf_parts *p, leaf_file *f, bool coarse, uint64_t base) {
    leaf_section table[LEAF_SECTIONS_MAX];
    const size_t size = f->header.sections * sizeof *table;
    assert_int_equal(file_read_at(f->source, leaf_table_at(&f->header), table, size), ST_OK);
    add(p, PART_HEADER, coarse, base, LEAF_HEADER_BYTES);
    add(p, PART_TABLE, coarse, base + leaf_table_at(&f->header), size);
    for (uint32_t i = 0; i < f->header.sections; i++)
        add(p, PART_SECTION, coarse, base + table[i].offset, table[i].bytes);
    for (leaf_order o = leaf_order_begin(&f->layout); o.p < f->layout.payloads;
         leaf_order_next(&o, &f->layout))
        if (leaf_file_is_home(f, o.p))
            add(p, PART_PAYLOAD, coarse, base + f->offsets[o.p], f->sizes[o.p]);
}

/* at: where f lies. */
static void add_coarse(leaf_parts *p, mem *m, const leaf_file *f, uint64_t at) {
    for (uint32_t set = 0; set < f->layout.sets; set++) {
        leaf_file *coarse = NULL;
        if (!leaf_file_has_coarse(f, set))
            continue;
        assert_int_equal(leaf_file_open_coarse(m, f, set, &coarse), ST_OK);
        add_file(p, coarse, true, at + f->coarse[set].offset);
        add_coarse(p, m, coarse, at + f->coarse[set].offset);
        leaf_file_close(coarse);
    }
}

leaf_parts leaf_parts_of(const char *path) {
    leaf_parts p = {0};
    mem m;
    leaf_file *f = NULL;
    mem_init(&m, 0);
    assert_int_equal(leaf_file_open(&m, path, &f), ST_OK);
    if (f->header.segments < 2)
        add_file(&p, f, false, 0);
    for (uint32_t i = 0; f->header.segments > 1 && i < f->header.segments; i++) {
        leaf_file *part = NULL;
        assert_int_equal(leaf_file_open_segment(&m, f, &f->segments[i], &part), ST_OK);
        add_file(&p, part, false, f->segments[i].base);
        leaf_file_close(part);
    }
    add_coarse(&p, &m, f, 0);
    leaf_file_close(f);
    return p;
}

leaf_range leaf_parts_find(const leaf_parts *p, leaf_range_kind kind, bool coarse, size_t skip) {
    for (size_t i = 0; i < p->count; i++)
        if (p->all[i].kind == kind && p->all[i].coarse == coarse && skip-- == 0)
            return p->all[i];
    fail_msg("no such part");
    return p->all[0];
}

uint64_t leaf_parts_gap(const leaf_parts *p) {
    for (size_t i = p->count - 1; i > 0; i--) {
        const uint64_t end = p->all[i - 1].at + p->all[i - 1].bytes;
        if (!p->all[i].coarse && end < p->all[i].at)
            return end;
    }
    fail_msg("no gap");
    return 0;
}

void leaf_parts_damage(const char *path, uint64_t at) {
    FILE *raw = fopen(path, "r+b");
    assert_non_null(raw);
    assert_int_equal(fseek(raw, (long)at, SEEK_SET), 0);
    const int byte = fgetc(raw);
    assert_int_equal(fseek(raw, (long)at, SEEK_SET), 0);
    assert_int_equal(fputc(byte ^ 1, raw), byte ^ 1);
    assert_int_equal(fclose(raw), 0);
}
