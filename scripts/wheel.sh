#!/usr/bin/env bash
# The Python package: builds its wheel, and tests it where it is installed.
#
#     scripts/wheel.sh build     leaves it in target/python/wheels
#     scripts/wheel.sh test      builds it, installs it in an environment of its own, runs python/tests there
#
# The wheel carries Embree and what that needs; auditwheel puts them in and says on which systems it runs. PYTHON names the Python to take
# [python3]; the tests take 3.11 or newer. Where Python or its packages cannot be had, `test` says so and does nothing.
set -euo pipefail

action=${1:-}
case $action in
    build | test) ;;
    *) echo 'usage: scripts/wheel.sh build|test' >&2; exit 2 ;;
esac
project=$(cd "$(dirname "$0")/.." && pwd)
work=$project/target/python
python=${PYTHON:-python3}
cd "$project"

# What is missing ends a build, and leaves tests out.
cannot() {
    if [ "$action" = test ]; then
        printf 'SKIPPED: no tests of the Python package: %s\n' "$*" >&2
        exit 0
    fi
    printf 'wheel: %s\n' "$*" >&2
    exit 1
}

# An environment with packages, made anew when the list changes.
environment() { # name, list
    local place=$work/$1 sum
    sum=$(cat "$2" <("$python" --version) | cksum)
    if [ "$(cat "$place/complete" 2>/dev/null)" != "$sum" ]; then
        rm -rf "$place"
        "$python" -m venv "$place" || cannot "$python has no venv (on Debian: apt-get install python3-venv)"
        "$place/bin/pip" install --quiet --disable-pip-version-check --requirement "$2" || cannot "the packages of $2 cannot be had"
        echo "$sum" >"$place/complete"
    fi
}

"$python" -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null || cannot "$python is missing, or older than 3.11"
mkdir -p "$work"
environment tools python/requirements.txt

# The library.
rm -rf "$work/built" "$work/wheels"
env PATH="$work/tools/bin:$PATH" VIRTUAL_ENV="$work/tools" \
    maturin build --quiet --release --locked --manifest-path python/Cargo.toml --out "$work/built"
built=$(echo "$work"/built/*.whl)

# The licences of what it will carry, where the system's packages tell them.
"$work/tools/bin/python" - "$built" <<'PROGRAM'
import re, subprocess, sys, tempfile, zipfile
from pathlib import Path

wheel = Path(sys.argv[1])
metadata = "-".join(wheel.name.split("-")[:2]) + ".dist-info"
with zipfile.ZipFile(wheel, "a") as archive, tempfile.TemporaryDirectory() as folder:
    library = archive.extract("patchlight/_native.abi3.so", folder)
    needed = subprocess.run(["ldd", library], capture_output=True, text=True, check=True).stdout
    for path in re.findall(r"=> (\S*/lib(?:embree|tbb)\S*)", needed):
        owner = subprocess.run(["dpkg", "-S", str(Path(path).resolve())], capture_output=True, text=True)
        package = owner.stdout.partition(":")[0]
        text = Path("/usr/share/doc", package, "copyright")
        if owner.returncode == 0 and text.exists():
            archive.write(text, f"{metadata}/licenses/{package}.txt")
        else:
            print(f"wheel: no licence is known for {path}", file=sys.stderr)
PROGRAM

# What it needs is put in.
env PATH="$work/tools/bin:$PATH" LD_LIBRARY_PATH="${EMBREE_LIB_DIR:-}${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}" \
    auditwheel repair --wheel-dir "$work/wheels" "$built" 2>"$work/auditwheel.log" || { cat "$work/auditwheel.log" >&2; exit 1; }
wheel=$(echo "$work"/wheels/*.whl)
"$work/tools/bin/auditwheel" show "$wheel" 2>/dev/null | sed -n "/is consistent/,/platform tag/p" | tr "\n" " "
printf '\n%s\n' "$wheel"
[ "$action" = test ] || exit 0

# The tests see it as it is installed, not as it lies in python/.
environment test python/requirements-test.txt
"$work/test/bin/pip" install --quiet --disable-pip-version-check --no-deps --force-reinstall "$wheel"
"$work/test/bin/python" -m pytest -q -p no:cacheprovider python
