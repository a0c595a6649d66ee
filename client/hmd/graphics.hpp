// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <memory>

namespace eti::hmd {

/// The OpenGL context in which a headset's pictures are drawn, described as the runtime requires: windowed
/// (GLX) or headless (EGL).
class Graphics {
  public:
    /// Captures the current context. Throws std::runtime_error if there is none.
    Graphics();
    ~Graphics();
    Graphics(const Graphics&) = delete;
    Graphics& operator=(const Graphics&) = delete;

    /// Makes the context current again: runtimes draw with contexts of their own and may leave one of
    /// those, or none, current.
    void make_current() const;
    /// For XrSessionCreateInfo::next.
    [[nodiscard]] const void* binding() const;

  private:
    struct Names;
    std::unique_ptr<Names> names_;
};

}  // namespace eti::hmd
