#!/bin/sh
# tetrahedralize.sh - points and surfaces to mesh streams, through pipes to pictures; every failure
# with its message and exit code; Ctrl-C leaves nothing behind.
# marks: long
. tests/support/tap.sh

worker=$(dirname "$leafcast")/../libexec/leafcast-tetgen
if [ ! -x "$worker" ]; then
    skip "leafcast tetrahedralize" "no TetGen here"
    finish
fi
says() { grep -q -- "$1" "$tmp/err"; }
prints() { grep -q -- "$1" "$tmp/out"; }
absent() { [ -z "$(find "$tmp" -name "$1*")" ]; }

cat >"$tmp/make.py" <<'PY'
import array, math, random, struct, subprocess, sys
folder = sys.argv[1] + "/"
random.seed(4)

# points of a sphere's inside, with two fields
with open(folder + "cloud.csv", "w") as f:
    f.write("x,y,z,heat,count\n")
    for i in range(3000):
        p = [random.uniform(-1, 1) for _ in range(3)]
        if sum(c * c for c in p) < 1:
            f.write("%r,%r,%r,%r,%d\n" % (*p, math.sqrt(sum(c * c for c in p)), i))

# a torus of 96 x 48 quads, as OFF, STL in text and binary, PLY
N, M = 96, 48
V, F = [], []
for i in range(N):
    for j in range(M):
        u, v = 2 * math.pi * i / N, 2 * math.pi * j / M
        V.append(((2 + .7 * math.cos(v)) * math.cos(u), (2 + .7 * math.cos(v)) * math.sin(u),
                  .7 * math.sin(v)))
        at = lambda a, b: (i + a) % N * M + (j + b) % M
        F += [(at(0, 0), at(1, 0), at(1, 1)), (at(0, 0), at(1, 1), at(0, 1))]
V = [struct.unpack("3f", struct.pack("3f", *v)) for v in V]

def off(name, V, F):
    with open(folder + name, "w") as f:
        f.write("OFF\n%d %d 0\n" % (len(V), len(F)))
        f.writelines("%r %r %r\n" % v for v in V)
        f.writelines("3 %d %d %d\n" % t for t in F)

off("torus.off", V, F)
off("open.off", V, F[:-1])
W = [(x + .5, y, z) for x, y, z in V]
off("cross.off", V + W, F + [tuple(i + len(V) for i in t) for t in F])
with open(folder + "torus.stl", "wb") as f:
    f.write(b"\0" * 80 + struct.pack("<I", len(F)))
    for t in F:
        f.write(struct.pack("<12fH", 0, 0, 0, *(c for i in t for c in V[i]), 0))
with open(folder + "torus.ply", "wb") as f:
    f.write(b"ply\nformat binary_big_endian 1.0\nelement vertex %d\nproperty float x\n"
            b"property float y\nproperty float z\nproperty float height\nelement face %d\n"
            b"property list uchar uint vertex_index\nend_header\n" % (len(V), len(F)))
    for v in V:
        f.write(struct.pack(">4f", *v, v[2]))
    for t in F:
        f.write(struct.pack(">B3I", 3, *t))
print(abs(sum(V[a][k] * (V[b][k - 2] * V[c][k - 1] - V[b][k - 1] * V[c][k - 2])
              for a, b, c in F for k in range(3))) / 6)
PY
volume=$(python3 "$tmp/make.py" "$tmp")
# within NUMBER NUMBER RELATIVE
within() { awk -v a="$1" -v b="$2" -v r="$3" 'BEGIN { d = a - b; exit !(d * d <= r * r * b * b) }'; }
value() { sed -n "s/^ *\"$1\": \(.*[^,]\),\{0,1\}$/\1/p" "$tmp/out" | tr -d '"'; }

exits "points" 0 "$leafcast" tetrahedralize "$tmp/cloud.csv" -o "$tmp/cloud.mesh" --json
ok "are all in the mesh" [ "$(value points)" = "$(value points_in)" ]
ok "with the first field" [ "$(value field)" = heat ]
ok "and fill their hull" within "$(value volume)" 4.19 0.15
exits "another field, from a pipe" 0 sh -c "'$leafcast' tetrahedralize - --format csv --field count \
    -o - <'$tmp/cloud.csv' | '$leafcast' convert - -o '$tmp/cloud.leaf'"
ok "by its name" prints "field *count"

for kind in off stl ply; do
    exits "a torus, .$kind" 0 "$leafcast" tetrahedralize "$tmp/torus.$kind" -o "$tmp/$kind.mesh" \
        --json --max-volume 0.001
    ok "has the volume that the surface encloses" within "$(value volume)" "$volume" 1e-6
    ok "with distances, welded" [ "$(value field) $(value points_in)" = "distance 4608" ]
done
ok "the same bytes of OFF and PLY, whatever the files' names" cmp "$tmp/off.mesh" "$tmp/ply.mesh"
exits "a field of the surface" 0 "$leafcast" tetrahedralize "$tmp/torus.ply" --field height \
    --max-volume 0.001 -o "$tmp/height.mesh"
exits "a picture of it" 0 sh -c "'$leafcast' convert '$tmp/height.mesh' -o '$tmp/height.leaf' &&
    '$leafcast' probe '$tmp/height.leaf' --point 2.6,0,0.2"
ok "the field is the height" sh -c "grep -q '^value: 0\.2' '$tmp/out'"
exits "tetrahedralize, convert, render" 0 sh -c "'$leafcast' tetrahedralize '$tmp/torus.stl' -o - \
    --max-volume 0.001 -q | '$leafcast' convert - -o '$tmp/torus.leaf' -q &&
    '$leafcast' render '$tmp/torus.leaf' --iso 0.3 --depth-f64 '$tmp/depth' --size 64x64"
ok "every ray that meets the inner torus hits" python3 - "$tmp/depth" <<'PY'
import array, math, sys
z = array.array("d", open(sys.argv[1], "rb").read())
assert len(z) == 4096
hits = sum(map(math.isfinite, z))
assert 150 < hits < 1500, hits
PY
exits "coarser tets" 0 "$leafcast" tetrahedralize "$tmp/torus.off" -o "$tmp/coarse.mesh" \
    --quality 5 --json
coarse=$(value tets)
exits "better tets" 0 "$leafcast" tetrahedralize "$tmp/torus.off" -o "$tmp/coarse.mesh" --force \
    --quality 1.2,12 --json
ok "are more" [ "$(value tets)" -gt "$coarse" ]

exits "without --force nothing is overwritten" 1 "$leafcast" tetrahedralize "$tmp/torus.off" \
    -o "$tmp/off.mesh"
exits "an open surface" 3 "$leafcast" tetrahedralize "$tmp/open.off" -o "$tmp/x.mesh"
ok "and where" says "open.off: the surface is open: facet [0-9]* (counted from 0) has the edge"
exits "a surface that cuts itself" 3 "$leafcast" tetrahedralize "$tmp/cross.off" -o "$tmp/x.mesh"
ok "and where" says "cross.off: the surface cuts itself: facets [0-9]* and [0-9]* (counted"
ok "and what repairs it" says "meshfix in.ply -o out' repairs such surfaces into out.off"
printf '0 0 0\n1 0 0\n0 1 0\n' >"$tmp/three.csv"
exits "three points" 3 "$leafcast" tetrahedralize "$tmp/three.csv" -o "$tmp/x.mesh"
ok "and what is expected" says "three.csv: 3 different points, expected 4 or more"
printf '4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 nan 0 1\n' >"$tmp/nan.node"
exits "NaN" 3 "$leafcast" tetrahedralize "$tmp/nan.node" -o "$tmp/x.mesh"
ok "and where" says "nan.node: line 5: point 3 (counted from 0): x is nan, expected a finite"
printf '0 0 1\n1 0 1\n0 1 1\n5 5 1\n' >"$tmp/plane.csv"
exits "points in a plane" 3 "$leafcast" tetrahedralize "$tmp/plane.csv" -o "$tmp/x.mesh"
ok "and what is expected" says "all 4 points lie in one plane .*, expected 4 that do not"
exits "little memory" 4 "$leafcast" tetrahedralize "$tmp/cloud.csv" -o "$tmp/x.mesh" --memory 30M
exits "too many tets for the memory" 4 "$leafcast" tetrahedralize "$tmp/torus.off" \
    -o "$tmp/x.mesh" --memory 100M --max-volume 1e-6
ok "say so" says "TetGen needs more than the .* MiB it was given; --memory gives it more"
exits "too long" 3 "$leafcast" tetrahedralize "$tmp/torus.off" -o "$tmp/x.mesh" --timeout 0.2 \
    --max-volume 1e-6
ok "is said" says "did not come to an end within 0.2 s (--timeout)"
exits "no file" 1 "$leafcast" tetrahedralize "$tmp/none.off" -o "$tmp/x.mesh"
exits "a format unknown" 3 "$leafcast" tetrahedralize "$tmp/make.py" -o "$tmp/x.mesh"
for wrong in "" "-o $tmp/x.mesh" "$tmp/torus.off" "$tmp/torus.off $tmp/torus.stl -o $tmp/x.mesh" \
    "$tmp/torus.off -o $tmp/x.mesh --quality 1" "$tmp/torus.off -o $tmp/x.mesh --quality 2,90" \
    "$tmp/torus.off -o $tmp/x.mesh --max-volume 0" "$tmp/torus.off -o $tmp/x.mesh --timeout -1" \
    "$tmp/cloud.csv -o $tmp/x.mesh --max-volume 1" "$tmp/cloud.csv -o - --json"; do
    # shellcheck disable=SC2086 # a list of arguments
    exits "usage: $wrong" 2 "$leafcast" tetrahedralize $wrong
done

# Ctrl-C while TetGen works: 128 + 2, the worker goes, too.
python3 - "$leafcast" "$tmp" <<'PY'
import os, signal, subprocess, sys, time
leafcast, tmp = sys.argv[1:]
p = subprocess.Popen([leafcast, "tetrahedralize", tmp + "/torus.off", "-o", tmp + "/x.mesh",
                      "--max-volume", "1e-7"], stderr=open(tmp + "/err", "w"),
                     preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL))
def children():
    return [d for d in os.listdir("/proc") if d.isdigit() and parent(d) == p.pid]
def parent(d):
    try:
        return int(open("/proc/%s/stat" % d).read().rsplit(")", 1)[1].split()[1])
    except OSError:
        return 0
while not children():
    time.sleep(0.01)
worker = children()[0]
time.sleep(0.3)
p.send_signal(signal.SIGINT)
code = p.wait()
open(tmp + "/out", "w").write("code %d\nworker %s\n" % (code, os.path.exists("/proc/" + worker)))
PY
ok "Ctrl-C ends it with 130" prints "code 130"
ok "and the worker" prints "worker False"
ok "nothing half-written is left" absent x.mesh

# A real surface: the boundary of an aneurysm's mesh, meshed anew.
if [ -n "$data" ] && [ -e "$data/tet_aneurysm_mesh/tets_i32x4.raw.zst" ]; then
    for f in points_f32x3 tets_i32x4; do
        zstd -dqf "$data/tet_aneurysm_mesh/$f.raw.zst" -o "$tmp/$f"
    done
    was=$(python3 - "$tmp" <<'PY'
import array, sys
tmp = sys.argv[1] + "/"
P = array.array("f", open(tmp + "points_f32x3", "rb").read())
T = array.array("i", open(tmp + "tets_i32x4", "rb").read())
P = [P[i:i + 3] for i in range(0, len(P), 3)]
faces, volume = {}, 0
for i in range(0, len(T), 4):
    t = T[i:i + 4]
    d = [[P[t[c]][k] - P[t[0]][k] for k in range(3)] for c in (1, 2, 3)]
    volume += abs(sum(d[0][k] * (d[1][k - 2] * d[2][k - 1] - d[1][k - 1] * d[2][k - 2])
                      for k in range(3))) / 6
    for c in range(4):
        f = tuple(t[k] for k in range(4) if k != c)
        if faces.pop(tuple(sorted(f)), None) is None:
            faces[tuple(sorted(f))] = f
with open(tmp + "aneurysm.off", "w") as out:
    out.write("OFF %d %d 0\n" % (len(P), len(faces)))
    out.writelines("%.9g %.9g %.9g\n" % tuple(p) for p in P)
    out.writelines("3 %d %d %d\n" % f for f in faces.values())
print(volume)
PY
    )
    exits "a real surface" 0 "$leafcast" tetrahedralize "$tmp/aneurysm.off" -o "$tmp/an.mesh" --json
    ok "has the volume of the mesh it came from" within "$(value volume)" "$was" 1e-5
    ok "and no tets without volume" [ "$(value flat_tets)" = 0 ]
    exits "and can be converted" 0 "$leafcast" convert "$tmp/an.mesh" -o "$tmp/an.leaf"
    exits "and is sound" 0 "$leafcast" verify "$tmp/an.leaf"
else
    skip "a real surface" "no tet_aneurysm_mesh in the data folder"
fi
finish
