// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "client/hmd/hand_input.hpp"
#include "client/hmd/xr.hpp"

namespace eti::hmd {

/// What hand controllers are asked for, and which part of which controller is suggested for it.
class Actions {
  public:
    /// Before the session begins. Throws CallFailed.
    Actions(XrInstance instance, XrSession session);

    /// Takes in what the hands do now, and where in `world` they point from at a time. All at rest while the
    /// runtime keeps them to itself.
    [[nodiscard]] HandInput read(XrSpace world, XrTime at) const;

  private:
    enum class Of : bool { any_hand, each_hand };
    [[nodiscard]] XrAction make(XrActionType type, const char* name, const char* shown,
                                Of of = Of::any_hand) const;
    void suggest(XrInstance instance) const;
    [[nodiscard]] bool pressed(XrAction action) const;
    [[nodiscard]] Pad pad(XrAction place, XrAction press) const;
    [[nodiscard]] float trigger(std::size_t hand) const;
    [[nodiscard]] std::optional<RigidTransform> aim(std::size_t hand, XrSpace world, XrTime at) const;

    XrSession session_;
    Owned<XrActionSet, xrDestroyActionSet> set_;
    // They go with their set.
    std::array<XrPath, 2> hands_{};  // left first
    XrAction trigger_ = XR_NULL_HANDLE, aim_ = XR_NULL_HANDLE;
    XrAction head_and_jaw_ = XR_NULL_HANDLE, head_and_jaw_pressed_ = XR_NULL_HANDLE;
    XrAction table_ = XR_NULL_HANDLE, table_pressed_ = XR_NULL_HANDLE;
    XrAction head_up_ = XR_NULL_HANDLE, head_down_ = XR_NULL_HANDLE, enhanced_ = XR_NULL_HANDLE;
    XrAction panel_ = XR_NULL_HANDLE;
    std::array<Owned<XrSpace, xrDestroySpace>, 2> aims_;
};

}  // namespace eti::hmd
