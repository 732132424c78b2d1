/* bus_error.h - for main programs: end with a message when a mapped file cannot be read.
 *
 * Touching a page behind the end of a mapped file raises SIGBUS. So does a page that the disk fails
 * to give. The handler writes one line that names the file to standard error, and ends the program.
 * The exit status is that of malformed input where the file became shorter, else that of a failed
 * read. A SIGBUS of another cause ends the program as usual. The library itself installs no
 * handler.
 */
#ifndef FORMATS_BASE_BUS_ERROR_H
#define FORMATS_BASE_BUS_ERROR_H

#include <stdbool.h>

/* bus_error_install() - install the handler. command: what messages begin with ("leafcast render");
 * the text must stay valid. */
void bus_error_install(const char *command);

/* bus_error_installed() - whether it is: whether a file may be mapped without being asked for. */
bool bus_error_installed(void);

#endif
