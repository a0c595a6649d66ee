// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <openxr/openxr.h>

#include <stdexcept>
#include <string>

#include "client/render/camera.hpp"
#include "common/math/transform.hpp"

namespace eti::hmd {

/// As the specification spells it.
[[nodiscard]] std::string name_of(XrResult result);

/// A call that the runtime refused.
struct CallFailed : std::runtime_error {
    CallFailed(const char* call, XrResult result);
    [[nodiscard]] bool runtime_gone() const {
        return result == XR_ERROR_INSTANCE_LOST || result == XR_ERROR_RUNTIME_UNAVAILABLE;
    }
    [[nodiscard]] bool headset_gone() const { return result == XR_ERROR_SESSION_LOST; }
    XrResult result;
};

/// Throws CallFailed for errors; passes on the kinds of success.
XrResult check(XrResult result, const char* call);

/// A structure of OpenXR of its type, all else zero.
template <class Structure>
[[nodiscard]] Structure made(XrStructureType type) {
    Structure out{};
    out.type = type;
    return out;
}

/// Owns a handle; destroyed in the reverse order of making.
template <class Handle, XrResult(XRAPI_PTR* Destroy)(Handle)>
class Owned {
  public:
    Owned() = default;
    ~Owned() {
        if (handle_ != XR_NULL_HANDLE) {
            (void)Destroy(handle_);
        }
    }
    Owned(const Owned&) = delete;
    Owned& operator=(const Owned&) = delete;

    [[nodiscard]] Handle get() const { return handle_; }
    /// For a call that makes it.
    [[nodiscard]] Handle* put() { return &handle_; }

  private:
    Handle handle_ = XR_NULL_HANDLE;
};

[[nodiscard]] RigidTransform from_xr(const XrPosef& pose);
[[nodiscard]] XrPosef to_xr(const RigidTransform& pose);
[[nodiscard]] render::Field from_xr(const XrFovf& fov);
[[nodiscard]] XrFovf to_xr(const render::Field& field);

}  // namespace eti::hmd
