#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
#
# check_layers.sh [ROOT]: the house rules of check_layers.py, after making sure that each of them still catches its violation.
set -euo pipefail
script=$(dirname "${BASH_SOURCE[0]}")/check_layers.py
python3 "$script" --self-test
python3 "$script" "$@"
