#!/bin/sh
# turned.sh - grids that lie askew in the world: a turned volume under a camera turned alike is the same picture, and what
# other verbs say of a place is the same; a sheared one is what its map says.
. tests/support/tap.sh

says() { grep -q -- "$1" "$tmp/out"; }
run "$leafcast" generate gyroid --dims 40,36,32 --type f32 -o "$tmp/plain.nrrd"
python3 - "$tmp" <<'PY'
import math, sys
folder = sys.argv[1] + "/"
data = open(folder + "plain.nrrd", "rb").read()
at = data.index(b"\n\n") + 2
lines, samples = data[:at].decode().strip().split("\n"), data[at:]
a, b = 0.7, 0.4
turn = [[math.cos(a), -math.sin(a), 0],
        [math.cos(b) * math.sin(a), math.cos(b) * math.cos(a), -math.sin(b)],
        [math.sin(b) * math.sin(a), math.sin(b) * math.cos(a), math.cos(b)]]
origin = [5.0, -3.0, 2.0]
def apply(m, p, o=(0, 0, 0)):
    return [sum(m[r][c] * p[c] for c in range(3)) + o[r] for r in range(3)]
def text(p):
    return ",".join(repr(float(x)) for x in p)
def write(name, m, o):
    head = []
    for line in lines:
        if line.startswith("space directions"):
            line = "space directions: " + " ".join("(" + text([m[r][c] for r in range(3)]) + ")" for c in range(3))
        if line.startswith("space origin"):
            line = "space origin: (" + text(o) + ")"
        head.append(line)
    open(folder + name, "wb").write(("\n".join(head) + "\n\n").encode() + samples)
shear = [[1, 0.3, 0.1], [0, 1, 0.2], [0, 0, 1.5]]
write("turned.nrrd", turn, origin)
write("sheared.nrrd", shear, origin)
eye, look, up, point = [75, 60, 70], [19.5, 17.5, 15.5], [0, 0, 1], [11.25, 12.5, 7.75]
with open(folder + "views", "w") as f:
    f.write(f"{text(eye)} {text(look)} {text(up)} {text(point)}\n")
    f.write(f"{text(apply(turn, eye, origin))} {text(apply(turn, look, origin))} {text(apply(turn, up))} "
            f"{text(apply(turn, point, origin))}\n")
    f.write(f"- - - {text(apply(shear, point, origin))}\n")
PY
for name in plain turned sheared; do
    exits "convert $name" 0 "$leafcast" convert "$tmp/$name.nrrd" -o "$tmp/$name.leaf"
    exits "verify $name" 0 "$leafcast" verify "$tmp/$name.leaf"
    exits "its picture" 0 "$leafcast" render "$tmp/$name.leaf" --iso 0.2 --size 32x32 -o "$tmp/$name.png" --fail-empty
done
draw() { # draw NAME LINE OPTION...: its distances
    name=$1
    read -r eye look up _ <<X
$(sed -n "$2p" "$tmp/views")
X
    shift 2
    run "$leafcast" render "$tmp/$name.leaf" --iso 0.2 --size 80x60 --eye "$eye" --look-at "$look" --up "$up" \
        --depth-f64 "$tmp/$name.f64" -o "$tmp/$name.ppm" --force -q "$@"
}
# Distances differ by rounding alone, and no pixel is there in one and not in the other.
alike() {
    python3 - "$tmp/plain.f64" "$tmp/turned.f64" <<'PY'
import array, math, sys
a, b = array.array("d"), array.array("d")
for to, path in ((a, sys.argv[1]), (b, sys.argv[2])):
    to.frombytes(open(path, "rb").read())
hits = sum(map(math.isfinite, a))
sys.exit(not (len(a) == len(b) and hits > 500 and all(
    x == y or abs(x - y) < 1e-9 * x for x, y in zip(a, b))))
PY
}
for how in "" "--opacity 0.5 --layers 2" "--ortho 60" "--isa scalar"; do
    # shellcheck disable=SC2086 # split on purpose
    {
        draw plain 1 $how
        draw turned 2 $how
    }
    ok "turned alike: the same picture ${how:-as it is}" alike
done
line=0
for name in plain turned sheared; do
    line=$((line + 1))
    exits "probe $name at a place" 0 "$leafcast" probe "$tmp/$name.leaf" --point "$(sed -n "${line}p" "$tmp/views" | cut -d' ' -f4)"
    ok "is in the same cell" says '^cell: 11 12 7$'
    exits "export $name" 0 "$leafcast" export "$tmp/$name.leaf" -o "$tmp/again.nrrd" --force
    run "$leafcast" convert "$tmp/again.nrrd" -o "$tmp/again.leaf" --force
    ok "comes out as it went in" cmp "$tmp/$name.leaf" "$tmp/again.leaf"
done
finish
