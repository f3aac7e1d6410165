// SPDX-License-Identifier: BSD-3-Clause
#include "render/gl/context.hpp"

#include <glad/gl.h>

#include <mutex>
#include <utility>

#include "mesh/error.hpp"

namespace cellproj::gl {

namespace {

// glad's functions are those of the whole process, as OpenGL's are; another library's contexts want its own.
std::mutex loading;
const void* loaded_from = nullptr;

}  // namespace

std::unique_ptr<Context> current(std::unique_ptr<Context> context) {
    context->make_current();
    return context;
}

void Context::make_current() {
    bind();
    const std::lock_guard lock(loading);
    const auto* origin = reinterpret_cast<const void*>(loader());
    if (loaded_from == origin) return;
    // Loaders answer for any name, so the version is what counts, not the pointers.
    loaded_from = nullptr;
    if (gladLoadGL(loader()) < GLAD_MAKE_VERSION(4, 5)) {
        throw Error({ErrorKind::environment, name(), "OpenGL 4.5", "an older version", "install a newer Mesa or driver, or use --backend cpu"});
    }
    loaded_from = origin;
}

}  // namespace cellproj::gl
