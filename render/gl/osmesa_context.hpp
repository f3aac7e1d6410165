// SPDX-License-Identifier: BSD-3-Clause
//
// OpenGL on the CPU through Mesa's OSMesa.
#pragma once

#include <memory>
#include <string>

#include "render/gl/context.hpp"

namespace cellproj::gl {

class OsmesaContext : public Context {
public:
    // Throws Error (environment) when the library is missing, too old, or refuses OpenGL 4.5 core.
    explicit OsmesaContext(const std::string& library);
    ~OsmesaContext() override;

    const char* name() const override { return "gl_osmesa"; }
    void release() noexcept override;

private:
    void bind() override;
    Loader loader() const override;

    struct Library;
    std::unique_ptr<Library> library_;
};

}  // namespace cellproj::gl
