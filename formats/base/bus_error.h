/* bus_error.h - for main programs: a mapped file that cannot be read ends the program with a word.
 *
 * Touching a page behind the end of a mapped file raises SIGBUS, and so does one that its disk
 * fails to give. The handler writes one line that names the file to standard error. It ends the
 * program with the exit status of other bad input where the file became shorter, and else with that
 * of a failed read. Other reasons for SIGBUS end it as usual. The library itself installs no
 * handler.
 */
#ifndef FORMATS_BASE_BUS_ERROR_H
#define FORMATS_BASE_BUS_ERROR_H

/* bus_error_install() - command: what messages begin with ("leafcast render"); it must stay. */
void bus_error_install(const char *command);

#endif
