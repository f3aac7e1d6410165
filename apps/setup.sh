#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
#
# Installs the Debian packages that cellproj needs and this machine lacks. Nothing missing: done at once, without a word
# and without rights. Wants Debian 12 or a relative of it, as root or with sudo.
set -euo pipefail

packages=(
    # build
    cmake ninja-build g++ pkg-config git
    # reading meshes
    libvtk9-dev
    # exact signs (CGAL's kernels over GMP); the mesher's program: TetGen, and CGAL's repair of surfaces
    libcgal-dev libtet1.5-dev
    # vectors, threads, SIMD for the instruction sets of the machine
    libglm-dev libtbb-dev libhwy-dev
    # OpenGL without a screen: OSMesa and EGL at build and at run time, glad to generate its loader
    libosmesa6-dev libosmesa6 libegl-dev libegl1 libegl-mesa0 python3-glad
    # pictures and the text in them, JSON, the command line
    libpng-dev libopenexr-dev libfreetype-dev fonts-dejavu-core nlohmann-json3-dev libcli11-dev
    # tests and benchmarks; clang for the sanitizers and libFuzzer
    clang libclang-rt-dev libgtest-dev librapidcheck-dev libbenchmark-dev
)

if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
    {
        echo "setup: this machine has no apt-get, so it is no Debian; install what these Debian packages hold by its own means:"
        echo "  ${packages[*]}"
        echo "then build with: cmake --preset release && cmake --build --preset release"
    } >&2
    exit 1
fi

# One question for all packages. dpkg-query fails when it knows nothing of one of them, which is no failure here.
installed=$(dpkg-query --show --showformat='${db:Status-Status} ${Package}\n' "${packages[@]}" 2>/dev/null |
    sed -n 's/^installed //p') || true
missing=()
for package in "${packages[@]}"; do
    grep -qxF "$package" <<<"$installed" || missing+=("$package")
done
[ ${#missing[@]} -gt 0 ] || exit 0

as_root=()
by_hand="apt-get update && apt-get install -y --no-install-recommends ${missing[*]}"
if [ "$(id -u)" != 0 ]; then
    if ! command -v sudo >/dev/null; then
        {
            echo "setup: packages are missing, and only root may install them. As root, type:"
            echo "  $by_hand"
        } >&2
        exit 1
    fi
    as_root=(sudo)
    by_hand="sudo apt-get update && sudo apt-get install -y --no-install-recommends ${missing[*]}"
fi

apt_get() { "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq "$@" >&2; }

echo "setup: installing ${missing[*]}"
if ! { apt_get update && apt_get install -y --no-install-recommends "${missing[@]}"; }; then
    {
        echo "setup: apt-get failed, its message stands above. To try again by hand, type:"
        echo "  $by_hand"
    } >&2
    exit 1
fi
