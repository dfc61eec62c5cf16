#!/usr/bin/env bash
# Installs what was built, or takes it away again: library, header, pkg-config and CMake files, program, man pages, completions.
#
#     scripts/install.sh install|uninstall BUILT
#
# BUILT holds the program, libpatchlight_capi.so and .a, and the folder `manual`. From the environment: PREFIX [/usr/local],
# LIBDIR [$PREFIX/lib], and DESTDIR, which is put before all paths and is in none of the files.
set -euo pipefail

if [ $# -ne 2 ] || { [ "$1" != install ] && [ "$1" != uninstall ]; }; then
    echo 'usage: scripts/install.sh install|uninstall BUILT' >&2
    exit 2
fi
action=$1
built=$2
source=$(cd "$(dirname "$0")/.." && pwd)
prefix=${PREFIX:-/usr/local}
libdir=${LIBDIR:-$prefix/lib}
root=${DESTDIR:-}
case $prefix$libdir in
    /*) ;;
    *) echo "install: PREFIX and LIBDIR must be absolute paths" >&2; exit 2 ;;
esac
version=$(sed -n 's/^version = "\(.*\)"$/\1/p' "$source/capi/Cargo.toml" | head -n 1)

man=$root$prefix/share/man/man1
bash=$root$prefix/share/bash-completion/completions
zsh=$root$prefix/share/zsh/site-functions
fish=$root$prefix/share/fish/vendor_completions.d

if [ "$action" = uninstall ]; then
    rm -f "$root$prefix/bin/patchlight" "$root$prefix/include/patchlight.h" "$root$libdir"/libpatchlight.{a,so,so.0,so."$version"} \
        "$root$libdir/pkgconfig/patchlight.pc" "$man"/patchlight{,-solve,-sample,-render,-relight,-export,-bake,-report,-batch,-batch-merge,-info}.1 \
        "$bash/patchlight" \
        "$zsh/_patchlight" "$fish/patchlight.fish"
    rm -f "$root$libdir"/cmake/patchlight/patchlight-config{,-version}.cmake
    rmdir "$root$libdir/cmake/patchlight" 2>/dev/null || true
    exit
fi

for file in patchlight libpatchlight_capi.so libpatchlight_capi.a manual; do
    if [ ! -e "$built/$file" ]; then
        echo "install: $built/$file is missing; build it first: make library" >&2
        exit 1
    fi
done

# What programs must link that link statically: what the shared library needs, but for the loader.
private=$(objdump -p "$built/libpatchlight_capi.so" | sed -n 's/^ *NEEDED *lib\(.*\)\.so.*$/-l\1/p' | tr '\n' ' ')
private="$private-lpthread -ldl"
if [ -n "${EMBREE_LIB_DIR:-}" ]; then
    private="-L$EMBREE_LIB_DIR $private"
fi

fill() {
    sed -e "s|@PREFIX@|$prefix|g" -e "s|@LIBDIR@|$libdir|g" -e "s|@VERSION@|$version|g" -e "s|@MAJOR@|${version%%.*}|g" \
        -e "s|@MINOR@|$(echo "$version" | cut -d . -f 2)|g" -e "s|@PRIVATE@|$private|g" -e "s|@PRIVATE_LIST@|${private// /;}|g" \
        -e "s|@INCLUDE_FROM_LIB@|$(realpath -m --relative-to="$libdir" "$prefix/include")|g" "$source/capi/install/$1.in" >"$2"
    chmod 644 "$2"
}

install -d "$root$prefix/bin" "$root$prefix/include" "$root$libdir/pkgconfig" "$root$libdir/cmake/patchlight" "$man" "$bash" "$zsh" "$fish"
install -m 755 "$built/patchlight" "$root$prefix/bin/patchlight"
install -m 755 "$built/libpatchlight_capi.so" "$root$libdir/libpatchlight.so.$version"
install -m 644 "$built/libpatchlight_capi.a" "$root$libdir/libpatchlight.a"
ln -sf "libpatchlight.so.$version" "$root$libdir/libpatchlight.so.0"
ln -sf libpatchlight.so.0 "$root$libdir/libpatchlight.so"
install -m 644 "$source/capi/include/patchlight.h" "$root$prefix/include/patchlight.h"
fill patchlight.pc "$root$libdir/pkgconfig/patchlight.pc"
fill patchlight-config.cmake "$root$libdir/cmake/patchlight/patchlight-config.cmake"
fill patchlight-config-version.cmake "$root$libdir/cmake/patchlight/patchlight-config-version.cmake"
install -m 644 "$built"/manual/*.1 "$man"
install -m 644 "$built/manual/patchlight.bash" "$bash/patchlight"
install -m 644 "$built/manual/_patchlight" "$zsh/_patchlight"
install -m 644 "$built/manual/patchlight.fish" "$fish/patchlight.fish"
