#!/bin/sh
# output_names.sh - the format of an output is the one that its name says, or the name is refused: every verb, every ending.
# marks: plain, long
. tests/support/tap.sh

cd "$tmp" || exit 1
home=$OLDPWD
"$leafcast" generate sphere --dims 9 --type u8 -o g.nrrd
"$leafcast" convert g.nrrd -o g.leaf -q
cp g.leaf h.leaf
"$leafcast" generate sphere --tets --dims 4 -o m.mesh
"$leafcast" convert m.mesh -o m.leaf -q
printf '4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n' >p.node

# Each verb with -o: its words, and the endings that are what it writes; of export, what --format would write is one kind.
cat >verbs <<'TABLE'
convert g.nrrd|.leaf
verify g.leaf --repair h.leaf|.leaf
resample m.mesh --dims 5|.nrrd
tetrahedralize p.node|.mesh
generate sphere --dims 5|.nrrd
generate sphere --tets --dims 3|.mesh
export g.leaf|.nrrd .nrrd.gz .raw .raw.gz .nii .nii.gz .mha .npy .vti .vti.gz .vtr .tif .tiff .vdb .zarr
export g.leaf --format nrrd|.nrrd .nrrd.gz
export g.leaf --format raw|.raw .raw.gz
export g.leaf --format nifti1|.nii .nii.gz
export g.leaf --format nifti2|.nii .nii.gz
export g.leaf --format metaimage|.mha
export g.leaf --format npy|.npy
export g.leaf --format vti|.vti .vti.gz
export g.leaf --format tiff|.tif .tiff
export g.leaf --format zarr|.zarr
export g.leaf --iso 99|.ply .stl .vtp
export m.leaf|.vtu
export m.leaf --format vtu|.vtu
render g.leaf --iso 99 --size 8x8|.png .ppm .pfm
slice g.leaf --axis z|.png .ppm .pfm
render g.leaf --iso 99 --size 8x8 --format ppm|.ppm
probe g.leaf --ray 0,4,4,1,0,0 --csv|.csv
probe g.leaf --ray 0,4,4,1,0,0 --svg|.svg
TABLE
for verb in vdb:nrrd images:nrrd dicom:nrrd hdf5:nrrd netcdf:nrrd exodus:mesh cgns:mesh; do
    "$leafcast" --list-verbs own | grep -qx "import-${verb%:*}" && echo "import-${verb%:*} absent.input|.${verb#*:}" >>verbs
done

# All endings that this program knows, reads or writes, and those known by sight.
grep -o '"[^"]*"' "$home/formats/base/output_name.c" | tr -d '"' | tr ' ' '\n' | grep '^\.[a-z0-9]*$' | sort -u >endings
ok "the list of endings was found" [ "$(wc -l <endings)" -gt 90 ]
sed -n '/^static const row rows/,/^};/p' "$home/formats/input/foreign.c" | grep -oE '"(\.[a-z0-9]+ )+"' | tr -d '"' |
    tr ' ' '\n' | grep . | sort -u >sight
ok "so were those known by sight" [ "$(wc -l <sight)" -gt 60 ]
comm -13 endings sight >missing
cp missing err
ok "each ending known by sight is known of outputs" [ ! -s missing ]
sed -n 's/.*\.suffix = "\(\.[a-z]*\)".*/\1/p; s/^ *{"[a-z]*", "\(\.[a-z]*\)".*/\1/p; s/^ *TIFF("\(.*\)").*/\1/p; s/^ *NIFTI("[a-z]*", "\(\.[a-z]*\)".*/\1/p' \
    "$home/prep/export/sample_format.c" "$home/prep/export/piece_format.c" | sort -u >written
ok "each ending that export writes is known" [ -z "$(comm -13 endings written)" ] && [ "$(wc -l <written)" -ge 12 ]

# A verb's help that shows -o has a row.
for verb in $("$leafcast" --list-verbs own); do
    "$leafcast" "$verb" --usage 2>/dev/null | grep -q -- '-o ' || continue
    case $verb in bench) continue ;; esac # it draws for minutes; below
    ok "$verb is in the table" grep -q "^$verb " verbs
done

# All of them against the rule, which is one for all verbs; with each verb those that another writes.
echo ".nrrd .leaf .mesh .vti .vtu .png .csv _%02d.vti" |
    tr ' ' '\n' >some

# What each name does: "right" where it is one of the verb's own, else refused, and nothing is left behind.
judge() { # judge WORDS FITTING ENDING...: what is wrong goes to ./wrong
    : >wrong
    words=$1
    fitting=" $2 "
    shift 2
    for ending; do
        rm -rf made && mkdir made
        # shellcheck disable=SC2086 # words are to be split
        case $words in
        *--csv | *--svg) "$leafcast" $words "made/x$ending" >said 2>&1 ;;
        *) "$leafcast" $words -o "made/x$ending" >said 2>&1 ;;
        esac
        rc=$?
        case $fitting in
        *" $ending "*)
            # An importer without an input has come past its name.
            case $words in import-*) [ $rc != 2 ] || echo "$ending: $(cat said)" >>wrong ;; *)
                [ $rc = 0 ] && [ -s "made/x$ending" ] || echo "$ending: exit $rc: $(cat said)" >>wrong ;;
            esac
            ;;
        *)
            # What the file has not, export refuses as unsupported.
            case $rc:$words in 2:* | 3:export*) ;; *) false ;; esac || echo "$ending: exit $rc, expected 2: $(cat said)" >>wrong
            [ -z "$(ls made)" ] || echo "$ending: left $(ls made)" >>wrong
            grep -q '\.[a-z]\|--iso' said || echo "$ending: does not say what would do: $(cat said)" >>wrong
            ;;
        esac
    done
    cp wrong err
    [ ! -s wrong ]
}
while IFS='|' read -r words fitting; do
    # shellcheck disable=SC2046,SC2086 # words are to be split
    ok "$words -o: $fitting, and no other" judge "$words" "$fitting" $(printf '%s\n' $fitting | cat - some | sort -u)
done <verbs
# shellcheck disable=SC2046 # words are to be split
ok "all endings" judge "generate sphere --dims 5" .nrrd $(cat endings)
exits "bench -o x.vti" 2 "$leafcast" bench -o x.vti
exits "bench -o x.leaf" 2 "$leafcast" bench media -o x.leaf

# Names that say nothing are anyone's.
exits "a name without an ending" 0 "$leafcast" generate sphere --dims 5 -o plain
ok "is NRRD" grep -q '^NRRD' plain
exits "an ending that says nothing" 0 "$leafcast" convert g.nrrd -o x.leaf2 -q
# Files of a sequence have their numbers.
exits "slices" 0 "$leafcast" export g.leaf -o 's_%02d.tif'
ok "are a file each" [ "$(ls s_0?.tif | wc -l)" = 9 ]
exits "volumes in time" 0 "$leafcast" generate drop --dims 3 --steps 2 -o 'v_%02d.nrrd'
exits "which are no meshes" 2 "$leafcast" generate drop --dims 3 --steps 2 -o 'v_%02d.mesh'
exits "meshes that move" 0 "$leafcast" generate sphere --tets --dims 3 --deform 0.1 --steps 2 -o 't_%02d.mesh'
ok "are a file each" [ -s t_00.mesh -a -s t_01.mesh ]
exits "pictures" 0 "$leafcast" render g.leaf --iso-list 90,99 --size 8x8 -o 'p_%02d.png' -q
ok "are a file each" [ -s p_00.png -a -s p_01.png ]
exits "a file with a number in its name" 2 "$leafcast" export g.leaf -o 'vf_%02d.vti'
ok "is told why" grep -q 'a name with %d in it is that of several files' err
# The way that is named works.
exits "a mesh for VTK" 2 "$leafcast" tetrahedralize p.node -o t.vtu
ok "is told the way" grep -q 'leafcast convert.*leafcast export' err
finish
