#!/usr/bin/env bash
# Makes a Debian or Ubuntu machine ready to build: installs what is missing, with sudo where not root, and checks for Rust.
# Elsewhere it says what is needed. PATCHLIGHT_NO_INSTALL=1 installs nothing.
#
#     scripts/setup.sh [mpi]    mpi: for the feature of that name as well
#
set -euo pipefail

packages=(build-essential pkg-config libembree-dev libclang-dev cmake valgrind python3-venv)
if [ "${1:-}" = mpi ]; then
    packages+=(libopenmpi-dev openmpi-bin)
fi

# Embree and libclang are for the default feature `embree`; without them the build falls back to the pure-Rust backend. cmake and valgrind are
# for the tests of the C library, python3-venv is for the Python package.
if command -v dpkg-query >/dev/null && command -v apt-get >/dev/null; then
    missing=()
    for package in "${packages[@]}"; do
        if ! dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'install ok installed'; then
            missing+=("$package")
        fi
    done
    if [ "${#missing[@]}" -gt 0 ] && [ "${PATCHLIGHT_NO_INSTALL:-0}" = 0 ]; then
        as_root=()
        if [ "$(id -u)" -ne 0 ]; then
            if ! command -v sudo >/dev/null; then
                echo "setup: ${missing[*]} missing, and neither root nor sudo is at hand; install them: apt-get install ${missing[*]}" >&2
                exit 1
            fi
            as_root=(sudo)
        fi
        echo "setup: installing ${missing[*]}"
        "${as_root[@]}" apt-get update -qq
        "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}"
    fi
else
    echo "setup: no apt-get here; needed are a C/C++ compiler, pkg-config, Embree 3 or 4 with headers, and libclang" >&2
fi

# Rust is left to its own installer: distributions carry versions that are too old.
if ! command -v cargo >/dev/null && [ -f "$HOME/.cargo/env" ]; then
    . "$HOME/.cargo/env"
fi
if ! command -v cargo >/dev/null; then
    cat >&2 <<'MESSAGE'
setup: Rust is missing (cargo is not in PATH). Install 1.88 or newer from https://rustup.rs:
    curl --proto '=https' --tlsv1.2 -sSf https://sh.rustup.rs | sh
then open a new shell and try again.
MESSAGE
    exit 1
fi
version=$(cargo --version | cut -d ' ' -f 2)
needed=1.88.0
if [ "$(printf '%s\n' "$needed" "${version%%-*}" | sort -V | head -n 1)" != "$needed" ]; then
    echo "setup: Rust $version is too old, $needed or newer is needed: rustup update stable" >&2
    exit 1
fi
