// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <openxr/openxr.h>

#include <stdexcept>
#include <string>

#include "client/render/views/camera.hpp"
#include "common/math/transform.hpp"

namespace eti::hmd {

/// The result's name, as the specification spells it.
[[nodiscard]] std::string name_of(XrResult result);

/// A failed OpenXR call.
struct OpenXrError : std::runtime_error {
    OpenXrError(const char* call, XrResult result);
    [[nodiscard]] bool runtime_lost() const {
        return result == XR_ERROR_INSTANCE_LOST || result == XR_ERROR_RUNTIME_UNAVAILABLE;
    }
    [[nodiscard]] bool headset_lost() const { return result == XR_ERROR_SESSION_LOST; }
    XrResult result;
};

/// Throws OpenXrError for errors; returns success codes.
XrResult check(XrResult result, const char* call);

/// An OpenXR structure with its type set and all other fields zero.
template <class Structure>
[[nodiscard]] Structure make_struct(XrStructureType type) {
    Structure out{};
    out.type = type;
    return out;
}

/// Owns a handle; destroyed in reverse order of creation.
template <class Handle, XrResult(XRAPI_PTR* Destroy)(Handle)>
class UniqueHandle {
  public:
    UniqueHandle() = default;
    ~UniqueHandle() {
        if (handle_ != XR_NULL_HANDLE) {
            (void)Destroy(handle_);
        }
    }
    UniqueHandle(const UniqueHandle&) = delete;
    UniqueHandle& operator=(const UniqueHandle&) = delete;

    [[nodiscard]] Handle get() const { return handle_; }
    /// Output argument for the creating call.
    [[nodiscard]] Handle* put() { return &handle_; }

  private:
    Handle handle_ = XR_NULL_HANDLE;
};

[[nodiscard]] RigidTransform from_xr(const XrPosef& pose);
[[nodiscard]] XrPosef to_xr(const RigidTransform& pose);
[[nodiscard]] render::FieldOfView from_xr(const XrFovf& fov);
[[nodiscard]] XrFovf to_xr(const render::FieldOfView& field);

}  // namespace eti::hmd
