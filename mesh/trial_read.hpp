// SPDX-License-Identifier: BSD-3-Clause
//
// Private to mesh/: readers that are not safe with damaged files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>

namespace cellproj {

// Runs `work`, which reads `file`, in a child of this process first, where it can do no harm: VTK's readers of some
// formats crash, loop or end the process when a file is cut off, or print a complaint and go on. Returns when the child
// came through in silence; the caller then does the same work itself. So reading takes twice as long. Throws the Error
// that `work` throws, and Error (format) when the child crashed, ended, printed anything or took longer than 8 s and 1
// s per 5 MB of `bytes`.
void require_harmless(const std::filesystem::path& file, std::uintmax_t bytes, const std::function<void()>& work);

}  // namespace cellproj
