// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <optional>
#include <string>

#include "client/hmd/xr.hpp"

namespace eti::hmd {

/// No runtime answers, or none that takes pictures of OpenGL: a person can mend that.
struct NoRuntime : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// A headset that can be worn now.
struct Headset {
    XrSystemId system = XR_NULL_SYSTEM_ID;
    std::string name;
    int eye_width = 0, eye_height = 0;  ///< [pixels], as the runtime recommends
};

/// The headset's software, as the machine's OpenXR loader finds it.
class Runtime {
  public:
    /// Throws NoRuntime, which says what to install.
    Runtime();
    Runtime(const Runtime&) = delete;
    Runtime& operator=(const Runtime&) = delete;

    [[nodiscard]] XrInstance instance() const { return instance_.get(); }
    [[nodiscard]] const std::string& name() const { return name_; }
    /// Takes pictures from a program that has no window.
    [[nodiscard]] bool takes_egl() const { return egl_; }
    /// Nothing: none is there yet. Throws NoRuntime where there never will be one.
    [[nodiscard]] std::optional<Headset> headset() const;
    /// Of an extension. Throws CallFailed.
    template <class Function>
    [[nodiscard]] Function function(const char* called) const {
        Function out = nullptr;
        check(xrGetInstanceProcAddr(instance(), called, reinterpret_cast<PFN_xrVoidFunction*>(&out)), called);
        return out;
    }

  private:
    Owned<XrInstance, xrDestroyInstance> instance_;
    std::string name_;
    bool egl_ = false;
};

}  // namespace eti::hmd
