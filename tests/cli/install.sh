#!/bin/sh
# install.sh - make install: the layout, the front door where it is put, a program built on the library.
. tests/support/tap.sh

case ${LEAFCAST_BUILD:-$PWD/build/release} in
*/build/release) ;;
*)
    skip "make install" "only the release build is installed"
    finish
    ;;
esac

root=$tmp/root
exits "make install" 0 make -s install DESTDIR="$root" PREFIX=/opt/leafcast
at=$root/opt/leafcast
there() { for f; do [ -e "$at/$f" ] || { echo "no $f" >>"$tmp/err"; return 1; }; done; }
ok "installs the front door, library, headers, pkg-config file" there bin/leafcast lib/libleafcast.a lib/libleafcast.so \
    include/leafcast/leafcast.h include/leafcast/leafcast_look.h include/leafcast/leafcast_experimental.h include/leafcast/leafcast_grid.h lib/pkgconfig/leafcast.pc
# shellcheck disable=SC2046 # names
ok "and every verb with its page" there $(for v in generate convert render info verify probe slice bench; do
    echo "libexec/leafcast/leafcast-$v share/man/man1/leafcast-$v.1"
done)
ok "and the page of scenes" there share/man/man5/leafcast-scene.5
run "$at/bin/leafcast" --help
ok "the front door lists the installed verbs" grep -q '^  convert ' "$tmp/out"
ln -s "$at/bin/leafcast" "$tmp/leafcast"
exits "and runs them through a link" 0 "$tmp/leafcast" generate sphere --dims 9 -o "$tmp/s.nrrd" -q
exits "convert" 0 "$tmp/leafcast" convert "$tmp/s.nrrd" -o "$tmp/s.leaf" -q

cat >"$tmp/count.c" <<'C'
#include <leafcast.h>
#include <stdio.h>

int main(int argc, char **argv) {
    leafcast *volume;
    if (argc != 2 || leafcast_open(argv[1], NULL, &volume) != LEAFCAST_OK)
        return 1;
    printf("%u\n", leafcast_describe(volume).dims[0]);
    leafcast_close(volume);
    return 0;
}
C
pc() {
    PKG_CONFIG_PATH=$at/lib/pkgconfig pkg-config --define-variable=prefix="$at" "$@" leafcast
}
ok "pkg-config knows the version" [ "leafcast $(pc --modversion)" = "$("$leafcast" --version | head -n 1)" ]
# shellcheck disable=SC2046 # options
exits "a program is built on the library" 0 \
    ${CC:-cc} $(pc --cflags) "$tmp/count.c" -o "$tmp/count" $(pc --libs)
exits "and opens a file" 0 env LD_LIBRARY_PATH="$at/lib" "$tmp/count" "$tmp/s.leaf"
ok "in it 9 samples an axis" [ "$(cat "$tmp/out")" = 9 ]
finish
