#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
#
# From a fresh clone to a picture: installs what is missing, builds the programs, renders an embedded scene.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
root=$PWD

echo "demo: checking packages"
apps/setup.sh
apps/build.sh release cellproj_programs

program=build/release/bin/cellproj
echo "demo: rendering the flow around a sphere"
"$program" render demo:sphere -o demo.png

cat <<END

The picture is $root/demo.png
Next, in $root:
  $program render demo:sphere -o turn.png --orbit 360 --frames 12 --size 800x600
  $program info YOUR_FILE.vtu
  $program render YOUR_FILE.vtu -o picture.png --stats /dev/stdout
  $program render --help
END
