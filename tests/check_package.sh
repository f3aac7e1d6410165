#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
#
# check_package.sh BUILD_DIR SOURCE_DIR: does another project get along with cellproj? Installs the build into a temporary
# prefix and builds and runs tests/package against it, then reads files by the source tree as a sub-directory.
# Exits 77 ("skipped") for a sanitized build, whose libraries need the sanitizers in every program.
set -euo pipefail
build=$(realpath "$1")
source=$(realpath "$2")

fail() {
    echo "check_package: $*" >&2
    exit 1
}

if grep -q '^CELLPROJ_SANITIZE:BOOL=ON$' "$build/CMakeCache.txt"; then
    echo "check_package: skipped, $build is built with sanitizers"
    exit 77
fi

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
prefix=$scratch/prefix

# Runs a command and shows what it said only when it fails.
quietly() { "$@" >"$scratch/log" 2>&1 || { cat "$scratch/log" >&2; fail "failed: $*"; }; }

# configure NAME [-DOPTION…]: configures the consumer in a folder of that name.
configure() {
    local folder=$scratch/$1
    shift
    quietly cmake -S "$source/tests/package" -B "$folder" -G Ninja "$@"
}

echo "check_package: the README's program is the consumer's"
sed -n '/\/\/ README$/,/\/\/ end of README$/{//d;s/^    //;p}' "$source/tests/package/main.cpp" >"$scratch/lines"
[ "$(wc -l <"$scratch/lines")" -ge 5 ] || fail "no lines for the README in tests/package/main.cpp"
while IFS= read -r line; do
    grep -qxF -e "$line" "$source/README.md" || fail "not in README.md: $line"
done <"$scratch/lines"

echo "check_package: installing $build"
quietly cmake --install "$build" --prefix "$prefix"
# A package that names the tree it came from works on this machine only.
if grep -rlF -e "$source" -e "$build" --include='*.cmake' "$prefix"; then
    fail "the files above name the source or build tree"
fi

echo "check_package: a consumer of the installed package"
configure installed -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_FIND_USE_PACKAGE_REGISTRY=OFF
grep -q "^cellproj_DIR:PATH=$prefix/" "$scratch/installed/CMakeCache.txt" || fail "another cellproj was found"
quietly cmake --build "$scratch/installed" --target consumer
said=$(cd "$scratch/installed" && ./consumer) || fail "the consumer failed"
[ "$said" = "order: 0" ] || fail "expected \"order: 0\", found \"$said\""
[ -s "$scratch/installed/tet.png" ] || fail "the consumer wrote no picture"

# Only mesh/ knows whether there is VTK, so it is built as a whole. Of each other library one file, with what is generated for it,
# shows that it finds its way inside another project; the rest is compiled likewise. A header precompiled for one file gains nothing.
echo "check_package: the source tree inside another project, without VTK and mesher"
configure subdirectory -DCMAKE_CXX_FLAGS=-O0 -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON -DCMAKE_OPTIMIZE_DEPENDENCIES=ON -DCELLPROJ_TREE="$source" -DCELLPROJ_WITH_VTK=OFF -DCELLPROJ_WITH_MESHER=OFF
! [ -e "$scratch/subdirectory/cellproj/tests" ] || fail "tests are configured inside another project"
samples=()
for file in classify/transfer_function.cpp sort/depth_keys.cpp project/camera_json.cpp \
    render/shaders.cpp render/gl/objects.cpp render/image_exr.cpp render/cpu/screen_mesh.cpp; do
    folder=${file%%/*}
    samples+=("cellproj/$folder/CMakeFiles/cellproj_$folder.dir/${file#*/}.o")
done
quietly cmake --build "$scratch/subdirectory" --target files "${samples[@]}"

# says KIND FILE WORDS: what `files` says about a file holds these words.
says() {
    local said
    said=$("$scratch/subdirectory/files" "$1" "$scratch/$2") || true
    [[ $said == *"$3"* ]] || fail "expected \"$3\" about $2, found \"$said\""
}

echo "check_package: files without VTK: our own readers read, the others say how to get them"
corner=$'0 0 0\n1 0 0\n0 1 0\n0 0 1'
printf 'OFF\n4 4 0\n%s\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n' "$corner" >"$scratch/corner.off"
printf '4 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n4 0\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n0\n' >"$scratch/corner.smesh"
printf 'MeshVersionFormatted 2\nDimension 3\nVertices 4\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\nTetrahedra 1\n1 2 3 4 0\nEnd\n' \
    >"$scratch/corner.mesh"
printf '<VTKFile type="UnstructuredGrid">\n' >"$scratch/corner.vtu"
printf '<VTKFile type="PolyData">\n' >"$scratch/corner.vtp"
printf 'solid corner\nendsolid corner\n' >"$scratch/corner.stl"
says surface corner.off "4 points"
says surface corner.smesh "4 points"
says mesh corner.mesh "4 points"
says mesh corner.vtu "build with -DCELLPROJ_WITH_VTK=ON"
says surface corner.vtp "build with -DCELLPROJ_WITH_VTK=ON"
says surface corner.stl "build with -DCELLPROJ_WITH_VTK=ON"
echo "check_package: good"
