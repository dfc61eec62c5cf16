#!/bin/sh
# Runs the tests in a Debian 13 root, where Embree is version 4: with default features, and with the feature embree4-sys.
#
#   scripts/test-debian13.sh [arguments of cargo test]
#
# For whoever changes wrapper/ or build.rs. Needs root rights (asks sudo for them), debootstrap (installed if missing), and the
# first time about 0.7 GB in target/debian13 and a minute. The Rust toolchain and the crates of this machine are used, through bind
# mounts that live in a mount namespace of their own: they vanish with this script, however it ends.
set -eu

project=$(cd "$(dirname "$0")/.." && pwd)
work=$project/target/debian13
root=$work/root
mirror=${DEBIAN_MIRROR:-}
packages=ca-certificates,g++,libembree-dev,libclang1-19,libclang-common-19-dev

# Before root rights: the toolchain and the crates belong to the user.
if [ -z "${DEBIAN13_SYSROOT:-}" ]; then
    cd "$project"
    cargo fetch --locked
    DEBIAN13_SYSROOT=$(rustc --print sysroot)
    DEBIAN13_CARGO_HOME=${CARGO_HOME:-$HOME/.cargo}
    export DEBIAN13_SYSROOT DEBIAN13_CARGO_HOME
fi
if [ "$(id -u)" != 0 ]; then
    exec sudo --preserve-env=DEBIAN13_SYSROOT,DEBIAN13_CARGO_HOME,DEBIAN_MIRROR "$0" "$@"
fi

# A mount namespace of our own.
if [ -z "${DEBIAN13_NAMESPACE:-}" ]; then
    export DEBIAN13_NAMESPACE=1
    exec unshare --mount --propagation private "$0" "$@"
fi

# The Debian root, made once. A root that was left half made is made again.
if [ ! -e "$work/complete" ]; then
    command -v debootstrap >/dev/null || apt-get install -y debootstrap
    rm -rf "$root"
    mkdir -p "$root"
    debootstrap --variant=minbase --include="$packages" trixie "$root" ${mirror:+"$mirror"}
    touch "$work/complete"
fi

# Unmounts in reverse order; what is left goes with the namespace.
mounted=
clean_up() {
    for place in $mounted; do
        umount "$place" || true
    done
}
trap clean_up EXIT
trap 'exit 130' INT
trap 'exit 143' TERM

bind() { # what, where in the root, options
    mkdir -p "$root$2"
    mount --bind "$1" "$root$2"
    mounted="$root$2 $mounted"
    [ -z "${3:-}" ] || mount -o "remount,bind,$3" "$root$2"
}
bind "$DEBIAN13_SYSROOT" /opt/rust ro
bind "$DEBIAN13_CARGO_HOME/registry" /opt/cargo/registry
bind "$project" /project/patchlight ro
[ ! -d "$project/../shared" ] || bind "$project/../shared" /project/shared ro
bind /dev /dev
mkdir -p "$root/proc"
mount -t proc proc "$root/proc"
mounted="$root/proc $mounted"

# Both feature sets share the compiled dependencies, in /build of the root.
inside() {
    echo "debian 13: $*"
    chroot "$root" /usr/bin/env -i PATH=/opt/rust/bin:/usr/sbin:/usr/bin:/sbin:/bin HOME=/root CARGO_HOME=/opt/cargo \
        CARGO_TARGET_DIR=/build CARGO_TERM_COLOR=never sh -c 'cd /project/patchlight && exec "$@"' sh "$@"
}
inside cargo test --offline --locked "$@"
inside cargo test --offline --locked --features embree4-sys "$@"
