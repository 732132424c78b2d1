#!/bin/sh
# optional.sh - leafcast is built and tested without what is optional: Embree, TetGen, OpenImageIO, a C++
# compiler, clang. Each is hidden from the probes, not only switched off.
# marks: long
. tests/support/tap.sh

case ${LEAFCAST_BUILD:-$PWD/build/release} in
*/build/release) ;;
*)
    skip "building without what is optional" "the release build shows it"
    finish
    ;;
esac

# A checkout whose build is up to date, apart from what the probes decide.
tree=$tmp/tree
b=$tree/build/release
mkdir -p "$b/tests"
for f in formats prep stream render tests README.md; do ln -s "$PWD/$f" "$tree/$f"; done
cp -a Makefile scripts "$tree"
for f in bin lib libexec native obj flags flags-c++ objects; do cp -a "build/release/$f" "$b"; done
cp -a build/release/tests/tool_* "$b/tests"

# The commands of this machine, less those that are to be missing.
path=$tmp/path
mkdir "$path"
for f in /usr/local/bin/* /usr/bin/* /bin/* /usr/sbin/* /sbin/*; do
    [ -e "$path/${f##*/}" ] || ln -s "$f" "$path/${f##*/}"
done
hide() { for f; do rm -f "$path"/$f; done; }
hide 'clang*' apt-get sudo

make_there() { PATH=$path make -C "$tree" T= "$@"; }
says() { grep -q -- "$1" "$tmp/out" || grep -q -- "$1" "$tmp/err"; }
absent() { for f; do [ ! -e "$b/libexec/leafcast-$f" ] || return 1; done; }

# Headers and modules that are not there.
sed -i -e 's,include/\(embree3\|tetgen\),nowhere/\1,; s|pc:OpenImageIO|pc:NoImageIO|' "$tree/scripts/setup-debian"
exits "make without Embree, TetGen, OpenImageIO, clang" 0 make_there all
ok "says that pictures want OpenImageIO" says 'no OpenImageIO here'
ok "says that tetrahedralize wants TetGen" says 'no TetGen here'
ok "leaves them out" absent write-image tetgen tetrahedralize
exits "the peers are built" 0 "$b/libexec/leafcast-bench-peers" --help
exits "a volume is made" 0 "$b/bin/leafcast" generate sphere --dims 17 -o "$tmp/s.nrrd" -q
exits "converted" 0 "$b/bin/leafcast" convert "$tmp/s.nrrd" -o "$tmp/s.leaf" -q
exits "and drawn" 0 "$b/bin/leafcast" render "$tmp/s.leaf" --iso 0.5 --depth-f64 "$tmp/s.f64" --size 8x8
# What is linked with it: objects tell whether the probe was believed.
ok "no Embree is linked" sh -c '! ldd "$1" | grep -q embree' - "$b/libexec/leafcast-bench-peers"
exits "tests of what is left out are skipped" 0 make_there run-tests T="tetrahedralize write_image front_door"

ok "and counted" says ' 0 failed, [1-9][0-9]* skipped'

# What is missing and optional is no error where it cannot be installed.
exits "setup-debian goes on without" 0 env PATH="$path" "$tree/scripts/setup-debian"
ok "and says what, and that it does" says 'going on without'
ok "TetGen, say" says 'libtet1.5-dev .*tetrahedralize'
exits "--list tells, too" 1 env PATH="$path" "$tree/scripts/setup-debian" --list

# An apt-get that has only what is needed.
cat >"$path/apt-get" <<SH
#!/bin/sh
echo "\$*" >>"$tmp/apt"
case \$* in *libtet*) exit 100 ;; esac
SH
printf '#!/bin/sh\nexec "$@"\n' >"$path/sudo"
chmod 755 "$path/apt-get" "$path/sudo"
sed -i -e 's|cmd:zstd|cmd:no-zstd|' "$tree/scripts/setup-debian"
exits "setup-debian installs what is needed" 0 env PATH="$path" "$tree/scripts/setup-debian"
ok "at first together with what is optional" grep -q 'install zstd .*libtet1.5-dev' "$tmp/apt"
ok "then alone" grep -q 'install zstd$' "$tmp/apt"
rm "$path/apt-get"
exits "needed and not to be had: an error" 1 env PATH="$path" "$tree/scripts/setup-debian"

# No C++ compiler: nothing of C is built again.
cp -a scripts/setup-debian "$tree/scripts"
hide '*g++*' '*c++*'
find "$b/obj" -name '*.o' -newer "$tmp/apt" >"$tmp/newer"
exits "make without a C++ compiler" 0 make_there all
ok "leaves out what is in C++" absent write-image tetgen tetrahedralize
find "$b/obj" -name '*.o' -newer "$tmp/apt" >"$tmp/out"
ok "and compiles no C for it" cmp -s "$tmp/newer" "$tmp/out"
finish
