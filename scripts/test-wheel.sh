#!/bin/sh
# Installs the wheel in Debian 12 and 13 roots that have Python and nothing else, and lights the room there.
#
#   scripts/test-wheel.sh
#
# Needs root rights (asks sudo for them), debootstrap (installed if missing), and the first time about 0.6 GB in target/python/roots and
# a minute. DEBIAN_MIRROR names a mirror. Nothing is mounted, and the roots need no network: numpy is fetched outside.
set -eu

project=$(cd "$(dirname "$0")/.." && pwd)
work=$project/target/python
mirror=${DEBIAN_MIRROR:-}

# Before root rights: the wheel, and numpy for the Python of each system.
if [ -z "${WHEEL_BUILT:-}" ]; then
    "$project/scripts/wheel.sh" build
    numpy=$(sed -n 's/^numpy==//p' "$project/python/requirements-test.txt")
    for version in 3.11 3.13; do
        "$work/tools/bin/pip" download --quiet --disable-pip-version-check --no-deps --only-binary :all: --python-version "$version" \
            --dest "$work/numpy" "numpy==$numpy"
    done
    export WHEEL_BUILT=1
fi
if [ "$(id -u)" != 0 ]; then
    exec sudo --preserve-env=WHEEL_BUILT,DEBIAN_MIRROR "$0" "$@"
fi

for suite in bookworm trixie; do
    # The Debian root, made once. A root that was left half made is made again.
    root=$work/roots/$suite
    if [ ! -e "$root.complete" ]; then
        command -v debootstrap >/dev/null || apt-get install -y debootstrap
        rm -rf "$root"
        mkdir -p "$root"
        debootstrap --variant=minbase --include=python3,python3-venv "$suite" "$root" ${mirror:+"$mirror"}
        touch "$root.complete"
    fi

    # A new environment in it, and the example there.
    rm -rf "$root/try"
    mkdir "$root/try"
    cp "$work"/wheels/*.whl "$work"/numpy/*.whl "$project"/scenes/room.* "$project/examples/python/room.py" "$root/try"
    echo "$suite: Debian $(cat "$root/etc/debian_version")"
    chroot "$root" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root sh -euc '
        cd /try
        if ls /usr/lib/*/libembree* 2>/dev/null; then
            echo "there is an Embree in this root" >&2
            exit 1
        fi
        python3 -m venv environment
        environment/bin/pip install --quiet --no-index --find-links . patchlight
        environment/bin/python room.py room.obj room.png
        ls -l room.png'
done
