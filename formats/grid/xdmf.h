/* xdmf.h - grids of XDMF (.xdmf, .xmf): 3DCoRectMesh and 3DRectMesh, whose samples lie in HDF5 or
 * in raw files; a temporal collection's grids are the steps.
 *
 * Samples in HDF5 are read by import-hdf5, as if the data set had been asked for there; where they
 * lie is what the XDMF file says.
 */
#ifndef FORMATS_GRID_XDMF_H
#define FORMATS_GRID_XDMF_H

#include "formats/grid/grid_reader.h"

extern const grid_reader xdmf_reader;

#endif
