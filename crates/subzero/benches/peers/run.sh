#!/usr/bin/env bash
# Builds the peers' programs (Debian: libosd-dev, libcgal-dev, libopenmesh-dev) and runs them on the mesh of our benches.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
declare -A libraries=([opensubdiv]=-losdCPU [cgal]= [openmesh]="-lOpenMeshCore -lOpenMeshTools")
for order in curve random; do
    cargo run --quiet --manifest-path "$here/../../Cargo.toml" --example sphere_off -- $order > "$work/$order.off"
done
for peer in opensubdiv cgal openmesh; do
    # OpenMesh's headers want the constants of math.h.
    g++ -O3 -march=native -DNDEBUG -std=c++17 -D_USE_MATH_DEFINES "$here/$peer.cpp" -o "$work/$peer" ${libraries[$peer]} -lpthread
    for order in curve random; do
        echo "vertices in $order order"
        "$work/$peer" "$work/$order.off"
    done
done
