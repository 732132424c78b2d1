/* pvm.h - PVM volumes of V^3: PVM, PVM2, PVM3, plain or packed as DDS.
 *
 * Format: http://paulbourke.net/dataformats/pvm and dds_stream.h. Understood: one byte a voxel, or
 * two, most significant first; three or four as a colour; relative sizes of voxels as spacings. The
 * texts behind the samples of PVM3 are skipped.
 */
#ifndef FORMATS_GRID_PVM_H
#define FORMATS_GRID_PVM_H

#include "formats/grid/grid_reader.h"

extern const grid_reader pvm_reader;

#endif
