#include "prep/convert_report.h"

#include <stdio.h>
#include <sys/resource.h>

#include "prep/convert_append.h"

uint64_t convert_report_peak(void) {
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    return (uint64_t)usage.ru_maxrss * 1024;
}

void convert_report_print_bytes(const convert_request *a, uint64_t added, const char *each) {
    const double all = (double)convert_append_bytes(a, added) / 0x1p20;
    if (a->grow)
        printf("file        %.1f MiB, with %llu bytes added, %s\n", all, (unsigned long long)added,
               each);
    else
        printf("file        %.1f MiB, %s\n", all, each);
}

void convert_report_set_bytes(json_t *json, const convert_request *a, uint64_t added) {
    const uint64_t all = convert_append_bytes(a, added);
    json_object_set_new(json, "file_bytes", json_integer((json_int_t)all));
    if (a->append)
        json_object_set_new(json, "added_bytes", json_integer((json_int_t)added));
}

/* field: name of the only field; "": it has none. */
void convert_report_print_sets(const convert_request *a, const char *field) {
    if (a->sets.count > 1)
        for (int i = 0; i < a->sets.count; i++)
            printf("%s%s\n", i ? "            " : "fields      ", a->sets.names[i]);
    else if (*field)
        printf("field       %s\n", field);
    const uint32_t steps = convert_request_steps(a);
    if (steps > 1)
        printf("steps       %u\n", steps);
}

/* field: as for print_sets(). */
void convert_report_set_sets(json_t *json, const convert_request *a, const char *field) {
    json_t *fields = json_array();
    for (int i = 0; i < a->sets.count; i++)
        json_array_append_new(fields, json_string(a->sets.names[i]));
    if (a->sets.count == 0)
        json_array_append_new(fields, json_string(field));
    json_object_set_new(json, "steps", json_integer(convert_request_steps(a)));
    json_object_set_new(json, "fields", fields);
}
