#!/usr/bin/env python3
"""import_dicom.py LEAFCAST FOLDER DATA - files by pydicom, and what leafcast import-dicom makes of them."""
import itertools
import json
import os
import shutil
import struct
import subprocess
import sys

from imported import Imported, damaged, elsewhere, ends, np, same, start, tell
from watched import WATCHED

try:
    import pydicom
    import pydicom.encaps
    from pydicom.dataset import Dataset, FileDataset, FileMetaDataset
    from pydicom.sequence import Sequence
    from pydicom.uid import (DeflatedExplicitVRLittleEndian, ExplicitVRBigEndian, ExplicitVRLittleEndian,
                             ImplicitVRLittleEndian, generate_uid)
except ImportError:
    elsewhere()

leafcast, folder = sys.argv[1:3]
random = np.random.default_rng(7)
ROWS, COLUMNS, SLICES = 10, 13, 7
SHAPE = (SLICES, ROWS, COLUMNS)


def path(name):
    return "%s/%s" % (folder, name)


def take(name, *arguments):
    return (leafcast, "import-dicom", path(name), *arguments)


def image(pixels, syntax=ExplicitVRLittleEndian, bits=None, **tags):
    """A file of one frame, or of several."""
    meta = FileMetaDataset()
    meta.TransferSyntaxUID = syntax
    meta.MediaStorageSOPClassUID = "1.2.840.10008.5.1.4.1.1.2"
    meta.MediaStorageSOPInstanceUID = generate_uid()
    f = FileDataset(None, {}, file_meta=meta, preamble=b"\0" * 128)
    f.is_little_endian = syntax != ExplicitVRBigEndian
    f.is_implicit_VR = syntax == ImplicitVRLittleEndian
    f.SOPClassUID, f.SOPInstanceUID = meta.MediaStorageSOPClassUID, meta.MediaStorageSOPInstanceUID
    f.StudyInstanceUID, f.SeriesInstanceUID, f.Modality = "1.2.3", "1.2.3.4", "CT"
    colours = pixels.ndim == 3 and pixels.shape[2] == 3
    f.SamplesPerPixel, f.PhotometricInterpretation = (3, "RGB") if colours else (1, "MONOCHROME2")
    if colours:
        f.PlanarConfiguration = 0
    f.Rows, f.Columns = pixels.shape[:2] if colours else pixels.shape[-2:]
    f.BitsAllocated = 8 * pixels.itemsize
    f.BitsStored = bits or f.BitsAllocated
    f.HighBit = f.BitsStored - 1
    f.PixelRepresentation = int(pixels.dtype.kind == "i")
    if pixels.ndim == 3 and not colours:
        f.NumberOfFrames = pixels.shape[0]
    f.PixelData = pixels.astype(pixels.dtype.newbyteorder("<" if f.is_little_endian else ">")).tobytes()
    f["PixelData"].VR = "OB" if pixels.itemsize == 1 else "OW"
    if pydicom.uid.UID(syntax).is_encapsulated:  # in name
        f.PixelData = pydicom.encaps.encapsulate([f.PixelData])
        f["PixelData"].is_undefined_length = True
    for tag, value in tags.items():
        setattr(f, tag, value)
    return f


def series(name, pixels, places=None, across=(1, 0, 0), down=(0, 1, 0), spacing=(0.5, 0.25), first=0, order=None, **tags):
    """A folder of slices. spacing: of rows, of columns; order: of the names of the files."""
    os.makedirs(path(name), exist_ok=True)
    for i, a in enumerate(pixels):
        f = image(a, **{k: v(i) if callable(v) else v for k, v in tags.items()})
        at = places[i] if places is not None else (-20, 30, 100 + 2 * i)
        f.ImagePositionPatient = ["%.9g" % v for v in at]
        f.ImageOrientationPatient = ["%.9g" % v for v in (*across, *down)]
        f.PixelSpacing = ["%.9g" % v for v in spacing]
        f.InstanceNumber = first + i + 1
        f.save_as(path("%s/%03d.dcm" % (name, first + (order[i] if order is not None else i))), write_like_original=False)


COLUMNS_MAP = [[0.25, 0, 0], [0, 0.5, 0], [0, 0, 2], [-20, 30, 100]]


def types():
    for t in ("u1", "i1", "u2", "i2", "u4", "i4"):
        info = np.iinfo(t)
        a = random.integers(info.min, info.max, SHAPE, dtype=t, endpoint=True)
        series("type_" + t, a)
        same("type " + t, a, *take("type_" + t), columns=COLUMNS_MAP, type=t)
    a = random.integers(0, 65535, SHAPE, dtype="u2")
    series("bits12", a, bits=12)
    same("12 bits of 16, and others above", a & 0xfff, *take("bits12"), type="u2")
    series("bits12s", a.astype("i2"), bits=12)
    same("12 bits with a sign", ((a & 0xfff).astype("i4") ^ 0x800) - 0x800, *take("bits12s"), type="i2")
    for syntax in (ImplicitVRLittleEndian, ExplicitVRBigEndian, DeflatedExplicitVRLittleEndian):
        name = "syntax_" + syntax[-4:]
        series(name, a, syntax=syntax)
        same("transfer syntax " + syntax.name, a, *take(name), columns=COLUMNS_MAP)
        series(name + "_32", a.astype("i4") * -70000, syntax=syntax)
        same("transfer syntax %s, 32 bits" % syntax.name, a.astype("i4") * -70000, *take(name + "_32"))
    read = [pydicom.dcmread(path("syntax_.2.2/%03d.dcm" % i)).pixel_array for i in range(SLICES)]
    same("as pydicom reads it", np.array(read), *take("syntax_.2.2"))


def rescale():
    a = random.integers(0, 4095, SHAPE, dtype="u2", endpoint=True)
    series("hounsfield", a, bits=12, RescaleSlope=1, RescaleIntercept=-1024)
    same("Hounsfield units", a.astype("i4") - 1024, *take("hounsfield"), type="i2")
    series("shifted", a, RescaleSlope=1, RescaleIntercept=-1024)
    same("whole, but i16 does not fit", a.astype("f4") - 1024, *take("shifted"), type="f4")
    series("slope", a, bits=12, RescaleSlope="0.5", RescaleIntercept="-3.25")
    same("a slope", (a * 0.5 - 3.25).astype("f4"), *take("slope"), type="f4")
    series("slopes", a, bits=12, RescaleSlope=lambda i: "%g" % (1 + i / 4), RescaleIntercept=0)
    want = a * (1 + np.arange(SLICES) / 4)[:, None, None]
    same("a slope for each slice", want.astype("f4"), *take("slopes"), type="f4")


def places():
    a = random.integers(-999, 999, SHAPE, dtype="i2")
    mixed = list(random.permutation(SLICES))
    series("mixed", a, order=mixed)
    same("names in another order", a, *take("mixed"), columns=COLUMNS_MAP)
    series("down", a, places=[(-20, 30, 100 - 2 * i) for i in range(SLICES)])
    same("from above", a[::-1], *take("down"), columns=COLUMNS_MAP[:3] + [[-20, 30, 88]])
    across, down = np.array([0.8, 0.6, 0]), np.array([-0.36, 0.48, 0.8])
    normal = np.cross(across, down)
    where = [np.array([5, 6, 7]) + 1.5 * i * normal for i in range(SLICES)]
    series("oblique", a, places=where, across=across, down=down)
    same("oblique", a, *take("oblique"), columns=[across * 0.25, down * 0.5, normal * 1.5, [5, 6, 7]])
    series("tilted", a, places=[(0, 0.3 * i, 2 * i) for i in range(SLICES)])
    same("a tilted gantry", a, *take("tilted"), columns=[[0.25, 0, 0], [0, 0.5, 0], [0, 0.3, 2], [0, 0, 0]])
    series("thick", a, SliceThickness=5, SpacingBetweenSlices=7)
    same("thickness does not count", a, *take("thick"), columns=COLUMNS_MAP)
    z = np.array([0, 1, 2.3, 4.1, 5.6, 8.2, 9.9])
    series("uneven", a, places=[(1, 2, 3 + v) for v in z])
    same("unequal distances", a, *take("uneven"), axes=[np.arange(COLUMNS), np.arange(ROWS), z],
         columns=[[0.25, 0, 0], [0, 0.5, 0], [0, 0, 1], [1, 2, 3]])
    rounded = 0.703 * np.arange(SLICES)
    series("rounded", a, places=[(0, 0, round(v + 0.003, 2)) for v in rounded])
    same("rounded positions", a, *take("rounded"), axes=[None] * 3)


def faults():
    a = random.integers(0, 999, SHAPE, dtype="u2")
    series("gap", a)
    os.remove(path("gap/002.dcm"))
    os.remove(path("gap/004.dcm"))
    ends("missing slices", 3, "2 slices are missing, at -20, 30, 104; -20, 30, 108", *take("gap"))
    z = np.array([100, 102, 106, 110, 112.0])
    same("--allow-gaps", a[[0, 1, 3, 5, 6]], *take("gap", "--allow-gaps"), axes=[np.arange(COLUMNS), np.arange(ROWS), z - 100])
    series("twice", a)
    series("twice", a[3:4], places=[(-20, 30, 106)], first=SLICES)
    ends("a position twice", 3, "007.dcm lie at the same position, -20, 30, 106", *take("twice"))
    series("copied", a)
    for i in range(SLICES):
        shutil.copy(path("copied/%03d.dcm" % i), path("copied/%03d.dcm" % (i + 50)))
    ends("the same instances twice", 3, "the same instance", *take("copied"))
    series("turned", a)
    series("turned", a[3:4], places=[(-20, 30, 120)], first=SLICES, across=(0, 1, 0), down=(0, 0, 1))
    ends("a plane that differs", 3, "007.dcm: its plane", *take("turned"))
    series("sizes", a)
    series("sizes", a[3:4, 1:], places=[(-20, 30, 120)], first=SLICES)
    ends("a size that differs", 3, "007.dcm is of another size", *take("sizes"))
    series("shifted_z", a, places=[(3 * (i == 4), 0, i) for i in range(SLICES)])
    ends("a slice that is shifted sideways", 3, "004.dcm: it is shifted", *take("shifted_z"))
    series("mpeg", a, syntax="1.2.840.10008.1.2.4.100")
    ends("a transfer syntax without a decoder", 3, "no decoder here for MPEG2", *take("mpeg"))
    series("lut", a, ModalityLUTSequence=Sequence([Dataset()]))
    ends("values by a table", 3, "Modality LUT", *take("lut"))
    series("words", a, RescaleSlope=2)
    broken = open(path("words/003.dcm"), "rb").read().replace(b"DS\x04\x002.0 ", b"DS\x04\x00xxxx")
    open(path("words/003.dcm"), "wb").write(broken)
    ends("a slope that is no number", 3, "RescaleSlope: expected numbers", *take("words"))
    ends("one slice", 3, "several slices", *take("gap/000.dcm"))
    os.makedirs(path("nothing"))
    open(path("nothing/a.txt"), "w").write("no DICOM\n")
    ends("a folder without DICOM", 3, "no DICOM images", *take("nothing"))
    ends("a file that is none", 3, "DICM at byte 128", *take("nothing/a.txt"))
    ends("a folder that is not there", 1, "none", *take("none"))


def studies():
    a, b = (random.integers(0, 999, SHAPE, dtype="u2") for _ in range(2))
    series("study/one/deep", a, SeriesDescription="head")
    series("study/two", b[:4], SeriesInstanceUID="1.2.3.5", SeriesDescription="legs", Modality="MR")
    open(path("study/README"), "w").write("no DICOM\n")
    same("the first series", a, *take("study"))
    same("a series by its UID", b[:4], *take("study", "--field", "1.2.3.5"))
    same("a series by its description", b[:4], *take("study", "--field", "legs"))
    files = [path("study/two/%03d.dcm" % i) for i in (2, 0, 1)]
    same("files by name", b[:3], leafcast, "import-dicom", *files)
    ends("no such series", 2, "--list", *take("study", "--field", "arms"))
    rc, out, said = start(*take("study", "--list", "--json"))
    fields = {f["name"]: f for f in json.loads(out)["fields"]}
    right = fields["1.2.3.4"]["shape"] == [COLUMNS, ROWS, SLICES] and "legs" in fields["1.2.3.5"]["type"] \
        and fields["1.2.3.5"]["type"].startswith("MR, u16") and len(fields) == 2
    tell("--list --json", "" if right else fields)
    rc, out, _ = start(*take("study"))
    tell("the description is the name", "" if Imported(out).name == "head" else Imported(out).name)
    series("steps", a)
    series("steps", b, first=SLICES)
    same("time steps", b, *take("steps", "--step", "1"), columns=COLUMNS_MAP)
    same("the first of them", a, *take("steps"))
    ends("no such step", 2, "has 2", *take("steps", "--step", "2"))
    rc, _, said = start(*take("study", "-o", path("study/two/001.dcm"), "--force"))
    tell("an input is no output", "" if rc == 2 else said)


def compressed():
    a = random.integers(0, 4095, SHAPE, dtype="u2", endpoint=True)
    smooth = (np.add.outer(np.add.outer(np.arange(SLICES), np.arange(ROWS)), np.arange(COLUMNS)) * 9).astype("u2")
    for tool, arguments in (("dcmcrle", []), ("dcmcjpeg", ["+e1"]), ("dcmcjpeg", ["+el"]), ("dcmcjpls", ["+el"])):
        name = tool + "".join(arguments)
        if not shutil.which(tool):
            print("compressed by %s\tskip no %s here" % (name, tool))
            continue
        for kind, pixels in (("12 bits", a), ("signed", smooth.astype("i2") - 300)):
            if kind == "signed" and tool == "dcmcjpeg":
                continue
            series(name, pixels, bits=12 if kind == "12 bits" else 16, RescaleSlope=1, RescaleIntercept=-7)
            for i in range(SLICES):
                f = path("%s/%03d.dcm" % (name, i))
                subprocess.run([tool, *arguments, f, f], check=True, stderr=subprocess.DEVNULL)
            syntax = pydicom.dcmread(path(name + "/000.dcm")).file_meta.TransferSyntaxUID
            tell("it is compressed: " + name, "" if syntax.is_compressed else syntax.name)
            same("compressed by %s, %s" % (name, kind), pixels.astype("f4") - 7, *take(name), columns=COLUMNS_MAP)


LOSSLESS, LOSSY = "1.2.840.10008.1.2.4.90", "1.2.840.10008.1.2.4.91"


def codestream(pixels, *options, bits=None, signed=None):
    """By OpenJPEG's own tool, from a raw picture."""
    raw, packed = path("x.rawl"), path("x.j2k")
    components = pixels.shape[2] if pixels.ndim == 3 else 1
    planes = np.moveaxis(pixels, 2, 0) if components > 1 else pixels
    planes.astype(pixels.dtype.newbyteorder("<")).tofile(raw)
    form = "%d,%d,%d,%d,%s" % (pixels.shape[1], pixels.shape[0], components, bits or 8 * pixels.itemsize,
                               "s" if (pixels.dtype.kind == "i" if signed is None else signed) else "u")
    subprocess.run(["opj_compress", "-i", raw, "-o", packed, "-F", form, "-n", "3", *options], check=True,
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return open(packed, "rb").read()


def pack(name, streams, syntax, fragments=1, **tags):
    """The pixels of a folder's files become codestreams, in so many fragments."""
    for i, stream in enumerate(streams):
        f = pydicom.dcmread(path("%s/%03d.dcm" % (name, i)))
        f.PixelData = pydicom.encaps.encapsulate([stream], fragments_per_frame=fragments)
        f["PixelData"].is_undefined_length, f["PixelData"].VR = True, "OB"
        f.file_meta.TransferSyntaxUID = syntax
        for tag, value in tags.items():
            setattr(f, tag, value)
        f.save_as(path("%s/%03d.dcm" % (name, i)), write_like_original=False)


def j2k():
    """Lossless and lossy, of each type that OpenJPEG's tool writes; what headers say is held against it."""
    a = random.integers(0, 4095, SHAPE, dtype="u2", endpoint=True)
    series("j2k", a, bits=12)
    if not shutil.which("opj_compress"):
        return print("JPEG 2000\tskip no opj_compress here")
    pack("j2k", [codestream(p, bits=12) for p in a], LOSSLESS)
    rc, _, said = start(*take("j2k"))
    if "no decoder here" in said:
        return print("JPEG 2000\tskip built without OpenJPEG")
    for t in ("u1", "i1", "u2", "i2"):
        info = np.iinfo(t)
        a = random.integers(info.min, info.max, SHAPE, dtype=t, endpoint=True)
        series("j2k_" + t, a)
        pack("j2k_" + t, [codestream(p) for p in a], LOSSLESS, fragments=3)
        same("JPEG 2000, type " + t, a, *take("j2k_" + t), columns=COLUMNS_MAP, type=t)
    a = random.integers(0, 4095, SHAPE, dtype="u2", endpoint=True)
    signed = (a.astype("i4") - 2048).astype("i2")
    for name, pixels, how in (("12 bits", a, {}), ("12 bits and a sign", signed, {}), ("12 bits whose sign is untold", signed, {"signed": False})):
        series("j2k_12", pixels, bits=12, RescaleSlope=1, RescaleIntercept=-7)
        pack("j2k_12", [codestream(p & 0xfff if how else p, bits=12, **how) for p in pixels], LOSSLESS)
        same("JPEG 2000, " + name, pixels.astype("i4") - 7, *take("j2k_12"), type="i2")
    smooth = (np.add.outer(np.add.outer(np.arange(SLICES), np.arange(ROWS)), np.arange(COLUMNS)) * 90).astype("u2")
    series("j2k_lossy", smooth)
    pack("j2k_lossy", [codestream(p, "-I", "-r", "2") for p in smooth], LOSSY)
    known = []
    for i in range(SLICES):  # as OpenJPEG's tool reads it
        frames = pydicom.dcmread(path("j2k_lossy/%03d.dcm" % i)).PixelData
        open(path("x.j2k"), "wb").write(next(pydicom.encaps.generate_pixel_data_frame(frames)))
        subprocess.run(["opj_decompress", "-i", path("x.j2k"), "-o", path("y.rawl")], check=True,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        known.append(np.fromfile(path("y.rawl"), "<u2").reshape(ROWS, COLUMNS))
    same("JPEG 2000, lossy", known, *take("j2k_lossy"), type="u2")
    off = np.abs(np.array(known).astype("i4") - smooth).max()
    tell("it is lossy, and near", "" if 0 < off < 200 else off)
    big = (np.add.outer(np.arange(90), np.arange(70)) * 300).astype("u2") ^ random.integers(0, 255, (4, 90, 70), dtype="u2")
    series("j2k_tiles", big)
    pack("j2k_tiles", [codestream(p, "-t", "32,32", "-p", "RPCL") for p in big], LOSSLESS)
    same("JPEG 2000, in tiles", big, *take("j2k_tiles"))
    rgb = random.integers(0, 255, SHAPE + (3,), dtype="u1", endpoint=True)
    for kind, mct in (("RGB", "0"), ("YBR_RCT", "1")):
        series("j2k_rgb", rgb)
        pack("j2k_rgb", [codestream(p, "-mct", mct) for p in rgb], LOSSLESS, PhotometricInterpretation=kind)
        same("JPEG 2000, colours as " + kind, rgb[..., 1], *take("j2k_rgb", "--component", "2"), type="u1")
    pack("j2k_rgb", [codestream(p, "-mct", "0") for p in rgb], LOSSLESS, PhotometricInterpretation="YBR_FULL")
    ends("JPEG 2000, other colours", 3, "colours as YBR_FULL", *take("j2k_rgb", "--component", "2"))
    f = image(a, SpacingBetweenSlices=3, PixelSpacing=[0.5, 0.25])
    f.file_meta.TransferSyntaxUID = LOSSLESS
    f["PixelData"].is_undefined_length, f["PixelData"].VR = True, "OB"
    for fragments, table in ((1, True), (1, False), (2, True)):
        f.PixelData = pydicom.encaps.encapsulate([codestream(p) for p in a], fragments_per_frame=fragments, has_bot=table)
        f.save_as(path("j2k.dcm"), write_like_original=False)
        same("JPEG 2000, frames of %d fragments%s" % (fragments, "" if table else ", no table"), a, *take("j2k.dcm"))

    # Headers that say something else, and streams that are none.
    stream = codestream(a[3])
    series("j2k_bad", a)
    streams = [codestream(p) for p in a]
    for name, words, bad in (
            ("columns", "13 columns, expected 12", codestream(np.ascontiguousarray(a[3][:, :12]))),
            ("rows", "9 rows, expected 10", codestream(a[3][:9])), ("no stream", "expected a codestream", b"\0" * 200),
            ("components", "3 components, expected 1", codestream(rgb[3])),
            ("cut off", "OpenJPEG", stream[:len(stream) // 2]), ("its header alone", "OpenJPEG", stream[:60]), ("few bytes", "expected a codestream", stream[:20]),
            ("no extent", "columns, expected 13", stream[:8] + b"\xff" * 8 + stream[16:]),
            ("before it begins", "ends before it begins", stream[:16] + b"\xff" * 8 + stream[24:]),
            ("tiles without extent", "tiles without extent", stream[:24] + b"\0" * 8 + stream[32:]),
            ("signs", "8 bits with a sign", codestream((a[3] >> 8).astype("i1"), signed=True)),
            ("bits", "24 bits a number, expected 16", stream[:42] + b"\x17" + stream[43:]),
            ("tiles by the million", "more than 4096 tiles", stream[:8] +
             struct.pack(">6I", 2**31 - 1, 2**31 - 1, 2**31 - 14, 2**31 - 11, 1, 1) + stream[32:])):
        pack("j2k_bad", streams[:3] + [bad] + streams[4:], LOSSLESS)
        words = words.replace("13 columns, expected 12", "12 columns, expected 13")
        ends("JPEG 2000, another header: " + name, 3, words, *take("j2k_bad"))
    pack("j2k_bad", streams, LOSSLESS)
    shutil.copy(path("j2k_bad/001.dcm"), path("j2k_whole"))
    damaged("damaged files by opj_compress", path("j2k_whole"), path("j2k_bad/001.dcm"), 50, *take("j2k_bad"))


def several_frames():
    a = random.integers(0, 4095, SHAPE, dtype="u2", endpoint=True)

    def enhanced(places):
        f = image(a, bits=12, InstanceNumber=1)
        shared, measures, plane = Dataset(), Dataset(), Dataset()
        measures.PixelSpacing = [0.5, 0.25]
        plane.ImageOrientationPatient = [1, 0, 0, 0, 1, 0]
        shared.PixelMeasuresSequence, shared.PlaneOrientationSequence = Sequence([measures]), Sequence([plane])
        f.SharedFunctionalGroupsSequence = Sequence([shared])
        frames = []
        for i, at in enumerate(places):
            frame, where, value = Dataset(), Dataset(), Dataset()
            where.ImagePositionPatient = list(at)
            value.RescaleSlope, value.RescaleIntercept = i + 1, 5
            frame.PlanePositionSequence, frame.PixelValueTransformationSequence = Sequence([where]), Sequence([value])
            frames.append(frame)
        f.PerFrameFunctionalGroupsSequence = Sequence(frames)
        f.save_as(path("enhanced.dcm"), write_like_original=False)

    want = a.astype("f8") * (1 + np.arange(SLICES))[:, None, None] + 5
    enhanced([(-20, 30, 100 + 2 * i) for i in range(SLICES)])
    same("frames of one file", want, *take("enhanced.dcm"), columns=COLUMNS_MAP)
    enhanced([(-20, 30, 112 - 2 * i) for i in range(SLICES)])
    same("frames from above", want[::-1], *take("enhanced.dcm"), columns=COLUMNS_MAP)
    for tool in ("dcmcrle", "dcmcjpls"):
        if shutil.which(tool):
            subprocess.run([tool, path("enhanced.dcm"), path("enhanced_z.dcm")], check=True)
            same("frames from above by " + tool, want[::-1], *take("enhanced_z.dcm"), columns=COLUMNS_MAP)
    f = image(a.astype("u4"), ImagePositionPatient=[-20, 30, 100], ImageOrientationPatient=[1, 0, 0, 0, 1, 0],
              PixelSpacing=[0.5, 0.25], DoseGridScaling="0.125", Modality="RTDOSE")
    f.GridFrameOffsetVector = [2 * i for i in range(SLICES)]
    f.save_as(path("dose.dcm"), write_like_original=False)
    same("a dose", a * 0.125, *take("dose.dcm"), columns=COLUMNS_MAP, type="f8")
    f = image(a, SpacingBetweenSlices=3, PixelSpacing=[0.5, 0.25])
    f.save_as(path("bare.dcm"), write_like_original=False)
    same("frames without positions", a, *take("bare.dcm"), columns=[[0.25, 0, 0], [0, 0.5, 0], [0, 0, 3], [0, 0, 0]])
    f.NumberOfFrames = 2000000000
    f.save_as(path("many.dcm"), write_like_original=False)
    ends("frames that it cannot have", 3, "too short", *take("many.dcm"))


def segmentation(name, segments, skip_empty=False, places=None, numbers=None, kind="BINARY", bits=1, **tags):
    """segments[s, z, y, x] of bool as DICOM SEG: a frame a segment and place, the bits of all in a row."""
    meta = FileMetaDataset()
    meta.TransferSyntaxUID, meta.MediaStorageSOPClassUID = ExplicitVRLittleEndian, "1.2.840.10008.5.1.4.1.1.66.4"
    meta.MediaStorageSOPInstanceUID = generate_uid()
    f = FileDataset(None, {}, file_meta=meta, preamble=b"\0" * 128)
    f.is_little_endian, f.is_implicit_VR = True, False
    f.SOPClassUID, f.SOPInstanceUID = meta.MediaStorageSOPClassUID, meta.MediaStorageSOPInstanceUID
    f.StudyInstanceUID, f.SeriesInstanceUID, f.Modality, f.InstanceNumber = "1.2.3", "1.2.3.9", "SEG", 1
    f.SamplesPerPixel, f.PhotometricInterpretation, f.PixelRepresentation = 1, "MONOCHROME2", 0
    f.BitsAllocated = f.BitsStored = bits
    f.HighBit, f.SegmentationType = bits - 1, kind
    f.Rows, f.Columns = segments.shape[2:]
    listed = []
    numbers = numbers or list(range(1, len(segments) + 1))
    for number in numbers:
        one = Dataset()
        one.SegmentNumber, one.SegmentLabel, one.SegmentAlgorithmType = number, "part %d" % number, "MANUAL"
        listed.append(one)
    f.SegmentSequence = Sequence(listed)
    shared, measures, plane = Dataset(), Dataset(), Dataset()
    measures.PixelSpacing = [0.5, 0.25]
    plane.ImageOrientationPatient = [1, 0, 0, 0, 1, 0]
    shared.PixelMeasuresSequence, shared.PlaneOrientationSequence = Sequence([measures]), Sequence([plane])
    f.SharedFunctionalGroupsSequence = Sequence([shared])
    frames, pixels = [], []
    for s, number in enumerate(numbers):
        for z in range(segments.shape[1]):
            if skip_empty and not segments[s, z].any():
                continue
            frame, where, which = Dataset(), Dataset(), Dataset()
            where.ImagePositionPatient = list(places[z] if places else (-20, 30, 100 + 2 * z))
            which.ReferencedSegmentNumber = number
            frame.PlanePositionSequence = Sequence([where])
            frame.SegmentIdentificationSequence = Sequence([which])
            frames.append(frame)
            pixels.append(segments[s, z])
    f.PerFrameFunctionalGroupsSequence = Sequence(frames)
    f.NumberOfFrames = len(frames)
    packed = np.packbits(np.array(pixels).ravel(), bitorder="little") if bits == 1 else np.array(pixels, "u1").ravel() * 200
    f.PixelData = packed.tobytes() + b"\0" * (len(packed) % 2)
    f["PixelData"].VR = "OB"
    for tag, value in tags.items():
        setattr(f, tag, value)
    f.save_as(path(name), write_like_original=False)
    return f


def segments():
    """Binary segments become labels, at their places; what several have is told."""
    one = random.random((1,) + SHAPE) < 0.3
    segmentation("seg1.dcm", one)
    same("one segment", one[0], *take("seg1.dcm"), columns=COLUMNS_MAP, type="u1")
    read = pydicom.dcmread(path("seg1.dcm"))
    same("as pydicom reads it", read.pixel_array, *take("seg1.dcm"))
    segmentation("seg1.dcm", one, numbers=[7])
    same("one segment of another number", one[0], *take("seg1.dcm"), type="u1")
    segmentation("seg1.dcm", one, places=[(-20, 30, 112 - 2 * i) for i in range(SLICES)])
    same("from above", one[0][::-1], *take("seg1.dcm"), columns=COLUMNS_MAP)
    # No pixel of two segments.
    label = random.integers(0, 5, SHAPE)
    label[2] = label[4] = 0
    apart = np.array([label == s for s in (1, 2, 3, 4)])
    segmentation("seg4.dcm", apart)
    same("four segments", label, *take("seg4.dcm"), columns=COLUMNS_MAP, type="u1")
    rc, out, _ = start(*take("seg4.dcm"))
    tell("nothing is told", "" if Imported(out).note == "" else Imported(out).note)
    segmentation("seg4.dcm", apart, skip_empty=True)
    same("without empty frames", label, *take("seg4.dcm"), columns=COLUMNS_MAP, type="u1")
    segmentation("seg4.dcm", apart, numbers=[2, 300, 5, 9])
    same("numbers of 16 bits", np.array([0, 2, 300, 5, 9])[label], *take("seg4.dcm"), type="u2")
    rc, out, _ = start(*take("seg4.dcm", "--list"))
    tell("--list", "" if b"labels of 4 segments" in out else out)
    # Pixels of several.
    both = random.random((3,) + SHAPE) < 0.4
    segmentation("seg3.dcm", both)
    want = np.where(both[0], 1, np.where(both[1], 2, np.where(both[2], 3, 0)))
    same("segments that overlap", want, *take("seg3.dcm"), columns=COLUMNS_MAP, type="u1")
    rc, out, _ = start(*take("seg3.dcm"))
    times = (both.sum(0) - both.any(0)).sum()
    tell("are told", "" if "segments overlap, %d times" % times in Imported(out).note else Imported(out).note)
    rc, _, said = start(leafcast, "convert", path("seg3.dcm"), "-o", path("seg3.leaf"), "--force")
    tell("by convert, too", "" if rc == 0 and "segments overlap" in said else said)
    # What is refused.
    segmentation("seg3.dcm", both, kind="FRACTIONAL", bits=8)
    ends("fractional segments", 3, "several fractional segments", *take("seg3.dcm"))
    segmentation("seg1.dcm", one, kind="FRACTIONAL", bits=8)
    same("one fractional segment", one[0] * 200, *take("seg1.dcm"), columns=COLUMNS_MAP, type="u1")
    f = segmentation("seg3.dcm", both)
    f.PixelData = f.PixelData[:-40]
    f.save_as(path("seg_cut.dcm"), write_like_original=False)
    ends("too few bits", 3, "bits, expected", *take("seg_cut.dcm"))
    f = segmentation("seg3.dcm", both)
    del f.PerFrameFunctionalGroupsSequence[5].SegmentIdentificationSequence
    f.save_as(path("seg_cut.dcm"), write_like_original=False)
    ends("a frame of no segment", 3, "frame 5 (counted from 0)", *take("seg_cut.dcm"))
    f = segmentation("seg3.dcm", both)
    del f.SegmentSequence
    f.save_as(path("seg_cut.dcm"), write_like_original=False)
    ends("single bits of no segments", 3, "not of 8, 16 or 32 bits", *take("seg_cut.dcm"))
    os.makedirs(path("segs"))
    segmentation("segs/a.dcm", both)
    segmentation("segs/b.dcm", both)
    ends("two files", 3, "give one of them", *take("segs"))
    if shutil.which("dcmcrle"):
        f = segmentation("seg3.dcm", both)
        f.file_meta.TransferSyntaxUID = "1.2.840.10008.1.2.5"
        f.PixelData = pydicom.encaps.encapsulate([f.PixelData])
        f["PixelData"].is_undefined_length = True
        f.save_as(path("seg_cut.dcm"), write_like_original=False)
        ends("compressed bits", 3, "single bits, compressed", *take("seg_cut.dcm"))
    os.makedirs(path("segd"))
    segmentation("segd/a.dcm", both)
    shutil.copy(path("segd/a.dcm"), path("seg_whole"))
    damaged("damaged segments", path("seg_whole"), path("segd/a.dcm"), 50, *take("segd"))


def colours():
    rgb = random.integers(0, 255, SHAPE + (3,), dtype="u1")
    series("rgb", rgb)
    same("a colour", rgb[..., 1], *take("rgb", "--component", "2"), type="u1")
    series("planes", [np.moveaxis(p, 2, 0).reshape(ROWS, COLUMNS, 3) for p in rgb], PlanarConfiguration=1)
    same("a colour of planes", rgb[..., 2], *take("planes", "--component", "3"), type="u1")
    rc, out, said = start(*take("rgb"))
    light = (rgb * [0.2126, 0.7152, 0.0722]).sum(3)
    tell("luminance", "" if rc == 0 and np.allclose(Imported(out).samples, light, rtol=1e-6) else said)


def hostile():
    series("sound", random.integers(0, 99, (3, ROWS, COLUMNS), dtype="u2"))
    whole = path("sound/001.dcm")
    shutil.copy(whole, path("whole"))
    damaged("damaged files", path("whole"), whole, 100, *take("sound"))
    for tool in ("dcmcrle", "dcmcjpls", "dcmcjpeg"):
        if shutil.which(tool):
            subprocess.run([tool, path("whole"), path("whole_z")], check=True, stderr=subprocess.DEVNULL)
            damaged("damaged files by " + tool, path("whole_z"), whole, 30, *take("sound"))


def real():
    """Dose and slices that come with pydicom."""
    files = os.path.join(os.path.dirname(pydicom.__file__), "data", "test_files")
    dose = os.path.join(files, "rtdose.dcm")
    if not os.path.exists(dose):
        return print("real data\tskip no files of pydicom's tests here")
    for name in ("rtdose.dcm", "rtdose_expb.dcm", "rtdose_rle.dcm"):
        f = pydicom.dcmread(os.path.join(files, name))
        same("a real dose, " + name, f.pixel_array * float(f.get("DoseGridScaling", 1)), leafcast, "import-dicom",
             os.path.join(files, name))
    ends("a real report", 3, "without an image", leafcast, "import-dicom", os.path.join(files, "test-SR.dcm"))
    os.makedirs(path("bare"))
    f = pydicom.dcmread(os.path.join(files, "MR_small.dcm"))
    for i in range(3):
        f.ImagePositionPatient[2] = 10 * i
        f.SOPInstanceUID = generate_uid()
        pydicom.filewriter.write_file(path("bare/%d.dcm" % i), f, write_like_original=True)
        if i == 1:  # without preamble and meta information, as old ones are
            bare = Dataset(f)
            bare.is_little_endian, bare.is_implicit_VR = True, False
            pydicom.filewriter.write_file(path("bare/%d.dcm" % i), bare)
    same("a real slice thrice, one without meta information", [f.pixel_array] * 3, *take("bare"))


def preambles():
    """The first 128 bytes are anyone's, and may look like any other format: DICM behind them tells."""
    a = random.integers(0, 65535, SHAPE, dtype="u2")
    f = image(a, SpacingBetweenSlices=3, PixelSpacing=[0.5, 0.25])
    node = b"8 3 0 0\n" + b"".join(b"%d 0 0 0\n" % i for i in range(8))
    suffixes = itertools.cycle((".dcm", ".nii", ".node"))
    for k, (other, head) in enumerate((
            ("nothing", b""), ("Analyze 7.5", b"\x5c\x01\0\0"), ("Analyze 7.5, big endian", b"\0\0\x01\x5c"),
            ("NIfTI-2", b"\x1c\x02\0\0n+2\0\r\n\x1a\n"), ("TIFF", b"II*\0\x08\0\0\0"), ("BigTIFF", b"MM\0+"),
            ("NRRD", b"NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 2 2\nencoding: raw\n\n"),
            ("MetaImage", b"ObjectType = Image\nNDims = 3\n"), ("NumPy", b"\x93NUMPY\x01\0"), ("PVM", b"PVM\n2 2 2\n"),
            ("a mesh stream", b"LEAFCAST MESH 1\n"), ("Gmsh", b"$MeshFormat\n4.1 0 8\n"),
            ("VTK", b'<VTKFile type="ImageData">'), ("a VTK mesh", b'<VTKFile type="UnstructuredGrid">'),
            ("legacy VTK", b"# vtk DataFile Version 3.0\nx\nASCII\nDATASET STRUCTURED_POINTS\n"),
            ("HDF5", b"\x89HDF\r\n\x1a\n"), ("NetCDF", b"CDF\x02"), ("PNG", b"\x89PNG\r\n\x1a\n"),
            ("JPEG", b"\xff\xd8\xff\xe0"), ("OpenVDB", b" BDV\0\0\0\0"), ("gzip", b"\x1f\x8b\x08"), ("bzip2", b"BZh9"),
            ("xz", b"\xfd7zXZ\0"), ("zstd", b"\x28\xb5\x2f\xfd"), ("PDF", b"%PDF-1.4"), ("PLY", b"ply\n"), ("nodes", node))):
        f.preamble = head[:128].ljust(128, b"\0")
        for suffix in ("", next(suffixes)):
            name, wrong = path("preamble" + suffix), ""
            f.save_as(name, write_like_original=False)
            if not WATCHED or k % 6 == 0:  # what info says it is, convert takes it for
                rc, out, said = start(leafcast, "convert", name, "-o", path("preamble.leaf"), "--force")
                if rc == 0:
                    rc, out, said = start(leafcast, "export", path("preamble.leaf"), "-o", path("preamble.raw"), "--force")
                wrong = said if rc else "" if open(path("preamble.raw"), "rb").read() == a.tobytes() else "other samples"
            if not wrong:
                rc, out, said = start(leafcast, "info", name, "--json", "--quick")
                wrong = said if rc else "" if json.loads(out)["format"] == "DICOM" else out.decode()
            tell("a preamble of %s, as *%s" % (other, suffix), wrong)
        ends("and as a surface: " + other, 3, "this is DICOM", leafcast, "tetrahedralize", path("preamble"), "-o", path("x.mesh"))


def no_slices():
    """Frames beside one another, or after one another: refused by name, by each of what tells."""
    from pydicom.tag import Tag
    a = random.integers(0, 255, SHAPE, dtype="u1")
    tiled = "tiles of one flat picture"
    cine = "frames one after another in time"
    slide = "1.2.840.10008.5.1.4.1.1.77.1.6"
    where = dict(SpacingBetweenSlices=3, PixelSpacing=[0.5, 0.25])
    ultrasound = dict(Modality="US", SOPClassUID="1.2.840.10008.5.1.4.1.1.3.1")
    for name, words, tags in (
            ("a whole slide, by its class", tiled, dict(Modality="SM", SOPClassUID=slide)),
            ("a whole slide, by its size", tiled, dict(TotalPixelMatrixColumns=4 * COLUMNS, TotalPixelMatrixRows=2 * ROWS)),
            ("tiles, by their organisation", tiled, dict(DimensionOrganizationType="TILED_FULL")),
            ("tiles in some places", tiled, dict(DimensionOrganizationType="TILED_SPARSE")),
            ("cine, by its pointer", cine, dict(FrameIncrementPointer=Tag(0x0018, 0x1063), FrameTime="33.3", **ultrasound)),
            ("cine, uneven", cine, dict(FrameIncrementPointer=Tag(0x0018, 0x1065), FrameTimeVector=[0] + [30] * (SLICES - 1))),
            ("cine, by several", cine, dict(FrameIncrementPointer=[Tag(0x0018, 0x1063), Tag(0x0020, 0x0013)], FrameTime="40")),
            ("cine without a pointer", cine, dict(FrameTime="33.3", **ultrasound)),
            ("slices by number", "", dict(FrameIncrementPointer=Tag(0x0020, 0x0013))),
            ("slices of a dose, with a time", "", dict(GridFrameOffsetVector=[2 * i for i in range(SLICES)], FrameTime="1",
                                                       ImagePositionPatient=[0, 0, 0], ImageOrientationPatient=[1, 0, 0, 0, 1, 0]))):
        f = image(a, **where, **tags)
        f.file_meta.MediaStorageSOPClassUID = f.SOPClassUID
        f.save_as(path("frames.dcm"), write_like_original=False)
        if not words:
            same(name, a, *take("frames.dcm"))
            continue
        ends(name, 3, words, *take("frames.dcm"))
        ends(name + ", converted", 3, words, leafcast, "convert", path("frames.dcm"), "-o", path("frames.leaf"))
        ends(name + ", in a folder", 3, words, leafcast, "info", folder_of("frames.dcm"))


def folder_of(name):
    os.makedirs(path("alone"), exist_ok=True)
    shutil.copy(path(name), path("alone/a.dcm"))
    return path("alone")


for part in (types, rescale, places, faults, studies, compressed, j2k, several_frames, segments, colours, hostile, real, preambles,
             no_slices):
    part()
