"""WATCHED: whether a sanitizer watches the build under test; what takes long does less there, as by watched.h."""
import os, re

WATCHED = bool(re.search("/(sanitize|thread)", os.environ.get("LEAFCAST_BUILD", "")))
