// SPDX-License-Identifier: BSD-3-Clause
#include "render/gl/osmesa_context.hpp"

#include <dlfcn.h>
#include <glad/gl.h>
// After glad, which declares what osmesa.h takes from GL/gl.h.
#include <GL/osmesa.h>

#include <array>
#include <utility>

#include "mesh/error.hpp"

namespace cellproj::gl {

struct OsmesaContext::Library {
    using CreateContext = OSMesaContext (*)(const int*, OSMesaContext);
    using DestroyContext = void (*)(OSMesaContext);
    using MakeCurrent = GLboolean (*)(OSMesaContext, void*, GLenum, GLsizei, GLsizei);
    using GetProcAddress = OSMESAproc (*)(const char*);

    void* handle = nullptr;
    DestroyContext destroy = nullptr;
    MakeCurrent make_current = nullptr;
    GetProcAddress get_proc_address = nullptr;
    OSMesaContext context = nullptr;
    bool loaded = false;  // glad's functions
    // The context's own colour buffer, never drawn to: pictures go to framebuffer objects.
    std::array<GLubyte, 4> buffer{};

    // The library itself stays loaded: Mesa's worker threads may outlive the context.
    ~Library() {
        if (context) destroy(context);
    }

    template <class Function>
    Function find(const char* name) const {
        return reinterpret_cast<Function>(dlsym(handle, name));
    }
};

namespace {

[[noreturn]] void fail(const std::string& library, std::string expected, std::string found) {
    throw Error({ErrorKind::environment, library, std::move(expected), std::move(found),
                 "install Mesa's off-screen OpenGL, on Debian the package libosmesa6"});
}

}  // namespace

OsmesaContext::OsmesaContext(const std::string& name) : library_(std::make_unique<Library>()) {
    Library& library = *library_;
    library.handle = dlopen(name.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!library.handle) fail(name, "the OSMesa library", dlerror());
    const auto create = library.find<Library::CreateContext>("OSMesaCreateContextAttribs");
    library.destroy = library.find<Library::DestroyContext>("OSMesaDestroyContext");
    library.make_current = library.find<Library::MakeCurrent>("OSMesaMakeCurrent");
    library.get_proc_address = library.find<Library::GetProcAddress>("OSMesaGetProcAddress");
    if (!create || !library.destroy || !library.make_current || !library.get_proc_address) {
        fail(name, "OSMesa 11.2 or newer", "a library without its functions");
    }
    constexpr std::array attributes{OSMESA_FORMAT, OSMESA_RGBA, OSMESA_PROFILE, OSMESA_CORE_PROFILE,
                                    OSMESA_CONTEXT_MAJOR_VERSION, 4, OSMESA_CONTEXT_MINOR_VERSION, 5, 0};
    library.context = create(attributes.data(), nullptr);
    if (!library.context) fail(name, "OpenGL 4.5 core", "a refusal");
}

OsmesaContext::~OsmesaContext() = default;
OsmesaContext::OsmesaContext(OsmesaContext&&) noexcept = default;
OsmesaContext& OsmesaContext::operator=(OsmesaContext&&) noexcept = default;

void OsmesaContext::make_current() {
    Library& library = *library_;
    if (!library.make_current(library.context, library.buffer.data(), GL_UNSIGNED_BYTE, 1, 1)) {
        fail("OSMesaMakeCurrent", "success", "a refusal");
    }
    // OSMesaGetProcAddress answers for any name, so the version is what counts, not the pointers.
    if (!library.loaded && gladLoadGL(library.get_proc_address) < GLAD_MAKE_VERSION(4, 5)) {
        fail("OSMesa", "OpenGL 4.5", "an older version");
    }
    library.loaded = true;
}

OsmesaContext current(OsmesaContext context) {
    context.make_current();
    return context;
}

}  // namespace cellproj::gl
