// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/hmd/graphics.hpp"

#include <array>
#include <stdexcept>

#include "client/hmd/xr.hpp"

// Last: X11 defines macros that clash with other headers.
#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <epoxy/glx.h>

#define XR_USE_GRAPHICS_API_OPENGL
#define XR_USE_PLATFORM_EGL
#define XR_USE_PLATFORM_XLIB
#include <openxr/openxr_platform.h>

namespace eti::hmd {

struct Graphics::Names {
    XrGraphicsBindingEGLMNDX egl = make_struct<XrGraphicsBindingEGLMNDX>(XR_TYPE_GRAPHICS_BINDING_EGL_MNDX);
    XrGraphicsBindingOpenGLXlibKHR glx =
        make_struct<XrGraphicsBindingOpenGLXlibKHR>(XR_TYPE_GRAPHICS_BINDING_OPENGL_XLIB_KHR);
    bool through_egl = false;
};

namespace {

XrGraphicsBindingEGLMNDX named_by_egl() {
    auto out = make_struct<XrGraphicsBindingEGLMNDX>(XR_TYPE_GRAPHICS_BINDING_EGL_MNDX);
    out.getProcAddress = reinterpret_cast<PFNEGLGETPROCADDRESSPROC>(eglGetProcAddress);
    out.display = eglGetCurrentDisplay();
    out.context = eglGetCurrentContext();
    EGLint id = 0, count = 0;
    // A context may have been created without a config.
    if (eglQueryContext(out.display, out.context, EGL_CONFIG_ID, &id) == EGL_TRUE && id != 0) {
        const std::array<EGLint, 3> same{EGL_CONFIG_ID, id, EGL_NONE};
        eglChooseConfig(out.display, same.data(), &out.config, 1, &count);
    }
    return out;
}

XrGraphicsBindingOpenGLXlibKHR named_by_glx() {
    auto out = make_struct<XrGraphicsBindingOpenGLXlibKHR>(XR_TYPE_GRAPHICS_BINDING_OPENGL_XLIB_KHR);
    out.xDisplay = glXGetCurrentDisplay();
    out.glxContext = glXGetCurrentContext();
    out.glxDrawable = glXGetCurrentDrawable();
    if (out.xDisplay == nullptr || out.glxContext == nullptr) {
        throw std::runtime_error(
            "--view hmd: no GLX or EGL context is available for the headset's runtime. Start the client "
            "under X11 (or Xwayland), or without a display.");
    }
    int id = 0, count = 0;
    glXQueryContext(out.xDisplay, out.glxContext, GLX_FBCONFIG_ID, &id);
    const std::array<int, 3> same{GLX_FBCONFIG_ID, id, 0};
    if (GLXFBConfig* const configs =
            glXChooseFBConfig(out.xDisplay, DefaultScreen(out.xDisplay), same.data(), &count)) {
        if (count > 0) {
            out.glxFBConfig = configs[0];
            if (XVisualInfo* const visual = glXGetVisualFromFBConfig(out.xDisplay, configs[0])) {
                out.visualid = static_cast<std::uint32_t>(visual->visualid);
                XFree(visual);
            }
        }
        XFree(configs);
    }
    return out;
}

}  // namespace

Graphics::Graphics() : names_(std::make_unique<Names>()) {
    names_->through_egl = eglGetCurrentContext() != EGL_NO_CONTEXT;
    if (names_->through_egl) {
        names_->egl = named_by_egl();
    } else {
        names_->glx = named_by_glx();
    }
}

Graphics::~Graphics() = default;

void Graphics::make_current() const {
    if (names_->through_egl) {
        eglMakeCurrent(names_->egl.display, EGL_NO_SURFACE, EGL_NO_SURFACE, names_->egl.context);
    } else {
        glXMakeCurrent(names_->glx.xDisplay, names_->glx.glxDrawable, names_->glx.glxContext);
    }
}

const void* Graphics::binding() const {
    return names_->through_egl ? static_cast<const void*>(&names_->egl) : &names_->glx;
}

}  // namespace eti::hmd
