// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "client/hmd/hand_input.hpp"
#include "client/hmd/xr.hpp"

namespace eti::hmd {

/// OpenXR actions for the hand controllers, with suggested bindings for each interaction profile.
class Actions {
  public:
    /// Must be created before the session begins. Throws OpenXrError.
    Actions(XrInstance instance, XrSession session);

    /// Reads the state of the hands, and their aim poses in `world` at a time. All inactive while the
    /// runtime holds the input focus.
    [[nodiscard]] HandInput read(XrSpace world, XrTime at) const;

  private:
    enum class HandScope : bool { any_hand, each_hand };
    [[nodiscard]] XrAction make(XrActionType type, const char* name, const char* shown,
                                HandScope scope = HandScope::any_hand) const;
    void suggest(XrInstance instance) const;
    [[nodiscard]] bool pressed(XrAction action) const;
    [[nodiscard]] Pad pad(XrAction place, XrAction press) const;
    [[nodiscard]] float trigger(std::size_t hand) const;
    [[nodiscard]] std::optional<RigidTransform> aim(std::size_t hand, XrSpace world, XrTime at) const;

    XrSession session_;
    UniqueHandle<XrActionSet, xrDestroyActionSet> set_;
    // Destroyed with their action set.
    std::array<XrPath, 2> hands_{};  // left first
    XrAction trigger_ = XR_NULL_HANDLE, aim_ = XR_NULL_HANDLE;
    XrAction head_and_jaw_ = XR_NULL_HANDLE, head_and_jaw_pressed_ = XR_NULL_HANDLE;
    XrAction table_ = XR_NULL_HANDLE, table_pressed_ = XR_NULL_HANDLE;
    XrAction head_up_ = XR_NULL_HANDLE, head_down_ = XR_NULL_HANDLE, enhanced_ = XR_NULL_HANDLE;
    XrAction panel_ = XR_NULL_HANDLE;
    std::array<UniqueHandle<XrSpace, xrDestroySpace>, 2> aims_;
};

}  // namespace eti::hmd
