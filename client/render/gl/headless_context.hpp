// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <epoxy/egl.h>

#include <string>

namespace eti::render {

/// An OpenGL context without a display or window (EGL, surfaceless), current from construction to
/// destruction. Throws std::runtime_error naming the missing package.
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

/// "renderer, version" of the current context.
[[nodiscard]] std::string driver_name();

}  // namespace eti::render
