#!/usr/bin/env bash
# Fuzzes with cargo-fuzz, one target after the other: files, values, options, small solves and calls of the C interface.
#
#     scripts/fuzz.sh SECONDS [TARGET...]
#
# SECONDS for each TARGET of fuzz/fuzz_targets, or all of them. Inputs that fail lie in fuzz/artifacts afterwards, logs in fuzz/logs; the exit
# status is 1 if there are any. Needs cargo-fuzz (cargo install cargo-fuzz --locked); its compiler flags are taken by a stable Rust too. Seeds
# are made of the scenes of the repository, solved with and without bounds, by the program in target/release.
set -euo pipefail

if [ $# -lt 1 ]; then
    echo 'usage: scripts/fuzz.sh SECONDS [TARGET...]' >&2
    exit 2
fi
seconds=$1
shift
cd "$(dirname "$0")/.."
targets=("$@")
if [ ${#targets[@]} -eq 0 ]; then
    targets=(solution bake obj glb meshes lights points options solve calls triangulation)
fi
patchlight=target/release/patchlight
export RUSTC_BOOTSTRAP=1
cargo build --release --locked --bin patchlight
(cd fuzz && cargo fuzz build)

# Seeds: scenes with their materials behind a 0, JSON with its numbers, bodies of solutions, tables of points, and each option set to 1.
seed() { mkdir -p "fuzz/corpus/$1" && cat >"fuzz/corpus/$1/$2"; }
for scene in four_polygons furnace cornell two_rooms full_office; do
    { sed "s/^mtllib .*/mtllib a.mtl/" "scenes/$scene.obj"; printf '\0'; cat "scenes/$scene.mtl"; } | seed obj "$scene"
done
printf '{"asset":{"version":"2.0"},"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"buffers":[{"byteLength":36}],"bufferViews":[{"buffer":0,"byteLength":36}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}]}\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\200?\0\0\0\0\0\0\0\0\0\0\0\0\0\0\200?\0\0\0\0' |
    seed glb triangle
printf 'ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n' |
    seed meshes ply
printf 'solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n' | seed meshes stl
{ sed 's/"[^"]*[.]ies"/"a.ies"/' scenes/daylight.toml; printf '\0'; cat scenes/downlight.ies; } | seed lights daylight
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
for scene in four_polygons furnace cornell; do
    for solver in links cells; do
        for bounds in estimate guaranteed; do
            "$patchlight" solve "scenes/$scene.obj" --error 0.5 --bounds "$bounds" --set "solver=$solver" --set point_rays=16 \
                --set bounds_work=64 --set max_links=500 --progress none -o "$work/seed.solution" || true
            tail -c +25 "$work/seed.solution" | seed solution "$scene-$solver-$bounds"
        done
    done
done
printf 'x,y,z,nx,ny,nz\n0.5,0.5,0,0,0,1\n1e-3,-2,3.25,0.5774,0.5774,0.5774\n' | seed points plain
printf '\xef\xbb\xbfid,"NZ",ny,NX,z,Y,x,note,B_r\r\n7,1,0,0,3,2,1,a wall,0.5\r\n\r\n' | seed points others
"$patchlight" solve --help | sed -n 's/^    \([a-z_0-9]*\)$/\1=1/p' | seed options keys
printf 'error=0.05\nnorm=energy\nimportance=view eye=0,1,5 target=0,1,0 up=0,1,0 fov=40\nskips=rays+clear\nstrategy=lazy94+reduction\n' |
    seed options some
head -c 200 /dev/zero | seed solve zeros
head -c 400 /dev/urandom | seed solve any
head -c 600 /dev/urandom | seed calls any
head -c 400 /dev/urandom | seed triangulation any
head -c 40 /dev/urandom | seed bake any

# Each target on its own: one that fails does not keep the others from running.
failed=0
mkdir -p fuzz/logs
for target in "${targets[@]}"; do
    mkdir -p "fuzz/corpus/$target"
    limits=(-max_total_time="$seconds" -rss_limit_mb=3000 -malloc_limit_mb=2000 -timeout=60 -max_len=65536 -print_final_stats=1)
    (cd fuzz && cargo fuzz run "$target" -- "${limits[@]}") >"fuzz/logs/$target.log" 2>&1 || failed=1
    echo "$target: $(grep -E 'stat::number_of_executed_units|ERROR|panicked' "fuzz/logs/$target.log" | tr '\n' ' ')"
done
exit "$failed"
