/* bus_error.h - for main programs: a mapped file that is cut short ends the program with a word.
 *
 * Touching a page behind the end of a mapped file raises SIGBUS. The handler writes one line that
 * names the file to standard error and ends the program with exit status 3, as other bad input
 * does. Other reasons for SIGBUS end it as usual. The library itself installs no handler.
 */
#ifndef FORMATS_BASE_BUS_ERROR_H
#define FORMATS_BASE_BUS_ERROR_H

/* bus_error_install() - command: what messages begin with ("leafcast render"); it must stay. */
void bus_error_install(const char *command);

#endif
