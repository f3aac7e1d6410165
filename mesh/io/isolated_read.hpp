// SPDX-License-Identifier: BSD-3-Clause
//
// Private to mesh/: foreign readers kept where they can do no harm.
//
// VTK's readers, and the libraries below them, crash, loop, ask for any amount of memory or end the process when a file is
// damaged. So every read through them runs in a fork of this process, and what it makes of the file comes back through
// memory that both share. The child has limits:
// - time: 8 s and 1 s per MB of the file, of which 2 s and 1 s per MB on a processor, as an endless loop needs less patience
//   than a slow disk;
// - memory (RLIMIT_DATA): what this process has now, 32 MB, and 5000 bytes per byte of the file, never more than the
//   machine's memory: a voxel of one byte needs some 50 here, and fields may be packed to one hundredth. No limit under
//   AddressSanitizer, whose own memory counts.
//
// What fork means for a caller of several threads: the child has only the thread that called; locks that another thread
// held at that moment stay locked in it. malloc and stdio take care of themselves. VTK's own locks are taken by no other
// thread unless the caller uses VTK elsewhere at the same time. A child that stands still for 3 s, as one that meets a
// lock held there, is ended and the read tried once more, with all of its time. The child starts no threads: VTK's are switched off in it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>

#include "mesh/io/dataset_bytes.hpp"

namespace cellproj {

// Hears how much has been read, 0 to 1; by VTK's own count, which may start again with each part of a file.
using ProgressCallback = std::function<void(double fraction)>;

// `work` runs in the child and writes its result, `take` reads it in this process. `work` throws the Errors of a reader,
// which arrive here as they are; a crash, a limit reached, an early end and anything printed become Error (format) about
// `file`. `bytes`: its size, and that of the files it names. Throws Error (environment) when there is no child to be had.
void run_isolated(const std::filesystem::path& file, std::uintmax_t bytes, const ProgressCallback& progress,
                  const std::function<void(ByteWriter&)>& work, const std::function<void(ByteReader&)>& take);

// The same for a function that returns a Dataset or a Surface.
template <class Read>
auto read_isolated(const std::filesystem::path& file, std::uintmax_t bytes, const ProgressCallback& progress, Read read) {
    decltype(read()) result;
    run_isolated(
        file, bytes, progress, [&](ByteWriter& writer) { put(writer, read()); },
        [&](ByteReader& reader) { take(reader, result); });
    return result;
}

// In the child: tells the caller's ProgressCallback. Elsewhere: does nothing.
void report_progress(double fraction);

}  // namespace cellproj
