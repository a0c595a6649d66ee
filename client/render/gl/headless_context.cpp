// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/gl/headless_context.hpp"

#include <epoxy/gl.h>

#include <array>
#include <stdexcept>

#include <fmt/format.h>

namespace eti::render {
namespace {

EGLDisplay open_display() {
    if (epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless")) {
        const EGLDisplay display =
            eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
        if (display != EGL_NO_DISPLAY && eglInitialize(display, nullptr, nullptr) == EGL_TRUE) {
            return display;
        }
    }
    // Drivers without Mesa's surfaceless platform enumerate devices instead.
    if (epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_device")) {
        std::array<EGLDeviceEXT, 8> devices{};
        EGLint count = 0;
        if (eglQueryDevicesEXT(static_cast<EGLint>(devices.size()), devices.data(), &count) == EGL_TRUE) {
            for (EGLint i = 0; i < count; ++i) {
                const EGLDisplay display = eglGetPlatformDisplayEXT(
                    EGL_PLATFORM_DEVICE_EXT, devices[static_cast<std::size_t>(i)], nullptr);
                if (display != EGL_NO_DISPLAY && eglInitialize(display, nullptr, nullptr) == EGL_TRUE) {
                    return display;
                }
            }
        }
    }
    throw std::runtime_error(
        "no OpenGL without a display: EGL offers neither the surfaceless platform nor a device. Install a "
        "driver, e.g. Debian's libegl-mesa0 and libgl1-mesa-dri.");
}

}  // namespace

HeadlessContext::HeadlessContext() : display_(open_display()) {
    eglBindAPI(EGL_OPENGL_API);
    const std::array<EGLint, 3> wanted{EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
    EGLConfig config = nullptr;
    EGLint count = 0;
    // Surfaceless contexts may not need a config (EGL_KHR_no_config_context).
    eglChooseConfig(display_, wanted.data(), &config, 1, &count);
    // Drivers report a reset only on request, and some reject the request.
    const std::array<EGLint, 9> attributes{EGL_CONTEXT_MAJOR_VERSION,
                                           3,
                                           EGL_CONTEXT_MINOR_VERSION,
                                           3,
                                           EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                           EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                           EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY,
                                           EGL_LOSE_CONTEXT_ON_RESET,
                                           EGL_NONE};
    auto without = attributes;
    without[6] = EGL_NONE;
    EGLConfig const chosen = count > 0 ? config : nullptr;
    context_ = eglCreateContext(display_, chosen, EGL_NO_CONTEXT, attributes.data());
    if (context_ == EGL_NO_CONTEXT) {
        context_ = eglCreateContext(display_, chosen, EGL_NO_CONTEXT, without.data());
    }
    if (context_ == EGL_NO_CONTEXT ||
        eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) == EGL_FALSE) {
        const EGLint error = eglGetError();
        if (context_ != EGL_NO_CONTEXT) {
            eglDestroyContext(display_, context_);
        }
        eglTerminate(display_);
        throw std::runtime_error(
            fmt::format("the EGL driver does not provide an OpenGL 3.3 core context (error {:#x}). Install a "
                        "newer driver, e.g. Debian's libgl1-mesa-dri.",
                        error));
    }
}

HeadlessContext::~HeadlessContext() {
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(display_, context_);
    eglTerminate(display_);
}

std::string driver_name() {
    const auto text = [](GLenum what) {
        const GLubyte* value = glGetString(what);
        return value != nullptr ? std::string(reinterpret_cast<const char*>(value)) : std::string("unknown");
    };
    return fmt::format("{}, OpenGL {}", text(GL_RENDERER), text(GL_VERSION));
}

}  // namespace eti::render
