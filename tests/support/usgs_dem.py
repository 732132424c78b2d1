"""usgs_dem.py - digital elevation models as the U.S. Geological Survey writes them."""


def model():
    """Three profiles of four elevations."""
    head = "HILLS".ljust(144) + "%6d%6d%6d%6d" % (1, 1, 1, 10) + "%24s" % "0.0D+00" * 15 + "%6d%6d%6d" % (2, 2, 4)
    head += "%24s" % "0.0D+00" * 11 + "%6d" % 0 + "%12s" % "0.3E+02" * 2 + "%12s" % "0.1E+01" + "%6d%6d" % (1, 3)
    profiles = ["%6d%6d%6d%6d" % (1, x + 1, 4, 1) + "%24s" % ("%d.0D+00" % (30 * x)) + "%24s" % "0.0D+00" * 4
                + "".join("%6d" % (10 * x + y) for y in range(4)) for x in range(3)]
    return "".join(record.ljust(1024) for record in [head] + profiles)
