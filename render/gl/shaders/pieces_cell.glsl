// SPDX-License-Identifier: BSD-3-Clause
flat out vec2 v_pieces;  // the pieces of the cell's lowest and highest scalar

void prepare_cell(float low, float high) { v_pieces = vec2(piece_of(low), piece_of(high)); }
