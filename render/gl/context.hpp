// SPDX-License-Identifier: BSD-3-Clause
//
// An OpenGL 4.5 core context, off screen: what renderers need of it, whichever library makes it. Libraries are loaded when a context is
// made and not linked: without them the program still starts, and says what is missing.
#pragma once

#include <memory>
#include <string>

namespace cellproj::gl {

class Context {
public:
    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;
    virtual ~Context() = default;

    virtual const char* name() const = 0;  // as statistics call it

    // Makes it current in the calling thread and the OpenGL functions (glad) ready to use. Throws Error (environment).
    void make_current();
    // No context is current in the calling thread any more. Mesa's libraries share the table of the current context, so that one which
    // stays current confuses the other library; and EGL refuses a context that is current in another thread.
    virtual void release() noexcept = 0;

protected:
    using Function = void (*)();
    using Loader = Function (*)(const char*);

    Context() = default;

private:
    virtual void bind() = 0;
    virtual Loader loader() const = 0;
};

// Made current: for members of whoever owns it that are OpenGL objects.
std::unique_ptr<Context> current(std::unique_ptr<Context> context);

// Current as long as this lives.
class CurrentContext {
public:
    explicit CurrentContext(Context& context) : context_(context) { context_.make_current(); }
    ~CurrentContext() { context_.release(); }
    CurrentContext(const CurrentContext&) = delete;
    CurrentContext& operator=(const CurrentContext&) = delete;

private:
    Context& context_;
};

}  // namespace cellproj::gl
