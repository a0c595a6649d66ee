// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/hmd/xr.hpp"

#include <openxr/openxr_reflection.h>

#include <fmt/format.h>

namespace eti::hmd {

std::string name_of(XrResult result) {
#define ETI_NAME(name, value) \
    case value:               \
        return #name;
    switch (result) {
        XR_LIST_ENUM_XrResult(ETI_NAME) default : return fmt::format("result {}", static_cast<int>(result));
    }
#undef ETI_NAME
}

OpenXrError::OpenXrError(const char* call, XrResult what)
    : std::runtime_error(fmt::format("OpenXR: the headset's runtime rejected {} ({}). Restart the runtime; "
                                     "eti-doctor tells which one is used.",
                                     call, name_of(what))),
      result(what) {}

XrResult check(XrResult result, const char* call) {
    if (XR_FAILED(result)) {
        throw OpenXrError(call, result);
    }
    return result;
}

RigidTransform from_xr(const XrPosef& pose) {
    const auto& [x, y, z, w] = pose.orientation;
    return RigidTransform::from(Quatf(w, x, y, z).normalized(),
                                {pose.position.x, pose.position.y, pose.position.z});
}

XrPosef to_xr(const RigidTransform& pose) {
    const Quatf& q = pose.rotation;
    const Vec3f& p = pose.translation;
    return {{q.x(), q.y(), q.z(), q.w()}, {p.x(), p.y(), p.z()}};
}

render::FieldOfView from_xr(const XrFovf& fov) {
    return {fov.angleLeft, fov.angleRight, fov.angleUp, fov.angleDown};
}

XrFovf to_xr(const render::FieldOfView& field) {
    return {field.left, field.right, field.up, field.down};
}

}  // namespace eti::hmd
