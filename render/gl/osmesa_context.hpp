// SPDX-License-Identifier: BSD-3-Clause
//
// An OpenGL 4.5 core context on the CPU, off screen, through Mesa's OSMesa. The library is loaded when the first context is made and
// not linked: without it the program still starts, and says what is missing. It also must not meet Mesa's EGL in one
// process (they share the table of the current context).
#pragma once

#include <memory>
#include <string>

namespace cellproj::gl {

class OsmesaContext {
public:
    // Throws Error (environment) when the library is missing, too old, or refuses OpenGL 4.5 core.
    explicit OsmesaContext(const std::string& library);
    ~OsmesaContext();
    OsmesaContext(OsmesaContext&&) noexcept;
    OsmesaContext& operator=(OsmesaContext&&) noexcept;

    // Makes the context current in the calling thread and the OpenGL functions (glad) ready to use.
    void make_current();

private:
    struct Library;
    std::unique_ptr<Library> library_;
};

// The context made current: for members of whoever owns it that are OpenGL objects.
OsmesaContext current(OsmesaContext context);

}  // namespace cellproj::gl
