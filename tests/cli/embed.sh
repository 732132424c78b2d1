#!/bin/sh
# embed.sh - the installed library: what it shows to the outside, and the examples built on it, as C and as C++,
# shared and static.
# marks: long
. tests/support/tap.sh

case ${LEAFCAST_BUILD:-$PWD/build/release} in
*/build/release) ;;
*)
    skip "the installed library" "only the release build is installed"
    finish
    ;;
esac

exits "make install" 0 make -s install DESTDIR="$tmp/root" PREFIX=/opt
at=$tmp/root/opt
pc() {
    PKG_CONFIG_PATH=$at/lib/pkgconfig pkg-config --define-variable=prefix="$at" "$@" leafcast
}

# ---- names ----
# What the headers declare, outside of braces: one name a line. Inline functions are no symbols.
declared() {
    for h in "$at"/include/leafcast/*.h; do printf '#include "%s"\n' "$h"; done |
        ${CC:-cc} -E -P -I "$at/include/leafcast" -x c - | tr '\n' ' ' | sed 's/[;{}]/&\n/g' |
        awk '{ if (!depth && !/inline|typedef/ && match($0, /leafcast_[a-z_0-9]+ *\(/))
                   print substr($0, RSTART, RLENGTH - 1)
               if (/\{$/) depth++
               if (/\}$/) depth-- }' | sort -u
}
declared >"$tmp/declared"
nm -g --defined-only "$at/lib/libleafcast.a" | awk 'NF == 3 { print $3 }' | sort >"$tmp/archive"
nm -D --defined-only "$at/lib/libleafcast.so" | awk '$2 != "A" { sub(/@.*/, "", $3); print $3 }' |
    sort >"$tmp/shared"
ok "the headers declare functions" grep -q '^leafcast_trace$' "$tmp/declared"
ok "of both halves" grep -q '^leafcast_convert_array$' "$tmp/declared"
exits "the archive shows these and nothing else" 0 diff "$tmp/declared" "$tmp/archive"
exits "and so does the shared library" 0 diff "$tmp/declared" "$tmp/shared"
readelf -d "$at/lib/libleafcast.so" >"$tmp/dynamic"
ok "which has a soname" grep -q 'SONAME.*\[libleafcast\.so\.0\]' "$tmp/dynamic"
ok "under which it is there" [ -e "$at/lib/libleafcast.so.0" ]
heavy='tet|embree|OpenImageIO|openvdb|stdc\+\+|png'
ok "and needs no heavy library" sh -c '! grep NEEDED "$1" | grep -qE "$2"' - "$tmp/dynamic" "$heavy"

# Experiments are for our own programs: the library has none, and says so.
ok "and no experiments" sh -c '! nm "$1" | grep -qE "stepping|preintegrated|packet|intersect_walk|intersector_"' - "$at/lib/libleafcast.a"
cat >"$tmp/experiment.c" <<'EOF'
#include <leafcast_experimental.h>
#include <stdio.h>

static int is_refused(const char *path, leafcast_experiments asked) {
    asked.size = sizeof asked;
    const leafcast_options options = {.size = sizeof options, .experiments = &asked};
    leafcast *volume = NULL;
    const leafcast_status st = leafcast_open(path, &options, &volume);
    puts(leafcast_error_text());
    return st == LEAFCAST_USAGE;
}

static int is_not_drawn(const char *path, leafcast_scene_experiments asked) {
    asked.size = sizeof asked;
    const leafcast_surface surface = leafcast_surface_default(0.5);
    leafcast_scene scene = leafcast_scene_default();
    scene.experiments = &asked;
    double depth[64];
    const leafcast_image image = {.size = sizeof image, .z = depth};
    leafcast *volume = NULL;
    if (leafcast_open(path, NULL, &volume) || leafcast_select(volume, &surface, 1))
        return 0;
    const leafcast_camera camera = leafcast_standard_view(volume, 2.2, 8, 8);
    const leafcast_status st = leafcast_trace(volume, &scene, &camera, &image, NULL, NULL, NULL);
    puts(leafcast_error_text());
    leafcast_close(volume);
    return st == LEAFCAST_USAGE;
}

int main(int argc, char **argv) {
    const leafcast_scene_experiments linear = {.intersector = LEAFCAST_LINEAR};
    const leafcast_experiments by_packets = {.packets = 8}, kept = {.isopolygons = LEAFCAST_ISOPOLYGONS_CACHE};
    return argc > 1 && is_refused(argv[1], by_packets) && is_refused(argv[1], kept) && is_not_drawn(argv[1], linear) ? 0 : 1;
}
EOF

# ---- examples ----
exits "generate" 0 "$leafcast" generate marschner-lobb --dims 24 -o "$tmp/m.nrrd" -q
exits "convert" 0 "$leafcast" convert "$tmp/m.nrrd" -o "$tmp/m.leaf" -q

# like_render: the verb's picture; a byte may be another at the very border between two.
like_render() {
    "$leafcast" verify "$tmp/made.leaf" -q &&
        "$leafcast" render "$tmp/made.leaf" --size 320x240 --background 0,0,0 -o "$tmp/want.ppm" --force -q &&
    [ "$(wc -c <"$tmp/got.ppm")" = "$(wc -c <"$tmp/want.ppm")" ] &&
        [ "$(cmp -l "$tmp/got.ppm" "$tmp/want.ppm" | wc -l)" -le 2 ]
}

# as_expected: hits of both isovalues, in order of t on each ray, a bound with each.
as_expected() {
    awk '$1 == ray && $2 < t { exit bad = 1 }
         !($2 >= 0 && $2 <= 1 && $4 >= 0 && ($3 == 100 || $3 == 140)) { exit bad = 1 }
         $1 != ray { rays++ }
         { ray = $1; t = $2; seen[$3]++; if ($4 < 1e-6) bounded++ }
         END { exit bad || !(seen[100] && seen[140] && rays > 900 && bounded > NR / 2) }' "$tmp/out"
}

# all_change: four pictures, no two alike, of a surface: not black.
all_change() {
    [ "$(ls "$tmp"/live_*.ppm | wc -l)" = 4 ] && [ "$(cat "$tmp"/live_*.ppm | wc -c)" = $((4 * (15 + 320 * 240 * 3))) ] &&
        [ "$(cksum "$tmp"/live_*.ppm | cut -d' ' -f1 | sort -u | wc -l)" = 4 ] &&
        [ "$(tail -c +16 "$tmp/live_004.ppm" | tr -d '\000' | wc -c)" -gt 3000 ]
}

# all_wave: three pictures, no two alike, with blue and yellow that are in the light.
all_wave() {
    [ "$(cksum "$tmp"/flag_*.ppm | cut -d' ' -f1 | sort -u | wc -l)" = 3 ] && python3 - "$tmp"/flag_*.ppm <<'PY'
import sys
for name in sys.argv[1:]:
    p = open(name, "rb").read()[15:]
    pixels = list(zip(p[0::3], p[1::3], p[2::3]))
    if sum(b > 150 and r < 60 for r, g, b in pixels) < 1000 or sum(r > 180 and b < 90 for r, g, b in pixels) < 1000:
        sys.exit(f"# {name}: too dark")
PY
}

# try NAME COMPILER...: the examples, built with this and run.
try() {
    how=$1
    shift
    exits "first_picture.c, $how" 0 "$@" -o "$tmp/picture" scripts/examples/first_picture.c $flags
    rm -f "$tmp/got.ppm" "$tmp/made.leaf"
    exits "converts and draws" 0 env LD_LIBRARY_PATH="$where" "$tmp/picture" "$tmp/made.leaf" "$tmp/got.ppm"
    ok "what the verb draws" like_render
    exits "does not write over it" 1 env LD_LIBRARY_PATH="$where" "$tmp/picture" "$tmp/made.leaf" "$tmp/got.ppm"
    ok "and says so" grep -q 'exists already' "$tmp/err"
    exits "rays.c, $how" 0 "$@" -o "$tmp/rays" scripts/examples/rays.c $flags
    exits "prints hits" 0 env LD_LIBRARY_PATH="$where" "$tmp/rays" "$tmp/m.leaf" 100 140
    ok "in order" as_expected
    exits "gray_scott.c, $how" 0 "$@" -O2 -o "$tmp/gray_scott" scripts/examples/gray_scott.c $flags -pthread
    rm -f "$tmp"/live_*.ppm
    exits "draws itself while it runs" 0 env LD_LIBRARY_PATH="$where" "$tmp/gray_scott" 40 200 "$tmp/live"
    ok "step after step" all_change
    exits "or not at all where it cannot write" 7 env LD_LIBRARY_PATH="$where" "$tmp/gray_scott" 8 100 "$tmp/none/live"
    exits "flag.c, $how" 0 "$@" -o "$tmp/flag" scripts/examples/flag.c $flags
    rm -f "$tmp"/flag_*.ppm
    exits "draws what moves" 0 env LD_LIBRARY_PATH="$where" "$tmp/flag" 3 "$tmp/flag"
    ok "picture after picture" all_wave
    exits "or says that it cannot write" 1 env LD_LIBRARY_PATH="$where" "$tmp/flag" 1 "$tmp/none/flag"
}
strict='-Wall -Wextra -Wno-missing-field-initializers -Werror'
flags="$(pc --cflags --libs) -lm"
where=$at/lib
# shellcheck disable=SC2086 # options
try "C, shared" ${CC:-cc} -std=c17 $strict
run env LD_LIBRARY_PATH="$where" ldd "$tmp/rays"
ok "needs the shared library by its soname" grep -q "libleafcast.so.0 => $at" "$tmp/out"
# shellcheck disable=SC2086 # options
exits "a program that asks for packets, kept isopolygons, an approximate intersector" 0 ${CC:-cc} -std=c17 $strict -o "$tmp/experiment" "$tmp/experiment.c" $flags
exits "is refused" 0 env LD_LIBRARY_PATH="$where" "$tmp/experiment" "$tmp/m.leaf"
ok "as there are none" [ "$(grep -c 'this library has no experiments' "$tmp/out")" = 3 ]
cxx=${CXX:-g++}
if command -v "${cxx%% *}" >/dev/null; then
    # shellcheck disable=SC2086 # options
    try "C++, shared" $cxx -std=c++17 -x c++ $strict
else
    skip "C++, shared" "no $cxx here"
fi
rm "$at"/lib/libleafcast.so*
flags="-x none $(pc --cflags --libs --static) -lm"
where=
try "C, static" ${CC:-cc} -std=c17
if command -v "${cxx%% *}" >/dev/null; then
    try "C++, static" $cxx -std=c++17 -x c++
else
    skip "C++, static" "no $cxx here"
fi
exits "rays.c refuses what is no file" 7 "$tmp/rays" "$tmp/none.leaf" 1
finish
