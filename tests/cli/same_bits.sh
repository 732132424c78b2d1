#!/bin/sh
# same_bits.sh - volumes, treelet files, pixels and distances have the sums below: on any CPU, by any compiler.
# marks: bits
. tests/support/tap.sh

# make NAME ARGUMENT... - $tmp/NAME from a run of leafcast
make() {
    file=$1
    shift
    exits "$file" 0 "$leafcast" "$@" -o "$tmp/$file" -q
}
# draw NAME LEAF OPTION... - pixels of 8 bits and distances of 64, by the kernels of this CPU and by plain C.
draw() {
    picture=$1 volume=$2
    shift 2
    for isa in auto scalar; do
        exits "$picture, $isa" 0 "$leafcast" render "$tmp/$volume.leaf" --size 96x64 --isa $isa "$@" -q \
            -o "$tmp/$picture.ppm.$isa" --format ppm --depth-f64 "$tmp/$picture.f64.$isa"
    done
    for kind in ppm f64; do
        ok "the same $kind" cmp "$tmp/$picture.$kind.auto" "$tmp/$picture.$kind.scalar"
        mv "$tmp/$picture.$kind.scalar" "$tmp/$picture.$kind"
    done
}
probe() {
    run "$leafcast" probe "$tmp/$1.leaf" --iso "$2" --at 512,512
    grep -v '^rerun' "$tmp/out" >"$tmp/$1.probe"
}
lit="--light 1,2,3 --point-light 40,-9,30,0.5,0.4,0.2 --shadows --shading phong --background 0.1,0.2,0.3"

for field in marschner-lobb noise attractor; do
    make $field generate $field --dims 24,20,17 --type f32
done
for field in drop jets vortex; do
    make $field.nrrd generate $field --dims 24,20,17 --type f32 --steps 3
done
make grid.nrrd generate orbital --dims 40,33,27 --type u16 --spacing 1,0.7,1.3
make floats.nrrd generate gyroid --dims 48 --type f32
make mesh.mesh generate buckyball --tets --dims 20 --deform 0.5
make grid.leaf convert "$tmp/grid.nrrd"
make floats.leaf convert "$tmp/floats.nrrd" --compress zstd:3
make mesh.leaf convert "$tmp/mesh.mesh" --gradients --coarse
# The header says which version made the file.
for volume in grid mesh; do tail -c +4097 "$tmp/$volume.leaf" >"$tmp/$volume.treelets"; done

# shellcheck disable=SC2086 # options
{
    draw grid grid --iso 4000,20000
    draw grid_lit grid --iso 2621 --opacity 0.5 --iso 26214 $lit --normals analytic
    draw grid_coarse grid --iso 2621 --lod 1 --samples 4
    draw floats floats --iso 0 --clip-plane 1,1,0.5,-50 $lit
    draw glass floats --iso 0.1 --opacity 0.3 --refract 1.5,4 --reflect 0.2 $lit
    draw mesh mesh --iso 0.2,0.6 --opacity 0.4 --opacity 1 $lit --normals smooth
    draw mesh_clip mesh --iso 0.3 --clip-box 2,2,2,15,15,9 --view close
}
probe grid 4000
probe mesh 0.3

# Where a change of the bits is meant, the failures have the new lines.
while read -r crc bytes name; do
    got=$(cksum <"$tmp/$name")
    ok "$crc $bytes $name: now $got" [ "$got" = "$crc $bytes" ]
done <<SUMS
3580253833 32827 marschner-lobb
869833280 32818 noise
2247848051 32822 attractor
2255994018 32817 drop_0002.nrrd
2421554511 32817 jets_0001.nrrd
4095216225 32819 vortex_0001.nrrd
2638155990 71465 grid.nrrd
1452613165 442547 floats.nrrd
3485557368 786539 mesh.mesh
2639429104 122880 grid.treelets
3192962432 856064 mesh.treelets
2710710291 18445 grid.ppm
3017722958 49152 grid.f64
2088659122 18445 grid_lit.ppm
3974933515 49152 grid_lit.f64
1147073320 18445 grid_coarse.ppm
2534734241 49152 grid_coarse.f64
2297813628 18445 floats.ppm
1048684711 49152 floats.f64
1259244237 18445 glass.ppm
792442467 18445 mesh.ppm
485155644 49152 mesh.f64
349372635 18445 mesh_clip.ppm
1078771577 49152 mesh_clip.f64
2688949483 1979 grid.probe
3509312383 2756 mesh.probe
SUMS
finish
