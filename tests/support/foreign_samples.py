#!/usr/bin/env python3
"""foreign_samples.py FOLDER SOURCE - a small file of each format that is known by sight and read by nothing here.

Each is written as the format's own description says. One line for each is told: the format's name in the table of
SOURCE (formats/input/foreign.c), a tab, the path. It fails where a REFUSED row of the table has no file.
"""
import os
import re
import struct
import sys

folder, source = sys.argv[1:3]


def text(*lines):
    return ("\n".join(lines) + "\n").encode()


def xml(kind):
    return b'<?xml version="1.0"?>\n<VTKFile type="%s" version="0.1" byte_order="LittleEndian">\n' % kind.encode()


def legacy(kind):
    return text("# vtk DataFile Version 3.0", "title", "ASCII", "DATASET " + kind)


def hdf5(*names):
    """As much of a file as tells: the signature, a superblock of version 0, names in a local heap."""
    return b"\x89HDF\r\n\x1a\n".ljust(600, b"\0") + b"HEAP" + bytes(28) + b"\0".join(n.encode() for n in names) + bytes(64)


def record(data, order="<"):
    """One of an unformatted file of Fortran."""
    size = struct.pack(order + "i", len(data))
    return size + data + size


def tar():
    return bytearray(257) + b"ustar\x0000" + bytes(248)


CUBE = text("a density", "OUTER LOOP: X, MIDDLE LOOP: Y, INNER LOOP: Z", "    1    0.000000    0.000000    0.000000",
            "    2    0.283459    0.000000    0.000000", "    2    0.000000    0.283459    0.000000",
            "    2    0.000000    0.000000    0.283459", "    8    0.000000    5.570575    5.669178    5.593517",
            "  1.0E+00  2.0E+00", "  3.0E+00  4.0E+00", "  5.0E+00  6.0E+00", "  7.0E+00  8.0E+00")
FOAM = text("/*----------------------*\\", "| a banner |", "\\*----------------------*/", "FoamFile", "{", "    version 2.0;",
            "    format ascii;", "    class dictionary;", "    object controlDict;", "}")
PAR = text("# === DATA DESCRIPTION FILE ======================================================", "#",
           "# Dataset name: head", "# CLINICAL TRYOUT             Research image export tool     V4.2")
GADGET = record(struct.pack("<6I", 0, 8, 0, 0, 0, 0) + bytes(232))

# The name in the table; the file; what is in it (a dict: a folder).
SAMPLES = [
    ("Analyze 7.5", "little.hdr", b"\x5c\x01\0\0" + bytes(344)),
    ("Analyze 7.5", "big.hdr", b"\0\0\x01\x5c" + bytes(344)),
    ("JPEG 2000", "a.jp2", b"\0\0\0\x0cjP  \r\n\x87\n" + bytes(64)),
    ("MED", "mesh", hdf5("INFOS_GENERALES", "ENS_MAA")),
    ("MED", "mesh.med", hdf5("a")),
    ("GADGET, particles", "snap_000.hdf5", hdf5("Header", "PartType0")),
    ("GADGET, particles", "snapshot_000", GADGET + record(bytes(96))),
    ("GADGET, particles", "snapshot_big", record(bytes(256), ">") + record(bytes(96), ">")),
    ("GADGET, particles", "snapshot_2", record(b"HEAD" + struct.pack("<i", 264)) + GADGET),
    ("GADGET, particles", "snapshot_2_big", record(b"HEAD" + struct.pack(">i", 264), ">") + record(bytes(256), ">")),
    ("HDF4", "a.hdf", b"\x0e\x03\x13\x01" + bytes(64)),
    ("a MATLAB file", "a.mat", b"MATLAB 5.0 MAT-file, Platform: GLNXA64".ljust(124) + b"\0\x01IM"),
    ("FITS", "a.fits", b"SIMPLE  =                    T".ljust(2880)),
    ("GRIB", "a.grib", b"GRIB\0\0\0\x02" + bytes(64)),
    ("VTK surface data in pieces (.pvtp)", "a.pvtp", xml("PPolyData")),
    ("VTK surface data in pieces (.pvtp)", "pieces", xml("PPolyData")),
    ("EnSight", "a.geo", text("EnSight Gold", "a geometry", "node id off")),
    ("EnSight", "a.case", text("FORMAT", "type: ensight gold", "GEOMETRY", "model: a.geo")),
    ("Abaqus", "abaqus", text("** made by hand", "*Heading", " a part", "*Node", "1, 0, 0, 0")),
    ("Abaqus", "a.inp", text("*NODE", "1, 0., 0., 0.", "*ELEMENT, TYPE=C3D4", "1, 1, 2, 3, 4")),
    ("AVS UCD", "ucd.inp", text("# by hand", "4 1 1 0 0", "1 0 0 0", "2 1 0 0", "3 0 1 0", "4 0 0 1", "1 1 tet 1 2 3 4")),
    ("AVS field", "a.fld", text("# AVS field file", "ndim=3", "dim1=2", "dim2=2", "dim3=2", "nspace=3", "veclen=1",
                                "data=byte", "field=uniform") + b"\f\f" + bytes(8)),
    ("Nastran", "nastran", text("$ by hand", "SOL 101", "TITLE = A BAR", "CEND", "BEGIN BULK", "GRID,1,,0.,0.,0.", "ENDDATA")),
    ("Nastran", "a.bdf", text("GRID,1,,0.,0.,0.")),
    ("Medit", "medit.mesh", text("MeshVersionFormatted 2", "Dimension 3", "Vertices", "1", "0 0 0 1", "End")),
    ("Medit", "a.meshb", struct.pack("<4i", 1, 2, 3, 20) + struct.pack("<i", 3) + bytes(64)),
    ("SU2", "su2", text("% a comment", "NDIME= 3", "NELEM= 1", "10 0 1 2 3 0")),
    ("SU2", "a.su2", text("NPOIN= 4")),
    ("UGRID", "a.b8.ugrid", struct.pack(">7i", 4, 0, 0, 1, 0, 0, 0) + struct.pack(">12d", *range(12)) + struct.pack(">4i", 1, 2, 3, 4)),
    ("Tecplot, binary", "a.plt", b"#!TDV112" + struct.pack("<i", 1) + bytes(64)),
    ("Tecplot, binary", "a.szplt", b"#!SZPLT" + bytes(64)),
    ("Tecplot", "a.dat", text("# by hand", 'TITLE = "a"', 'VARIABLES = "X" "Y" "Z" "p"', "ZONE I=2, J=2, K=2, F=POINT")),
    ("Tecplot", "zone.dat", text('VARIABLES= "X" "Y"')),
    ("MFEM", "mfem.mesh", text("MFEM mesh v1.0", "", "dimension", "3", "", "elements", "1", "1 4 0 1 2 3")),
    ("Nek5000", "a0.f00001", b"#std 4  8  8  8          1          1  0.0E+00  0  0  1 XUP".ljust(132) + struct.pack("<f", 6.54321)),
    ("Nek5000", "a.nek5000", text("filetemplate: a%01d.f%05d", "firsttimestep: 1", "numtimesteps: 1")),
    ("Nek5000", "a.re2", b"#v002      512  3      512 this is the header".ljust(80)),
    ("an AMReX plotfile", "Header", text("HyperCLaw-V1.1", "1", "density", "3", "0.0", "0")),
    ("an AMReX plotfile", "plt00000", {"Header": text("HyperCLaw-V1.1", "1", "density", "3", "0.0", "0"), "job_info": b"x",
                                       "Level_0/Cell_H": text("1", "1", "1", "0")}),
    ("OpenFOAM", "controlDict", FOAM),
    ("OpenFOAM", "a.foam", b""),
    ("OpenFOAM", "cavity", {"system/controlDict": FOAM, "0/U": FOAM, "constant/polyMesh/owner": FOAM}),
    ("OpenFOAM", "decomposed", {"constant/polyMesh/owner": FOAM, "constant/polyMesh/points": FOAM}),
    ("OpenFOAM", "polyMesh", {"owner": FOAM, "points": FOAM}),
    ("a Gaussian cube file", "density", CUBE),
    ("a Gaussian cube file", "a.cube", CUBE[:80]),
    ("LAS, points", "a.las", b"LASF" + bytes(371)),
    ("AFNI", "a+orig.HEAD", text("", "type  = string-attribute", "name  = TYPESTRING", "count = 15", "'3DIM_HEAD_ANAT~")),
    ("AFNI", "a+orig.BRIK", bytes(16)),
    ("Philips PAR/REC", "a.PAR", PAR),
    ("Philips PAR/REC", "a.REC", bytes(16)),
    ("PLOT3D", "a.p3d", b"\0\0\0\1" + bytes(64)),
    ("PLOT3D", "plot3d", struct.pack(">3i", 2, 3, 4) + bytes(16 + 20 * 24)),
    ("a mesh of DOLFIN", "dolfin", text('<?xml version="1.0"?>', '<dolfin xmlns:dolfin="http://fenicsproject.org">')),
    ("a zip archive", "a.npz", b"PK\x03\x04" + bytes(64)),
    ("a tar archive", "a.tar", bytes(tar())),
    ("PDF", "a.pdf", b"%PDF-1.4\n"),
]


def write(path, what):
    os.makedirs(os.path.dirname(path), exist_ok=True)
    if isinstance(what, dict):
        for name, data in what.items():
            write(path + "/" + name, data)
    else:
        with open(path, "wb") as f:
            f.write(what)


for name, path, what in SAMPLES:
    write(folder + "/" + path, what)
    print(name + "\t" + folder + "/" + path)
with open(source) as f:
    table = set(re.findall(r'^ +REFUSED\w*\(\s*"([^"]*)"', f.read(), re.M))
without = sorted(table - {name for name, _, _ in SAMPLES})
if not table or without:
    sys.exit("no sample of: " + ", ".join(without))
