/* export_request.h - what the command line of export asks for: of which fields and steps. */
#ifndef PREP_EXPORT_EXPORT_REQUEST_H
#define PREP_EXPORT_EXPORT_REQUEST_H

#include "formats/base/cli.h"
#include "formats/leaf/leaf_file.h"
#include "prep/export/piece_format.h"
#include "prep/export/sample_format.h"

enum { EXPORT_ISOS_MAX = 64, EXPORT_FIELDS_MAX = 64 };

typedef struct export_request {
    cli_common common;
    const char *format_name;
    const sample_format *samples; /* exactly one of the two is set */
    const piece_format *pieces;
    bool gzip;
    uint32_t level, box[6];
    bool boxed; /* the box is given */
    double isos[EXPORT_ISOS_MAX];
    uint32_t iso_count;
    bool floats;
    const char *fields[EXPORT_FIELDS_MAX];
    uint32_t field_count, step;
    bool all_steps;
    bool given; /* the file is of a surface: its triangles are written, with values of fields */
} export_request;

/* Where it goes: to standard output, to a file for each slice, to a folder. */
bool export_request_to_stdout(const export_request *a);
bool export_request_is_sequence(const export_request *a);
bool export_request_is_folder(const export_request *a);

/* export_request_field() - find a field by its name. export_request_step() - whether the file has
 * the step. ST_USAGE: it has not. */
CHECKED status export_request_field(const leaf_file *f, const char *name, uint32_t *index);
CHECKED status export_request_step(const export_request *a, const leaf_file *f);

/* The chosen fields with their names. */
typedef struct export_fields {
    uint32_t *fields, *sets; /* sets: of each field at the step, or of the first field at all
                                steps */
    char (*texts)[80];
    const char **names;
    uint32_t count;
} export_fields;

/* export_request_fields() - list the fields that are asked for. Release them in any case. */
CHECKED status export_request_fields(const export_request *a, mem *m, const leaf_file *f,
                                     export_fields *l);
void export_request_release(mem *m, export_fields *l);

#endif
