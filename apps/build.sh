#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
#
# build.sh PRESET [TARGET]: configures and builds on all cores. Says one line per step, and what goes wrong.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
preset=$1
target=${2:-all}

echo "build: configuring build/$preset"
cmake --preset "$preset" >/dev/null
echo "build: building $target in build/$preset; the first time takes some minutes"
quiet=()
[ -t 1 ] || quiet=(-- --quiet)  # on a terminal Ninja keeps to one line by itself
cmake --build --preset "$preset" --target "$target" "${quiet[@]}"
