// SPDX-License-Identifier: BSD-3-Clause
void prepare_cell(float low, float high) {}
