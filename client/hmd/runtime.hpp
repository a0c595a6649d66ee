// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <optional>
#include <string>

#include "client/hmd/xr.hpp"

namespace eti::hmd {

/// No OpenXR runtime responds, or none supports OpenGL; a user can correct this.
struct RuntimeUnavailable : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// A headset that is ready for use.
struct Headset {
    XrSystemId system = XR_NULL_SYSTEM_ID;
    std::string name;
    int eye_width = 0, eye_height = 0;  ///< [pixels], as the runtime recommends
};

/// The OpenXR runtime, as found by the machine's loader.
class Runtime {
  public:
    /// Throws RuntimeUnavailable, which says what to install.
    Runtime();
    Runtime(const Runtime&) = delete;
    Runtime& operator=(const Runtime&) = delete;

    [[nodiscard]] XrInstance instance() const { return instance_.get(); }
    [[nodiscard]] const std::string& name() const { return name_; }
    /// Whether the runtime accepts a headless (EGL) context.
    [[nodiscard]] bool supports_egl() const { return egl_; }
    /// nullopt: no headset yet. Throws RuntimeUnavailable if there can never be one.
    [[nodiscard]] std::optional<Headset> headset() const;
    /// Loads an extension function. Throws OpenXrError.
    template <class Function>
    [[nodiscard]] Function function(const char* called) const {
        Function out = nullptr;
        check(xrGetInstanceProcAddr(instance(), called, reinterpret_cast<PFN_xrVoidFunction*>(&out)), called);
        return out;
    }

  private:
    UniqueHandle<XrInstance, xrDestroyInstance> instance_;
    std::string name_;
    bool egl_ = false;
};

}  // namespace eti::hmd
