// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <epoxy/egl.h>

#include <string>

namespace eti::render {

/// An OpenGL context without any display or window (EGL, surfaceless), current from construction to
/// destruction. Throws std::runtime_error saying which package is missing.
class HeadlessContext {
  public:
    HeadlessContext();
    ~HeadlessContext();
    HeadlessContext(const HeadlessContext&) = delete;
    HeadlessContext& operator=(const HeadlessContext&) = delete;

  private:
    EGLDisplay display_ = EGL_NO_DISPLAY;
    EGLContext context_ = EGL_NO_CONTEXT;
};

/// "renderer, version" of the context that is current.
[[nodiscard]] std::string driver_name();

}  // namespace eti::render
