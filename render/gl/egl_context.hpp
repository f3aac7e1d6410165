// SPDX-License-Identifier: BSD-3-Clause
//
// OpenGL through EGL, without a window or a display: on a GPU where there is one, else on the CPU by Mesa's surfaceless platform.
#pragma once

#include <memory>
#include <string>

#include "render/gl/context.hpp"
#include "render/gpu.hpp"

namespace cellproj::gl {

class EglContext : public Context {
public:
    // Which displays may serve; each kind in EGL's own order.
    enum class Devices {
        any,      // those of GPUs, then Mesa's surfaceless platform, then what draws on the CPU
        gpus_only
    };

    // The first display that gives OpenGL 4.5 core. Throws Error (environment) when the library is missing or there is none.
    explicit EglContext(const std::string& library, Devices devices = Devices::any);
    ~EglContext() override;

    const char* name() const override { return "gl_egl"; }
    void release() noexcept override;

private:
    void bind() override;
    Loader loader() const override;

    struct Library;
    std::unique_ptr<Library> library_;
};

// Whether an OpenGL driver, by what it says of itself, computes on the CPU.
bool draws_on_cpu(const std::string& driver);

// Asks the devices that EGL lists; a context is made only where one is no software. No library, no driver: no GPU.
Gpu find_gpu(const std::string& egl_library);

}  // namespace cellproj::gl
