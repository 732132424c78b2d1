#!/usr/bin/env python3
"""export_steps.py MODULE FOLDER - what nibabel or zarr read of the files of export_steps.sh."""
import json
import sys

import numpy as np

module, folder = sys.argv[1:3]
SHAPE = (33, 41, 70)


def tell(name, right):
    print(name + "\t" + ("right" if right else "differs"))


def samples(name):
    return np.frombuffer(open("%s/%s.nrrd" % (folder, name), "rb").read()[-2 * 33 * 41 * 70:], "<u2").reshape(SHAPE)


steps = np.stack([samples("s%d" % i) for i in range(4)])


def nibabel():
    import nibabel as nib
    for name, kind in (("a.nii", nib.Nifti1Image), ("a.nii.gz", nib.Nifti1Image), ("2.nii", nib.Nifti2Image),
                       ("u.nii", nib.Nifti1Image)):
        image = nib.load(folder + "/" + name)
        head = image.header
        tell(name + ": its kind", isinstance(image, kind))
        tell(name + ": samples", np.array_equal(np.asanyarray(image.dataobj).T, steps))
        want = (0.5, 0.75, 2, 1 if name == "u.nii" else 2.5)
        tell(name + ": distances", np.allclose(head.get_zooms(), want, rtol=1e-6))
        tell(name + ": where times start", head["toffset"] == (0 if name == "u.nii" else 1))
        tell(name + ": the unit", head.get_xyzt_units()[0] == ("unknown" if name == "u.nii" else "mm"))
        tell(name + ": a place", np.allclose(image.affine @ [3, 5, 7, 1], [1.5, 3.75, 14, 1]))
    tell("1.nii has three axes", nib.load(folder + "/1.nii").shape == SHAPE[::-1])


def zarr():
    import zarr
    for name, want in (("a", steps), ("b", steps), ("2", steps[2]), ("c", steps), ("u", steps)):
        group = zarr.open(folder + "/" + name + ".zarr", "r")
        image = group.attrs["multiscales"][0]
        tell(name + ".zarr: samples", np.array_equal(group[image["datasets"][0]["path"]][...], want))
        axes = [a["name"] for a in image["axes"]]
        tell(name + ".zarr: axes", axes == list("tzyx")[4 - want.ndim:])
        scale, move = image["datasets"][0]["coordinateTransformations"]
        tell(name + ".zarr: scale", scale == {"type": "scale", "scale": ([1 if name == "u" else 2.5, 2, 0.75, 0.5])[4 - want.ndim:]})
        tell(name + ".zarr: translation",
             move == {"type": "translation", "translation": [0 if name == "u" else 1, 0, 0, 0][4 - want.ndim:]})
        units = [a.get("unit") for a in image["axes"][-3:]]
        tell(name + ".zarr: units", units == [None if name == "u" else "millimeter"] * 3)
    group = zarr.open(folder + "/box.zarr", "r")
    scale, move = group.attrs["multiscales"][0]["datasets"][0]["coordinateTransformations"]
    tell("box.zarr: shape", group["0"].shape == (16, 17, 31))
    tell("box.zarr: scale", scale["scale"] == [4, 1.5, 1])
    tell("box.zarr: translation", move["translation"] == [4, 3, 3])
    tell("box.zarr: chunks", group["0"].nchunks == group["0"].nchunks_initialized == 1)
    whole = json.load(open(folder + "/a.zarr/0/.zarray"))
    tell("a.zarr: chunks", whole["chunks"] == [1, 33, 41, 64] and whole["compressor"]["id"] == "zstd")


globals()[module]()
