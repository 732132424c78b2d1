/* work_folder.h - work on an output that another run can go on with.
 *
 * PATH.unfinished is a folder beside the output PATH. It holds the files of the work and, once it
 * was worth saving, the job's state: all that is needed to go on from there, in two files used in
 * turn, so that the last state stays until the next one is on the disk. The files' own bytes are on
 * the disk before a state is. One process at a time works in it: it is locked with flock(). What a
 * run leaves there without a state is removed by the next one. Files that nobody here has made are
 * never removed, links never followed.
 */
#ifndef FORMATS_BASE_WORK_FOLDER_H
#define FORMATS_BASE_WORK_FOLDER_H

#include "formats/base/file.h"
#include "formats/base/state_io.h"

typedef struct work_folder work_folder;

/* What to do with a state that is there. */
typedef enum work_found {
    WORK_REFUSE, /* ST_EXISTS, naming the ways out */
    WORK_REMOVE,
    WORK_RESUME
} work_found;

/* The files of the work. Those from WORK_POINTS on belong to meshes. */
typedef enum work_file {
    WORK_OUTPUT,
    WORK_WAITING,
    WORK_POINTS,
    WORK_VALUES,
    WORK_TETS,
    WORK_RUNS,
    WORK_GRADIENTS,
    WORK_FILES
} work_file;

/* work_folder_open() - make or open an output's folder, and lock it. ST_EXISTS: another process
 * works in it, something else has its name, or as `found` says. every: seconds that pass at least
 * between two states; more, if saving takes more than a twentieth of the time. */
CHECKED status work_folder_open(mem *m, const char *output, work_found found, double every,
                                work_folder **out);

/* work_folder_resumes() - whether there is a state to go on from. work_folder_published() - whether
 * the output had got its name when that run ended: nothing is left to be done.
 * work_folder_share() - of the job that the last state says is done.
 * work_folder_states() - the number of states saved so far, by this run and those before. */
bool work_folder_resumes(const work_folder *w);
bool work_folder_published(const work_folder *w);
double work_folder_share(const work_folder *w);
uint64_t work_folder_states(const work_folder *w);

/* work_folder_file() - a file of the work; of a run that resumes, with what it holds. The output
 * gets its name by out_file_commit(). The caller closes it by that, or by out_file_discard(),
 * before the folder. work_folder_drop() - remove one that is closed, and that no state needs. */
CHECKED status work_folder_file(work_folder *w, work_file which, bool force, out_file **out);
void work_folder_drop(work_folder *w, work_file which);

/* work_folder_due() - whether enough time has passed to save a state.
 * work_folder_save() - wait until the bytes of these files are on the disk, then save a state.
 * Where the disk has no room for it, the one before it stays, and all goes on. files: NULL for
 * those that are not open. work_folder_load() - load the last one. */
bool work_folder_due(const work_folder *w);
CHECKED status work_folder_save(work_folder *w, out_file *const files[WORK_FILES], double share,
                                state_io_part part, void *ctx);
CHECKED status work_folder_load(work_folder *w, state_io_part part, void *ctx);

/* work_folder_close() - leave it for another run if it has a state and `keep` says so, else remove
 * it. Returns whether it was left. NULL is fine: false. */
bool work_folder_close(work_folder *w, bool keep);

#endif
