/* crash.h - for importers: a library that crashes over a broken file ends the program with a word.
 *
 * The samples of a file whose reader crashed are not to be had, whoever is to blame: one line on
 * standard error says so, and the exit status is that of malformed input.
 */
#ifndef PREP_IMPORT_CRASH_H
#define PREP_IMPORT_CRASH_H

/* crash_watch() - from now on. verb, library and path must stay. One call. */
void crash_watch(const char *verb, const char *library, const char *path);

#endif
