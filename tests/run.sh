#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
#
# Every test, from a fresh clone on: installs what is missing, builds, and runs the tests under the sanitizers
# (CELLPROJ_SKIP_SANITIZE=1 leaves that out), then optimized. The first suite that fails ends the run, so the last lines are
# always the summary of ctest that decides.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

echo "tests: checking packages"
apps/setup.sh

presets=(release)
[ "${CELLPROJ_SKIP_SANITIZE:-0}" = 1 ] || presets=(sanitize release)
for preset in "${presets[@]}"; do
    apps/build.sh "$preset"
    echo "tests: running the $preset suite"
    ctest --preset "$preset" --parallel "$(nproc)"
done
