#!/bin/sh
# samples.sh - render --samples: the same bits whatever draws them, and edges that come nearer to the truth.
# marks: long
. tests/support/tap.sh

says() { grep -q -- "$1" "$tmp/err"; }
run "$leafcast" generate sphere --dims 65 --type f32 -o "$tmp/s.nrrd"
exits "a sphere" 0 "$leafcast" convert "$tmp/s.nrrd" -o "$tmp/s.leaf" -q
run "$leafcast" generate gyroid --dims 48 -o "$tmp/g.nrrd"
exits "a volume of many edges" 0 "$leafcast" convert "$tmp/g.nrrd" -o "$tmp/g.leaf" --treelet 16 -q
run "$leafcast" generate gyroid --dims 20 --tets -o "$tmp/g.mesh"
exits "a mesh of it" 0 "$leafcast" convert "$tmp/g.mesh" -o "$tmp/m.leaf" -q

# ---- what is asked for ----
for n in 0 2 3 5 9 17 -1 x 4.0; do
    exits "--samples $n" 2 "$leafcast" render "$tmp/s.leaf" --iso 0.6 "--samples=$n" -o "$tmp/x.png"
    ok "names it" says '--samples'
done
ok "nothing is written" [ ! -e "$tmp/x.png" ]
exits "a probe follows one ray" 2 "$leafcast" probe "$tmp/s.leaf" --iso 0.6 --samples 4 --at 1,1

# ---- the same bits ----
w=61 h=47
[ -z "$watched" ] || w=31 h=23
rich="--opacity 0.4 --opacity 1 --light 1,0.4,2 --shadows --shading phong --size ${w}x$h --view close -q"
isos() { case $1 in */m.leaf) echo --iso=-0.2 --iso=0.3 ;; *) echo --iso=110 --iso=140 ;; esac }
draw() { # draw NAME FILE FLAG...
    tap_base=$tmp/$1 tap_leaf=$2
    shift 2
    # shellcheck disable=SC2046,SC2086 # lists
    "$leafcast" render "$tap_leaf" $(isos "$tap_leaf") $rich "$@" -o "$tap_base.pfm" --depth-f64 "$tap_base.f64" --force
}
alike() { # alike NAME FILE FLAG...
    tap_as=$1 tap_of=$2
    shift 2
    draw now "$tap_of" "$@" && cmp "$tmp/now.pfm" "$tmp/$tap_as.pfm" && cmp "$tmp/now.f64" "$tmp/$tap_as.f64"
}
for kind in g m; do
    draw one_$kind "$tmp/$kind.leaf"
    ok "$kind: one sample is the pixel's centre" alike one_$kind "$tmp/$kind.leaf" --samples 1
    for n in 4 16; do
        ok "$kind: $n samples" draw many "$tmp/$kind.leaf" --samples $n
        ok "$kind: distances stay the centre's" cmp "$tmp/many.f64" "$tmp/one_$kind.f64"
        ok "$kind: colours do not" sh -c '! cmp -s "$1" "$2"' - "$tmp/many.pfm" "$tmp/one_$kind.pfm"
        [ $n = 4 ] || one_in 2 || continue # more samples go the same ways
        ok "$kind: the same bits from one thread" alike many "$tmp/$kind.leaf" --samples $n --threads 1
        ok "$kind: from five" alike many "$tmp/$kind.leaf" --samples $n --threads 5
        for isa in scalar sse42 avx2; do
            "$leafcast" render "$tmp/$kind.leaf" --iso 0.1 --size 8x8 --isa $isa --json >/dev/null 2>&1 || continue
            ok "$kind: from $isa" alike many "$tmp/$kind.leaf" --samples $n --isa $isa
        done
        for backend in mapped arena; do
            ok "$kind: from one treelet, $backend" alike many "$tmp/$kind.leaf" --samples $n --treelet-limit 1 --backend $backend
        done
    done
done
# shellcheck disable=SC2046,SC2086 # lists
"$leafcast" render "$tmp/g.leaf" $(isos g) $rich --samples 4 --memory 100K -o "$tmp/y.pfm" 2>"$tmp/err"
need=$(sed -n 's/.*: \([0-9]*\) bytes would do.*/\1/p' "$tmp/err")
ok "the smallest budget that would do is named ($need)" [ "$need" -gt 0 ]
draw four "$tmp/g.leaf" --samples 4
# The distances that draw() takes as well are 8 bytes a pixel.
ok "and does" alike four "$tmp/g.leaf" --samples 4 --memory $((need + w * h * 8))
# shellcheck disable=SC2046,SC2086 # lists
one=$("$leafcast" render "$tmp/g.leaf" $(isos g) $rich --memory 100K -o "$tmp/y.pfm" 2>&1 | sed -n 's/.*: \([0-9]*\) bytes would do.*/\1/p')
ok "samples need another picture's colours" [ $((need - one)) = $((w * h * 12)) ]

# ---- in scripts ----
cat >"$tmp/script" <<JSON
{"iso": [110, 140], "opacity": [0.4, 1], "light": [1, 0.4, 2], "shadows": true, "shading": "phong", "size": "${w}x$h", "view": "close", "samples": 4, "output": "$tmp/script.pfm"}
{"iso": 110, "samples": 5}
JSON
exits "a script of two lines, one wrong" 1 "$leafcast" render "$tmp/g.leaf" --script "$tmp/script"
ok "says which" says 'line 2: --samples'
ok "draws the same" cmp "$tmp/script.pfm" "$tmp/four.pfm"

# ---- coverage ----
# White without shading: a pixel is the share of it that the sphere covers. Seen from D = 128 the sphere of R = 25.6
# is a disc of tan(asin(R / D)).
for n in 1 4 16; do
    run "$leafcast" render "$tmp/s.leaf" --iso 0.6 --samples $n --shading flat --colour 1,1,1 --size 101x97 \
        --eye 32,32,160 --look-at 32,32,32 --up 0,1,0 --fov 30 --background 0,0,0,0 -o "$tmp/c$n.pfm" -q
done
cat >"$tmp/coverage.py" <<'PY'
import array, math, sys
def read(name):
    data = open(name, "rb").read().split(b"\n", 3)
    w, h = map(int, data[1].split())
    return w, h, array.array("f", data[3])[::3]
errors = []
for name in sys.argv[1:]:
    w, h, red = read(name)
    radius = math.tan(math.asin(25.6 / 128)) / math.tan(math.radians(15)) * h / 2
    squares, edge, sub = 0.0, 0, 40
    for y in range(h):
        for x in range(w):
            cx, cy = x + 0.5 - w / 2, y + 0.5 - h / 2
            r = math.hypot(cx, cy)
            if abs(r - radius) > 1:
                assert red[y * w + x] == (1.0 if r < radius else 0.0), (x, y)
                continue
            inside = sum((cx + (i + 0.5) / sub - 0.5) ** 2 + (cy + (j + 0.5) / sub - 0.5) ** 2 < radius ** 2
                         for i in range(sub) for j in range(sub)) / sub ** 2
            squares += (red[y * w + x] - inside) ** 2
            edge += 1
    errors.append(math.sqrt(squares / edge))
print(*errors)
ok = errors[0] > 0.15 and errors[1] < 0.4 * errors[0] and errors[2] < 0.5 * errors[1] and errors[2] < 0.035
sys.exit(not ok)
PY
coverage() { python3 "$tmp/coverage.py" "$tmp/c1.pfm" "$tmp/c4.pfm" "$tmp/c16.pfm" >"$tmp/out" 2>"$tmp/err"; }
ok "errors of a sphere's coverage fall with the samples" coverage
echo "# root mean square errors at the edge: $(cat "$tmp/out")"
finish
