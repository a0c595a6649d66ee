// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <memory>

namespace eti::hmd {

/// The OpenGL context that pictures for a headset are drawn with, named as a runtime wants it: of a window
/// (GLX), or of none (EGL).
class Graphics {
  public:
    /// Of the context that is current. Throws std::runtime_error where none is.
    Graphics();
    ~Graphics();
    Graphics(const Graphics&) = delete;
    Graphics& operator=(const Graphics&) = delete;

    /// Again: runtimes draw with contexts of their own and may leave one of those, or none, current.
    void make_current() const;
    /// For XrSessionCreateInfo::next.
    [[nodiscard]] const void* binding() const;

  private:
    struct Names;
    std::unique_ptr<Names> names_;
};

}  // namespace eti::hmd
