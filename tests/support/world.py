#!/usr/bin/env python3
"""world.py LEAFCAST FOLDER - one body, written by nibabel, by pydicom and by hand in the worlds of their formats.

A body is an array[z, y, x] with a map of its nodes into LPS. Each form writes the same samples at the same places;
what leafcast makes of it is compared with the array: places and values of nodes in an exported NIfTI file, values at
points, depths of a picture, alone and in one scene with another form.
"""
import json
import os
import subprocess
import sys

import nibabel
import numpy as np
import pydicom
from pydicom.dataset import FileDataset, FileMetaDataset
from pydicom.uid import ExplicitVRLittleEndian, generate_uid

leafcast, folder = sys.argv[1:3]
NX, NY, NZ = 11, 9, 7
x, y, z = np.meshgrid(np.arange(NX), np.arange(NY), np.arange(NZ), indexing="ij")
# One octant is marked, and no axis is like another, nor like itself turned about.
BODY = (np.where((x > 5) & (y > 4) & (z > 3), 900, 0) + 7 * x + 13 * y + 31 * z + x * y).astype("i2")  # [x, y, z]
FLIP = np.diag([-1.0, -1.0, 1.0, 1.0])


def turned(angle_z, angle_x):
    c, s, d, t = np.cos(angle_z), np.sin(angle_z), np.cos(angle_x), np.sin(angle_x)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ np.array([[1, 0, 0], [0, d, -t], [0, t, d]])


def placed(rotation):
    m = np.eye(4)
    m[:3, :3] = rotation @ np.diag([1.5, 2.0, 2.5])
    m[:3, 3] = [-12, 7, 30]
    return m


BODIES = {"straight": placed(np.eye(3)), "oblique": placed(turned(0.4, -0.3))}


def path(name):
    return os.path.join(folder, name)


def along(lps, order, down=(False, False, False)):
    """The same body with its axes in another order, some of them downwards: (samples, map)."""
    samples = BODY.transpose(order)
    m = lps.copy()
    m[:3, :3] = lps[:3, list(order)]
    for a in range(3):
        if down[a]:
            m[:3, 3] += m[:3, a] * (samples.shape[a] - 1)
            m[:3, a] = -m[:3, a]
            samples = np.flip(samples, a)
    return samples, m


# ---- Forms: write a body, return its path ----

def dicom(order, down=(False, False, False)):
    def write(name, lps):
        samples, m = along(lps, order, down)
        os.makedirs(path(name))
        series = generate_uid()
        spacing = np.linalg.norm(m[:3, :3], axis=0)
        for k in range(samples.shape[2]):
            meta = FileMetaDataset()
            meta.TransferSyntaxUID = ExplicitVRLittleEndian
            meta.MediaStorageSOPClassUID = "1.2.840.10008.5.1.4.1.1.2"
            meta.MediaStorageSOPInstanceUID = generate_uid()
            f = FileDataset(None, {}, file_meta=meta, preamble=b"\0" * 128)
            f.is_little_endian, f.is_implicit_VR = True, False
            f.SOPClassUID, f.SOPInstanceUID = meta.MediaStorageSOPClassUID, meta.MediaStorageSOPInstanceUID
            f.StudyInstanceUID, f.SeriesInstanceUID, f.Modality = "1.2.3", series, "CT"
            f.SamplesPerPixel, f.PhotometricInterpretation = 1, "MONOCHROME2"
            f.Columns, f.Rows = samples.shape[:2]
            f.BitsAllocated, f.BitsStored, f.HighBit, f.PixelRepresentation = 16, 16, 15, 1
            f.ImagePositionPatient = ["%.12g" % v for v in m[:3, 3] + k * m[:3, 2]]
            f.ImageOrientationPatient = ["%.12g" % v for a in (0, 1) for v in m[:3, a] / spacing[a]]
            f.PixelSpacing = ["%.12g" % spacing[1], "%.12g" % spacing[0]]
            f.InstanceNumber = k + 1
            f.PixelData = np.ascontiguousarray(samples[:, :, k].T).astype("<i2").tobytes()
            f["PixelData"].VR = "OW"
            f.save_as(path("%s/%03d.dcm" % (name, k)), write_like_original=False)
        return path(name)
    return write


def nifti(order, by, down=(False, False, False), of=nibabel.Nifti1Image):
    def write(name, lps):
        samples, m = along(lps, order, down)
        image = of(np.ascontiguousarray(samples), FLIP @ m)
        image.header.set_sform(FLIP @ m, code=1 if by == "sform" else 0)
        image.header.set_qform(FLIP @ m, code=1 if by == "qform" else 0, strip_shears=False)
        image.header.set_xyzt_units("mm")
        image.to_filename(path(name + ".nii"))
        return path(name + ".nii")
    return write


def nrrd(space, flip, order=(0, 1, 2), down=(False, False, False)):
    def write(name, lps):
        samples, m = along(lps, order, down)
        m = flip @ m
        vectors = ["(%s)" % ",".join(repr(float(v)) for v in m[:3, c]) for c in range(4)]
        head = ("NRRD0004\ntype: short\ndimension: 3\nsizes: %d %d %d\nencoding: raw\nendian: little\n%s\n"
                'space directions: %s\nspace origin: %s\nspace units: "mm" "mm" "mm"\n\n' % (
                    *samples.shape, space, " ".join(vectors[:3]), vectors[3]))
        with open(path(name + ".nrrd"), "wb") as f:
            f.write(head.encode() + samples.astype("<i2").tobytes(order="F"))
        return path(name + ".nrrd")
    return write


def metaimage(order=(0, 1, 2), down=(False, False, False)):
    def write(name, lps):
        samples, m = along(lps, order, down)
        spacing = np.linalg.norm(m[:3, :3], axis=0)
        numbers = lambda values: " ".join(repr(float(v)) for v in values)
        head = ("ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
                "CompressedData = False\nTransformMatrix = %s\nOffset = %s\nCenterOfRotation = 0 0 0\n"
                "AnatomicalOrientation = RAI\nElementSpacing = %s\nDimSize = %d %d %d\nElementType = MET_SHORT\n"
                "ElementDataFile = LOCAL\n" % (numbers((m[:3, :3] / spacing).T.ravel()), numbers(m[:3, 3]),
                                              numbers(spacing), *samples.shape))
        with open(path(name + ".mha"), "wb") as f:
            f.write(head.encode() + samples.astype("<i2").tobytes(order="F"))
        return path(name + ".mha")
    return write


LAS = np.diag([1.0, -1.0, 1.0, 1.0])
# name: how it is written, the axes that the file says, and options of convert
FORMS = {
    "dicom axial": (dicom((0, 1, 2)), "LPS", ()),
    "dicom sagittal": (dicom((1, 2, 0), (False, True, False)), "LPS", ()),
    "dicom coronal": (dicom((0, 2, 1), (False, True, False)), "LPS", ()),
    "nifti sform": (nifti((0, 1, 2), "sform"), "RAS", ()),
    "nifti qform": (nifti((0, 1, 2), "qform"), "RAS", ()),
    "nifti qform, qfac -1": (nifti((0, 1, 2), "qform", (True, False, False)), "RAS", ()),
    "nifti sform, turned": (nifti((2, 0, 1), "sform", (True, False, True)), "RAS", ()),
    "nifti-2": (nifti((1, 0, 2), "sform", of=nibabel.Nifti2Image), "RAS", ()),
    "nrrd LPS": (nrrd("space: left-posterior-superior", np.eye(4)), "LPS", ()),
    "nrrd RAS": (nrrd("space: RAS", FLIP, (1, 0, 2)), "RAS", ()),
    "nrrd LAS": (nrrd("space: left-anterior-superior", LAS), "RAS", ()),
    "nrrd scanner": (nrrd("space: scanner-xyz", np.eye(4)), "", ("--axes", "LPS")),
    "nrrd space dimension": (nrrd("space dimension: 3", FLIP), "", ("--axes", "RAS")),
    "metaimage": (metaimage(), "LPS", ()),
    "metaimage, turned": (metaimage((2, 1, 0), (False, True, True)), "LPS", ()),
}


# ---- What leafcast makes of them ----

def call(*arguments):
    done = subprocess.run([leafcast, *map(str, arguments)], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE)
    if done.returncode:
        raise ValueError("exit %d of %s: %s" % (done.returncode, arguments, done.stderr.decode()))
    return done.stdout


def tell(name, wrong):
    print(name + "\t" + (wrong.replace("\n", " ").replace("\t", " ") or "right"), flush=True)


def facts(file, axes):
    got = json.loads(call("info", file, "--json"))
    said = (got["axes"], got["units"])
    return "" if said == (axes, ["mm"] * 3) else "info says %s, expected %s and mm" % (said, axes)


CORNERS = [(i, j, k) for i in (0, NX - 1) for j in (0, NY - 1) for k in (0, NZ - 1)] + [(6, 5, 4), (3, 7, 2)]


def exported(leaf, lps):
    """Each node of the body lies where it did, in the world of NIfTI."""
    for suffix in ".nii", ".nrrd", ".mha":
        call("export", leaf, "-o", leaf + suffix, "--force", "-q")
    for file in leaf + ".nii", again(leaf + ".nrrd"), again(leaf + ".mha"):
        image = nibabel.load(file)
        back = np.linalg.inv(image.affine) @ FLIP @ lps
        for node in CORNERS:
            at = back @ (*node, 1)
            near = np.rint(at[:3]).astype(int)
            if not np.allclose(at[:3], near, atol=1e-4):
                return "node %s is at %s of the export" % (node, at[:3])
            if image.get_fdata()[tuple(near)] != BODY[node]:
                return "node %s is %s, not %s" % (node, image.get_fdata()[tuple(near)], BODY[node])
        if image.header.get_xyzt_units()[0] != "mm":
            return "unit %s" % image.header.get_xyzt_units()[0]
    return ""


def again(file):
    """What was exported, once more through a treelet file, as NIfTI."""
    call("convert", file, "-o", file + ".leaf", "--force", "-q")
    call("export", file + ".leaf", "-o", file + ".nii", "--force", "-q")
    return file + ".nii"


def probed(leaf, lps):
    for node in CORNERS[-2:]:
        for axes, flip in ("LPS", np.eye(4)), ("RAS", FLIP):
            point = (flip @ lps @ (*node, 1))[:3]
            got = json.loads(call("probe", leaf, "--point", ",".join(repr(float(v)) for v in point), "--axes", axes,
                                  "--json"))
            if not np.isclose(got["value"], BODY[node], atol=1e-6):
                return "%s at node %s in %s, expected %s" % (got["value"], node, axes, BODY[node])
    return ""


def depths(lps, *arguments):
    """Of the surface around the marked octant, seen from the left, the front and above."""
    middle = (lps @ (8.5, 7, 5.2, 1))[:3]
    places = [",".join(repr(float(v)) for v in p) for p in (middle + (64, -52, 42), middle)]
    call("render", *arguments, "--eye", places[0], "--look-at", places[1], "--fov", "14", "--size", "96x64", "--axes",
         "LPS", "--depth-f64", path("z"), "--force", "-q")
    return np.fromfile(path("z"))


def seen(want, lps, *arguments):
    got = depths(lps, *arguments)
    hits = np.isfinite(want)
    if hits.sum() < 300:
        return "the picture shows nothing"
    if not np.array_equal(hits, np.isfinite(got)):
        return "%d pixels differ" % np.sum(hits != np.isfinite(got))
    off = np.max(np.abs(got[hits] - want[hits]))
    return "" if off < 1e-4 else "the depth is off by %g" % off  # NIfTI-1 keeps its map in floats


for body, lps in BODIES.items():
    first, want = None, None
    for form, (write, axes, options) in FORMS.items():
        name = (body + "_" + form).replace(" ", "_").replace(",", "")
        leaf = path(name + ".leaf")
        try:
            file = write(name, lps)
            wrong = facts(file, axes)
            call("convert", file, "-o", leaf, "-q", *options)
            wrong = wrong or facts(leaf, axes or options[1])
            tell("%s: %s: info" % (body, form), wrong)
            tell("%s: %s: export" % (body, form), exported(leaf, lps))
            tell("%s: %s: probe" % (body, form), probed(leaf, lps))
            if first is None:
                first, want = leaf, depths(lps, leaf, "--iso", "700")
            else:
                tell("%s: %s: picture" % (body, form), seen(want, lps, leaf, "--iso", "700"))
                tell("%s: %s: in one scene" % (body, form), seen(want, lps, first, "--iso", "700", "--and", leaf,
                                                                      "--iso", "700"))
        except (ValueError, KeyError) as e:
            tell("%s: %s" % (body, form), str(e))
