// SPDX-License-Identifier: BSD-3-Clause
#include "render/gl/egl_context.hpp"

#include <dlfcn.h>
#define EGL_NO_X11  // no window: X11's headers are not needed
#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <algorithm>
#include <array>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

#include "mesh/error.hpp"
#include "render/gl/objects.hpp"

namespace cellproj::gl {

namespace {

[[noreturn]] void fail(const std::string& library, std::string expected, std::string found) {
    throw Error({ErrorKind::environment, library, std::move(expected), std::move(found),
                 "install EGL and a driver for it, on Debian the packages libegl1 and libegl-mesa0, or use --backend cpu"});
}

// Of a list of names with spaces in between.
bool lists(const char* names, std::string_view name) {
    std::istringstream words(names ? names : "");
    for (std::string word; words >> word;)
        if (word == name) return true;
    return false;
}

}  // namespace

struct EglContext::Library {
    explicit Library(const std::string& name);
    // The library stays loaded and displays stay initialized: others of this process may share them.
    ~Library() {
        if (context != EGL_NO_CONTEXT) destroy_context(display, context);
    }
    Library(const Library&) = delete;
    Library& operator=(const Library&) = delete;

    struct Device {
        EGLDeviceEXT device;
        bool software;
    };
    // Nothing where EGL cannot list them.
    std::vector<Device> devices() const;
    // Displays that may serve, the best ones first.
    std::vector<EGLDisplay> displays(Devices wanted) const;
    // Makes `context` on a display; false when it refuses.
    bool open(EGLDisplay on);

    std::string name;
    decltype(&eglGetProcAddress) get_proc_address = nullptr;
    decltype(&eglQueryString) query_string = nullptr;
    decltype(&eglInitialize) initialize = nullptr;
    decltype(&eglBindAPI) bind_api = nullptr;
    decltype(&eglCreateContext) create_context = nullptr;
    decltype(&eglDestroyContext) destroy_context = nullptr;
    decltype(&eglMakeCurrent) make_current = nullptr;
    PFNEGLGETPLATFORMDISPLAYEXTPROC platform_display = nullptr;
    EGLDisplay display = EGL_NO_DISPLAY;
    EGLContext context = EGL_NO_CONTEXT;

private:
    template <class Function>
    void find(void* handle, Function& function, const char* symbol) {
        function = reinterpret_cast<Function>(dlsym(handle, symbol));
        if (!function) fail(name, "EGL 1.4 or newer", std::string("a library without ") + symbol);
    }
    template <class Function>
    Function extension(const char* symbol) const {
        return reinterpret_cast<Function>(get_proc_address(symbol));
    }
    bool client_has(std::string_view extension_name) const {
        return lists(query_string(EGL_NO_DISPLAY, EGL_EXTENSIONS), extension_name);
    }
};

EglContext::Library::Library(const std::string& library) : name(library) {
    void* handle = dlopen(name.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!handle) fail(name, "the EGL library", dlerror());
    find(handle, get_proc_address, "eglGetProcAddress");
    find(handle, query_string, "eglQueryString");
    find(handle, initialize, "eglInitialize");
    find(handle, bind_api, "eglBindAPI");
    find(handle, create_context, "eglCreateContext");
    find(handle, destroy_context, "eglDestroyContext");
    find(handle, make_current, "eglMakeCurrent");
    if (!client_has("EGL_EXT_platform_base")) fail(name, "EGL_EXT_platform_base", "a library without it");
    platform_display = extension<PFNEGLGETPLATFORMDISPLAYEXTPROC>("eglGetPlatformDisplayEXT");
}

std::vector<EglContext::Library::Device> EglContext::Library::devices() const {
    const bool lists_them = client_has("EGL_EXT_device_base") ||
                            (client_has("EGL_EXT_device_enumeration") && client_has("EGL_EXT_device_query"));
    if (!lists_them || !client_has("EGL_EXT_platform_device")) return {};
    const auto query_devices = extension<PFNEGLQUERYDEVICESEXTPROC>("eglQueryDevicesEXT");
    const auto query_device = extension<PFNEGLQUERYDEVICESTRINGEXTPROC>("eglQueryDeviceStringEXT");
    std::array<EGLDeviceEXT, 64> found{};
    EGLint count = 0;
    if (!query_devices(static_cast<EGLint>(found.size()), found.data(), &count)) return {};
    std::vector<Device> result;
    for (EGLint i = 0; i < count; ++i) {
        const EGLDeviceEXT device = found[static_cast<std::size_t>(i)];
        result.push_back({device, lists(query_device(device, EGL_EXTENSIONS), "EGL_MESA_device_software")});
    }
    return result;
}

std::vector<EGLDisplay> EglContext::Library::displays(Devices wanted) const {
    std::vector<EGLDisplay> result;
    const std::vector<Device> known = devices();
    const auto add_devices = [&](bool software) {
        for (const Device& device : known)
            if (device.software == software) result.push_back(platform_display(EGL_PLATFORM_DEVICE_EXT, device.device, nullptr));
    };
    add_devices(false);
    if (wanted == Devices::any) {
        if (client_has("EGL_MESA_platform_surfaceless"))
            result.push_back(platform_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr));
        add_devices(true);
    }
    std::erase(result, EGL_NO_DISPLAY);
    return result;
}

bool EglContext::Library::open(EGLDisplay on) {
    if (!initialize(on, nullptr, nullptr)) return false;
    const char* extensions = query_string(on, EGL_EXTENSIONS);
    if (!lists(extensions, "EGL_KHR_no_config_context") || !lists(extensions, "EGL_KHR_surfaceless_context")) return false;
    if (!bind_api(EGL_OPENGL_API)) return false;
    constexpr std::array<EGLint, 7> attributes{EGL_CONTEXT_MAJOR_VERSION, 4, EGL_CONTEXT_MINOR_VERSION, 5,
                                               EGL_CONTEXT_OPENGL_PROFILE_MASK, EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
    context = create_context(on, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes.data());
    display = on;
    return context != EGL_NO_CONTEXT;
}

EglContext::EglContext(const std::string& library, Devices devices) : library_(std::make_unique<Library>(library)) {
    const std::vector<EGLDisplay> displays = library_->displays(devices);
    if (std::ranges::any_of(displays, [&](EGLDisplay display) { return library_->open(display); })) return;
    const std::string kind = devices == Devices::any ? "device or platform" : "GPU";
    fail(library, "OpenGL 4.5 core without a window",
         displays.empty() ? "no " + kind + " that EGL knows of" : "no " + kind + " that offers it, of " + std::to_string(displays.size()));
}

EglContext::~EglContext() = default;

void EglContext::bind() {
    const Library& library = *library_;
    // The API is that of the calling thread.
    if (!library.bind_api(EGL_OPENGL_API) || !library.make_current(library.display, EGL_NO_SURFACE, EGL_NO_SURFACE, library.context))
        fail("eglMakeCurrent", "success", "a refusal");
}

void EglContext::release() noexcept { library_->make_current(library_->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT); }

Context::Loader EglContext::loader() const { return library_->get_proc_address; }

bool draws_on_cpu(const std::string& driver) {
    return std::ranges::any_of(std::array{"llvmpipe", "softpipe", "swrast", "SWR", "Software Rasterizer"},
                               [&](const char* name) { return driver.find(name) != std::string::npos; });
}

Gpu find_gpu(const std::string& egl_library) {
    try {
        EglContext context(egl_library, EglContext::Devices::gpus_only);
        const CurrentContext current(context);
        const std::string driver = driver_version();
        return draws_on_cpu(driver) ? Gpu{false, driver + ", which draws on the CPU"} : Gpu{true, driver};
    } catch (const Error& error) {
        return {false, error.found()};
    }
}

}  // namespace cellproj::gl
