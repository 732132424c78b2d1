/* tool_convert.c INPUT OUTPUT - a host program: leafcast_convert_path(), and what is there gives
 * way. Prints why not; exits with the status.
 */
#include <stdio.h>

#include "prep/leafcast_prep.h"

int main(int argc, char **argv) {
    const leafcast_convert_options o = {
        .size = sizeof o, .replace = true, .allow_empty = true, .threads = 2};
    if (argc != 3) {
        fprintf(stderr, "tool_convert: INPUT OUTPUT\n");
        return LEAFCAST_USAGE;
    }
    const leafcast_status st = leafcast_convert_path(argv[1], argv[2], &o);
    if (st != LEAFCAST_OK)
        fprintf(stderr, "%s\n", leafcast_error_text());
    return (int)st;
}
