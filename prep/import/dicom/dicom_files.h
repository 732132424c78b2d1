/* dicom_files.h - lists the files of a command line's arguments, also those in folders. */
#ifndef PREP_IMPORT_DICOM_DICOM_FILES_H
#define PREP_IMPORT_DICOM_DICOM_FILES_H

#include <stdbool.h>
#include <stddef.h>

#include "formats/base/mem.h"

typedef struct dicom_files {
    mem *m;
    char **path;
    size_t count, room, named; /* the first `named` were on the command line */
} dicom_files;

/* dicom_files_find() - list files as given, and all regular files in and below folders, sorted by
 * name. Links to folders are not followed. ST_IO, ST_NOMEM. Release the list in any case. */
CHECKED status dicom_files_find(mem *m, char *const *paths, int count, dicom_files *out);
void dicom_files_release(dicom_files *f);

#endif
