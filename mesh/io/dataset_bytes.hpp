// SPDX-License-Identifier: BSD-3-Clause
//
// Private to mesh/: datasets, surfaces and errors on their way from one process to another.
#pragma once

#include "mesh/io/byte_stream.hpp"
#include "mesh/dataset.hpp"
#include "mesh/error.hpp"
#include "mesh/surface.hpp"

namespace cellproj {

// Each array is given back as soon as it is written, so that no more than one is held twice.
void put(ByteWriter& writer, Dataset&& dataset);
void put(ByteWriter& writer, Surface&& surface);
void put(ByteWriter& writer, const Error& error);

// The counterparts. What the numbers mean is not checked.
void take(ByteReader& reader, Dataset& dataset);
void take(ByteReader& reader, Surface& surface);
Error take_error(ByteReader& reader);

}  // namespace cellproj
