/* library_crash.h - for importers: a library that crashes on a damaged file ends the program with a
 * word, and with the exit status of bad input.
 *
 * SIGSEGV, SIGBUS, SIGFPE, SIGILL and SIGABRT count as such. What was written so far is left as a
 * kill leaves it; see partial.h.
 */
#ifndef PREP_IMPORT_LIBRARY_CRASH_H
#define PREP_IMPORT_LIBRARY_CRASH_H

/* library_crash_install() - what the words name: the verb, the format and the input; they must
 * stay. */
void library_crash_install(const char *verb, const char *format, const char *input);

#endif
