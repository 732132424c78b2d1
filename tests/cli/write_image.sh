#!/bin/sh
# write_image.sh - the picture helper: what it writes, and that no stream makes it write rubbish.
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
meta = [(b"iso", b"128")] + ([(b"colour", b"linear")] if "linear" in sys.argv else [])
with open(out, "wb") as f:
    f.write(struct.pack("<4s4I", b"LFIM", 1, w, h, len(names)))
    f.write(b"".join(n.encode().ljust(32, b"\0") for n in names))
    f.write(struct.pack("<I", len(meta)))
    for k, v in meta:
        f.write(struct.pack("<I", len(k)) + k + struct.pack("<I", len(v)) + v)
    for c, n in enumerate(names):
        value = {"Z": math.inf, "id": -1.0, "A": 1.0}.get(n, c / 4)
        f.write(array.array("f", [value] * (w * h)).tobytes())
PY
stream() { python3 "$tmp/stream.py" "$@"; }
feed() { "$helper" "$2" --force <"$1" >"$tmp/out" 2>"$tmp/err"; }
status() { rc=0; feed "$@" || rc=$?; [ "$rc" = "$want" ]; }
info() { oiiotool --info -v "$1" >"$tmp/out" 2>&1; grep -q -- "$2" "$tmp/out"; }
pixel() { oiiotool "$1" --printstats >"$tmp/out" 2>&1; grep -q "Stats Max: $2" "$tmp/out"; }

stream "$tmp/all" R,G,B,A,Z,N.x,N.y,N.z,id
want=0
ok "EXR is written" status "$tmp/all" "$tmp/all.exr"
ok "EXR has all channels" info "$tmp/all.exr" "7 x *5, 9 channel, float openexr"
ok "EXR keeps the metadata" info "$tmp/all.exr" 'leafcast:iso: "128"'
ok "PNG is written" status "$tmp/all" "$tmp/all.png"
ok "PNG has four channels of 8 bits" info "$tmp/all.png" "7 x *5, 4 channel, uint8 png"
ok "PNG is sRGB encoded: 0, 1/4, 1/2, 1" pixel "$tmp/all.png" "0 137 188 255"
stream "$tmp/rgb" R,G,B 7 5 linear
ok "PNG of RGB alone" status "$tmp/rgb" "$tmp/rgb.png"
ok "linear PNG is not encoded, and opaque" pixel "$tmp/rgb.png" "0 64 128 255"
for kind in png exr; do
    cp "$tmp/all.$kind" "$tmp/first.$kind"
    feed "$tmp/all" "$tmp/all.$kind"
    ok "the same stream, the same bytes ($kind)" cmp "$tmp/first.$kind" "$tmp/all.$kind"
done
stream "$tmp/tall" R,G,B 3 131
ok "a height that is no multiple of a band" status "$tmp/tall" "$tmp/tall.exr"
ok "has all rows" info "$tmp/tall.exr" "3 x *131, 3 channel"

exits "an existing picture is refused without --force" 1 "$helper" "$tmp/all.png"
ok "and left alone" cmp "$tmp/first.png" "$tmp/all.png"
exits "an unknown kind is a usage error" 2 sh -c "$helper $tmp/x.jpg <$tmp/all"
exits "no folder" 1 sh -c "$helper $tmp/none/x.png <$tmp/all"

want=3
bytes=$(wc -c <"$tmp/all")
prefixes_refused() {
    for n in 0 3 4 8 12 19 20 40 100 310 320 "$((bytes / 2))" "$((bytes - 1))"; do
        head -c "$n" "$tmp/all" >"$tmp/part"
        status "$tmp/part" "$tmp/part.exr" || return 1
    done
}
patched() { # patched OFFSET BYTES: the stream with these bytes, in printf's notation, there
    cp "$tmp/all" "$tmp/bad"
    printf "$2" | dd of="$tmp/bad" bs=1 seek="$1" conv=notrunc 2>/dev/null
    status "$tmp/bad" "$tmp/bad.exr"
}
ok "every prefix is refused" prefixes_refused
{ cat "$tmp/all"; echo; } >"$tmp/long"
ok "a longer stream is refused" status "$tmp/long" "$tmp/long.exr"
ok "wrong magic" patched 0 'X'
ok "wrong version" patched 4 '\002'
ok "width 0" patched 8 '\000'
ok "width of 4 billion" patched 8 '\377\377\377\377'
ok "too many channels" patched 16 '\377\377'
ok "no channel" patched 16 '\000'
ok "two channels of one name" patched 20 'G'
ok "a name with a line feed" patched 20 '\n'
ok "a metadata length of 4 billion" patched 312 '\377\377\377\377'
stream "$tmp/z" Z
ok "PNG without R" status "$tmp/z" "$tmp/z.png"
left() { [ -z "$(find "$tmp" -name 'part*.exr' -o -name 'bad*.exr' -o -name '*.tmp')" ]; }
ok "nothing half-written is left" left
finish
