/* convert_report.h - what convert tells on standard output of what it has done, or would do with
 * --dry-run: lines, or with --json an object. Here is what the reports of all kinds share.
 */
#ifndef PREP_CONVERT_REPORT_H
#define PREP_CONVERT_REPORT_H

#include <jansson.h>

#include "prep/convert_request.h"

/* convert_report_peak() - returns the most memory of the process so far, in bytes. */
uint64_t convert_report_peak(void);

/* convert_report_print_bytes() - print the size of the file, and what was added to it, if it was.
 * each: the size of what was converted, in words.
 * convert_report_set_bytes() - set both in an object. added: bytes of what was converted. */
void convert_report_print_bytes(const convert_request *a, uint64_t added, const char *each);
void convert_report_set_bytes(json_t *json, const convert_request *a, uint64_t added);

/* convert_report_print_sets() - print fields and steps. convert_report_set_sets() - set them in an
 * object. field: the name of the only field; "": it has none. */
void convert_report_print_sets(const convert_request *a, const char *field);
void convert_report_set_sets(json_t *json, const convert_request *a, const char *field);

#endif
