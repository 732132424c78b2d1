#!/bin/sh
# write_image.sh - the picture helper: what it writes, and that no stream makes it write rubbish.
# marks: long
. tests/support/tap.sh

helper=$(dirname "$leafcast")/../libexec/leafcast-write-image
if [ ! -x "$helper" ] || ! command -v oiiotool >/dev/null; then
    skip "leafcast-write-image" "no OpenImageIO here"
    finish
fi

# stream FILE CHANNELS [WIDTH HEIGHT]: plane c holds c/4, but Z a mix of inf and numbers, and id -1
cat >"$tmp/stream.py" <<'PY'
import array, math, struct, sys
out, names = sys.argv[1], sys.argv[2].split(",")
w, h = (int(sys.argv[3]), int(sys.argv[4])) if len(sys.argv) > 3 else (7, 5)
with open(out, "wb") as f:
    f.write(struct.pack("<4sI8s3I", b"LFIM", 2, b"exr", w, h, len(names)))
    f.write(b"".join(n.encode().ljust(32, b"\0") for n in names))
    f.write(struct.pack("<I", 1))
    for text in (b"iso", b"128"):
        f.write(struct.pack("<I", len(text)) + text)
    for c, n in enumerate(names):
        value = {"Z": math.inf, "id": -1.0, "A": 1.0}.get(n, c / 4)
        f.write(array.array("f", [value] * (w * h)).tobytes())
PY
# answers FILE PICTURE...: take the helper's answers apart
cat >"$tmp/answers.py" <<'PY'
import struct, sys
data, at = open(sys.argv[1], "rb").read(), 0
for name in sys.argv[2:]:
    magic, size = struct.unpack_from("<4sQ", data, at)
    assert magic == b"LFOK"
    open(name, "wb").write(data[at + 12:at + 12 + size])
    at += 12 + size
assert at == len(data)
PY
stream() { python3 "$tmp/stream.py" "$@"; }
answers() { python3 "$tmp/answers.py" "$tmp/answer" "$@" 2>"$tmp/err"; }
feed() { "$helper" <"$1" >"$tmp/answer" 2>"$tmp/err"; }
status() { rc=0; feed "$@" || rc=$?; [ "$rc" = "$want" ]; }
info() { oiiotool --info -v "$1" >"$tmp/out" 2>&1; grep -q -- "$2" "$tmp/out"; }

stream "$tmp/all" R,G,B,A,Z,N.x,N.y,N.z,id
want=0
ok "EXR is made" status "$tmp/all"
ok "and given back" answers "$tmp/all.exr"
ok "EXR has all channels" info "$tmp/all.exr" "7 x *5, 9 channel, float openexr"
ok "EXR keeps the metadata" info "$tmp/all.exr" 'leafcast:iso: "128"'
stream "$tmp/tall" R,G,B 3 131
cat "$tmp/all" "$tmp/tall" "$tmp/all" >"$tmp/three"
ok "three pictures, one process" status "$tmp/three"
ok "three answers" answers "$tmp/first.exr" "$tmp/tall.exr" "$tmp/third.exr"
ok "the same planes, the same bytes" cmp "$tmp/first.exr" "$tmp/all.exr"
ok "before and after others" cmp "$tmp/first.exr" "$tmp/third.exr"
ok "a height that is no multiple of a band has all rows" info "$tmp/tall.exr" "3 x *131, 3 channel"
exits "no picture is none" 0 "$helper"
exits "arguments are a usage error" 2 "$helper" x.exr

want=3
bytes=$(wc -c <"$tmp/all")
prefixes_refused() {
    for n in 1 3 4 8 12 19 20 40 100 318 328 "$((bytes / 2))" "$((bytes - 1))"; do
        head -c "$n" "$tmp/all" >"$tmp/part"
        status "$tmp/part" && [ ! -s "$tmp/answer" ] || return 1
    done
}
patched() { # patched OFFSET BYTES: the stream with these bytes, in printf's notation, there
    cp "$tmp/all" "$tmp/bad"
    # shellcheck disable=SC2059 # a format of escapes is what it is
    printf "$2" | dd of="$tmp/bad" bs=1 seek="$1" conv=notrunc 2>/dev/null
    status "$tmp/bad"
}
ok "every prefix is refused" prefixes_refused
{ cat "$tmp/all"; echo; } >"$tmp/long"
ok "a byte after a picture is refused" status "$tmp/long"
ok "when the picture is answered" answers "$tmp/long.exr"
ok "wrong magic" patched 0 'X'
ok "wrong version" patched 4 '\001'
ok "unknown format" patched 8 'bmp'
ok "width 0" patched 16 '\000'
ok "width of 4 billion" patched 16 '\377\377\377\377'
ok "too many channels" patched 24 '\377\377'
ok "no channel" patched 24 '\000'
ok "two channels of one name" patched 28 'G'
ok "a name with a line feed" patched 28 '\n'
ok "a metadata length of 4 billion" patched 320 '\377\377\377\377'

# Address space in which a picture of one pixel is made, and more, until it does for a large one of noise.
stream "$tmp/dot" R,G,B 1 1
stream "$tmp/large" R,G,B,A,Z,N.x,N.y,N.z,id 1000 1000
python3 -c 'import random, sys
with open(sys.argv[1], "r+b") as f:
    f.seek(-36000000, 2)
    f.write(random.Random(1).randbytes(36000000))' "$tmp/large"
# shellcheck disable=SC3045 # dash and bash have these
within() { (ulimit -v "$1" && feed "$2"); }
room=200000
until within $room "$tmp/dot" || [ $room -gt 4000000 ]; do room=$((room + 40000)); done
short=0
sweep() {
    until within $room "$tmp/large"; do
        rc=$?
        [ $rc = 4 ] && grep -q "no memory for the picture" "$tmp/err" && [ $room -lt 4000000 ] || return 1
        short=$((short + 1)) room=$((room + 20000))
    done
}
ok "no memory for the planes, for the file's bytes: exit 4" sweep
ok "seen more than once" [ $short -gt 1 ]
finish
