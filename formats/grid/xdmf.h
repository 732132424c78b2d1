/* xdmf.h - grids of XDMF (.xdmf, .xmf): 3DCoRectMesh and 3DRectMesh, whose samples lie in HDF5 or
 * in raw files. The grids of a temporal collection are the steps.
 *
 * import-hdf5 reads samples in HDF5, as if the data set had been asked for there. The XDMF file
 * says where they lie in the world.
 */
#ifndef FORMATS_GRID_XDMF_H
#define FORMATS_GRID_XDMF_H

#include "formats/grid/grid_reader.h"

extern const grid_reader xdmf_reader;

#endif
