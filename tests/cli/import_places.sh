#!/bin/sh
# import_places.sh - netCDF as models of the sea and the air write it, as curvilinear grids (--to): where their nodes lie, against
# formulas in numpy; convert, info and pictures of it.
# marks: long
. tests/support/tap.sh
. tests/support/import_options.sh

says() { cat "$tmp/out" "$tmp/err" | grep -q -- "$1"; }

import_files netcdf netCDF4 libnetcdf places
exits "info --to" 0 "$leafcast" info "$tmp/roms1.nc" --to sphere
ok "says its zone" says '^zones *7 x 6 x 5 nodes$'
ok "and its steps" says '^steps *2, the first is taken here$'
ok "and its fields on the same nodes" says '^ *salt'
ok "and not those on others" [ "$(grep -c '^ *u$' "$tmp/out")" = 0 ]
ok "and what is next" says 'leafcast convert .*roms1.nc --to sphere'
exits "convert --to" 0 "$leafcast" convert "$tmp/roms1.nc" --to sphere -o "$tmp/one.leaf" --exaggerate 20 --name sea
ok "takes the first step" [ "$(grep -c '^steps' "$tmp/out")" = 0 ]
exits "its stream" 0 "$leafcast" import-netcdf "$tmp/roms1.nc" --to sphere --exaggerate 20 -o "$tmp/one.curv"
exits "which convert takes" 0 "$leafcast" convert "$tmp/one.curv" --name sea -o "$tmp/stream.leaf"
ok "the same file" cmp -s "$tmp/one.leaf" "$tmp/stream.leaf"
"$leafcast" import-netcdf "$tmp/roms1.nc" --to sphere --exaggerate 20 | "$leafcast" convert - --name sea -o "$tmp/pipe.leaf" -q
ok "through a pipe, too" cmp -s "$tmp/one.leaf" "$tmp/pipe.leaf"
gzip -c "$tmp/one.curv" >"$tmp/two.curv.gz"
exits "packed" 0 "$leafcast" convert "$tmp/two.curv.gz" --name sea -o "$tmp/packed.leaf"
ok "too" cmp -s "$tmp/one.leaf" "$tmp/packed.leaf"
exits "all steps and fields" 0 "$leafcast" convert "$tmp/roms2.nc" --to cartesian --steps all --fields all -o "$tmp/all.leaf"
ok "nodes move with the water" says '^nodes *move from step to step$'
exits "are sound" 0 "$leafcast" verify "$tmp/all.leaf"
exits "info of it" 0 "$leafcast" info "$tmp/all.leaf"
ok "has the times" says '^steps *2, times 0 \.\. 3600 seconds since 2000-01-01, vertices move$'
exits "a field on other nodes" 2 "$leafcast" convert "$tmp/roms2.nc" --to sphere --field temp --field u -o "$tmp/x.leaf"
ok "is told why" says 'field "u" cannot be taken: it lies on other nodes than temp, which is taken'
exits "a field that is nowhere" 2 "$leafcast" convert "$tmp/roms2.nc" --to sphere --field temp --field w -o "$tmp/x.leaf"
ok "is told what there is" says 'no field "w"; it has "temp", "salt"'
exits "info --json" 0 "$leafcast" info "$tmp/roms2.nc" --to sphere --json -q
ok "tells the steps of each field" [ "$(grep -c '"steps": 2' "$tmp/out")" = 3 ]
exits "nodes of fixed depths" 0 "$leafcast" convert "$tmp/nemo.nc" --to sphere --steps all -o "$tmp/nemo.leaf"
ok "stay" says '^nodes *stay where they are$'
ok "land is blanked" says ' blanked$'
exits "a picture" 0 "$leafcast" render "$tmp/all.leaf" --iso 0.5 --step 1 --size 40x30 -o "$tmp/all.ppm"
exits "--to of another format" 2 "$leafcast" convert "$tmp/one.curv" --to sphere -o "$tmp/x.leaf"
ok "is refused by name" says 'one.curv: --to: this is a curvilinear stream, expected netCDF'
exits "--to from a pipe" 2 sh -c '"$1" convert - --to sphere -o "$2/x.leaf" <"$2/one.curv"' sh "$leafcast" "$tmp"
cp "$tmp/roms1.nc" "$tmp/wrfout_d01_2000-01-24_12:00:00"
exits "whatever its file is called" 0 "$leafcast" convert "$tmp/wrfout_d01_2000-01-24_12:00:00" --to sphere -o "$tmp/named.leaf" --exaggerate 20 --name sea
ok "it is the same" cmp -s "$tmp/one.leaf" "$tmp/named.leaf"
exits "gaps of one step alone" 0 "$leafcast" convert "$tmp/gap1.nc" --to sphere --steps all -o "$tmp/gap.leaf"
exits "are no corruption" 0 "$leafcast" verify "$tmp/gap.leaf"
exits "or of the first" 0 "$leafcast" convert "$tmp/gap0.nc" --to sphere --steps all -o "$tmp/gap.leaf" --force
exits "--to with --solution" 2 "$leafcast" convert "$tmp/roms1.nc" --to sphere --solution q -o "$tmp/x.leaf"
ok "says whose each is" says 'roms1.nc: --to is for netCDF, and --solution'
exits "--to with --cells-to-points" 2 "$leafcast" convert "$tmp/roms1.nc" --to sphere --cells-to-points -o "$tmp/x.leaf"
ok "which would change nothing" says 'cells-to-points is for meshes, and .*roms1.nc is NetCDF'
exits "--exaggerate without --to" 2 "$leafcast" convert "$tmp/one.curv" --exaggerate 2 -o "$tmp/x.leaf"
exits "a file that is cut off" 3 sh -c 'head -c 3000 "$1/classic.nc" >"$1/cut.nc"; exec "$2" convert "$1/cut.nc" --to sphere -o "$1/x.leaf"' sh "$tmp" "$leafcast"
ok "nothing is left" [ ! -e "$tmp/x.leaf" ]
finish
