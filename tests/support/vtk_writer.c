#include "tests/support/vtk_writer.h"

#include <setjmp.h>
#include <stdarg.h>

#include <cmocka.h>
#include <lz4.h>
#include <lzma.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "tests/support/scratch.h"

static void put_bytes(FILE *out, const void *value, size_t width, bool big) {
    const uint8_t *bytes = value; /* little endian, as all machines the tests run on */
    for (size_t i = 0; i < width; i++)
        fputc(bytes[big ? width - 1 - i : i], out);
}

#define PUT(name, type_name)               \
    if (strcmp(type, name) == 0) {         \
        type_name v = (type_name)number;   \
        put_bytes(out, &v, sizeof v, big); \
    }

static void put_number(FILE *out, const char *type, double number, bool big) {
    PUT("Float32", float)
    PUT("Float64", double)
    PUT("Int8", int8_t)
    PUT("UInt8", uint8_t)
    PUT("Int16", int16_t)
    PUT("UInt16", uint16_t)
    PUT("Int32", int32_t)
    PUT("UInt32", uint32_t)
    PUT("Int64", int64_t)
    PUT("UInt64", uint64_t)
}

/* ---- XML ---- */

static void text_begin(vtk_writer_text *b) {
    b->out = open_memstream(&b->data, &b->size);
    assert_non_null(b->out);
}

static void text_end(vtk_writer_text *b) {
    fclose(b->out);
}

/* Base64 of bytes, a line end after each 20 letters: readers have to pass over them. */
static void put_base64(FILE *out, const uint8_t *data, size_t size) {
    static const char letters[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < size; i += 3) {
        uint32_t bits = (uint32_t)data[i] << 16;
        bits |= i + 1 < size ? (uint32_t)data[i + 1] << 8 : 0;
        bits |= i + 2 < size ? data[i + 2] : 0;
        fputc(letters[bits >> 18], out);
        fputc(letters[bits >> 12 & 63], out);
        fputc(i + 1 < size ? letters[bits >> 6 & 63] : '=', out);
        fputc(i + 2 < size ? letters[bits & 63] : '=', out);
        if (i % 15 == 12)
            fputc('\n', out);
    }
}

static void put_head(FILE *out, const vtk_xml_style *s, uint64_t number) {
    put_bytes(out, &number, s->head64 ? 8 : 4, s->big_endian);
}

static size_t pack_block(const vtk_xml_style *s, const char *data, size_t size, char packed[8192]) {
    size_t at = 0;
    if (s->packing == VTK_WRITER_LZ4)
        return (size_t)LZ4_compress_default(data, packed, (int)size, 8192);
    if (s->packing == VTK_WRITER_LZMA) {
        assert_int_equal(lzma_easy_buffer_encode(0, LZMA_CHECK_CRC32, NULL, (const uint8_t *)data,
                                                 size, (uint8_t *)packed, &at, 8192),
                         LZMA_OK);
        return at;
    }
    uLongf room = 8192;
    assert_int_equal(compress2((Bytef *)packed, &room, (const Bytef *)data, size, 9), Z_OK);
    return room;
}

/* The head, and the blocks behind it. */
static void pack(const vtk_xml_style *s, const vtk_writer_text *plain, FILE *head, FILE *body) {
    if (!s->block) {
        put_head(head, s, plain->size);
        fwrite(plain->data, 1, plain->size, body);
        return;
    }
    size_t blocks = (plain->size + s->block - 1) / s->block;
    put_head(head, s, blocks);
    put_head(head, s, s->block);
    put_head(head, s, plain->size % s->block);
    for (size_t i = 0; i < blocks; i++) {
        char packed[8192];
        size_t at = i * s->block, left = plain->size - at;
        size_t size = pack_block(s, plain->data + at, left < s->block ? left : s->block, packed);
        put_head(head, s, size);
        fwrite(packed, 1, size, body);
    }
}

/* Numbers as they stand in the file. */
static void put_coded(FILE *out, const vtk_xml_style *s, const vtk_writer_text *plain) {
    vtk_writer_text head, body;
    text_begin(&head);
    text_begin(&body);
    pack(s, plain, head.out, body.out);
    text_end(&head);
    text_end(&body);
    if (s->appended && s->raw) {
        fwrite(head.data, 1, head.size, out);
        fwrite(body.data, 1, body.size, out);
    } else if (s->block || s->split_head) {
        put_base64(out, (const uint8_t *)head.data, head.size);
        put_base64(out, (const uint8_t *)body.data, body.size);
    } else {
        head.data = realloc(head.data, head.size + body.size);
        memcpy(head.data + head.size, body.data, body.size);
        put_base64(out, (const uint8_t *)head.data, head.size + body.size);
    }
    free(head.data);
    free(body.data);
}

void vtk_writer_array(vtk_writer *x, const char *name, const char *type, int components,
                      size_t count, const double *numbers) {
    const vtk_xml_style *s = x->style;
    fprintf(x->out, "<DataArray type=\"%s\" Name=\"%s\" NumberOfComponents=\"%d\" ", type, name,
            components);
    if (s->text) {
        fprintf(x->out, "format=\"ascii\">\n");
        for (size_t i = 0; i < count; i++)
            fprintf(x->out, "%.17g%c", numbers[i], i % 6 == 5 ? '\n' : ' ');
    } else {
        vtk_writer_text plain;
        text_begin(&plain);
        for (size_t i = 0; i < count; i++)
            put_number(plain.out, type, numbers[i], s->big_endian);
        text_end(&plain);
        fflush(x->appended.out);
        if (s->appended)
            fprintf(x->out, "format=\"appended\" offset=\"%zu\">", x->appended.size);
        else
            fprintf(x->out, "format=\"binary\">\n ");
        put_coded(s->appended ? x->appended.out : x->out, s, &plain);
        free(plain.data);
    }
    fprintf(x->out, "\n</DataArray>\n");
}

void vtk_writer_open(vtk_writer *w) {
    *w = (vtk_writer){0};
    text_begin(&w->file);
    w->out = w->file.out;
}

const char *vtk_writer_close(vtk_writer *w, const char *name) {
    text_end(&w->file);
    const char *path = scratch_write(name, w->file.data, w->file.size);
    free(w->file.data);
    return path;
}

void vtk_writer_begin(vtk_writer *w, const char *type, const vtk_xml_style *style) {
    static const char *const compressors[] = {" compressor=\"vtkZLibDataCompressor\"",
                                              " compressor=\"vtkLZ4DataCompressor\"",
                                              " compressor=\"vtkLZMADataCompressor\""};
    vtk_writer_open(w);
    w->style = style;
    text_begin(&w->appended);
    fprintf(w->out,
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"%s\" version=\"1.0\" "
            "byte_order=\"%s\" header_type=\"%s\"%s>\n",
            type, style->big_endian ? "BigEndian" : "LittleEndian",
            style->head64 ? "UInt64" : "UInt32", style->block ? compressors[style->packing] : "");
}

const char *vtk_writer_end(vtk_writer *w, const char *name) {
    text_end(&w->appended);
    if (w->style->appended) {
        fprintf(w->out, "<AppendedData encoding=\"%s\">\n _", w->style->raw ? "raw" : "base64");
        fwrite(w->appended.data, 1, w->appended.size, w->out);
        fprintf(w->out, "\n</AppendedData>\n");
    }
    free(w->appended.data);
    fprintf(w->out, "</VTKFile>\n");
    return vtk_writer_close(w, name);
}

/* ---- legacy ---- */

/* Numbers of a legacy file; its name for the type comes from the caller. */
void vtk_writer_numbers(FILE *out, bool text, const char *type, size_t count,
                        const double *numbers) {
    for (size_t i = 0; i < count; i++) {
        if (text)
            fprintf(out, "%.17g%s", numbers[i], i % 9 == 8 ? " \n" : " ");
        else
            put_number(out, type, numbers[i], true);
    }
    fprintf(out, "\n");
}
