// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "client/hmd/hand_input.hpp"
#include "client/hmd/xr.hpp"

namespace eti::hmd {

/// What hand controllers are asked for, and which part of which controller is suggested for it.
class Actions {
  public:
    /// Before the session begins. Throws CallFailed.
    Actions(XrInstance instance, XrSession session);

    /// Takes in what the hands do now. All at rest while the runtime keeps them to itself.
    [[nodiscard]] HandInput read() const;

  private:
    [[nodiscard]] XrAction make(XrActionType type, const char* name, const char* shown) const;
    void suggest(XrInstance instance) const;
    [[nodiscard]] bool pressed(XrAction action) const;
    [[nodiscard]] Pad pad(XrAction place, XrAction press) const;

    XrSession session_;
    Owned<XrActionSet, xrDestroyActionSet> set_;
    // They go with their set.
    XrAction suction_ = XR_NULL_HANDLE;
    XrAction head_and_jaw_ = XR_NULL_HANDLE, head_and_jaw_pressed_ = XR_NULL_HANDLE;
    XrAction table_ = XR_NULL_HANDLE, table_pressed_ = XR_NULL_HANDLE;
    XrAction head_up_ = XR_NULL_HANDLE, head_down_ = XR_NULL_HANDLE, enhanced_ = XR_NULL_HANDLE;
};

}  // namespace eti::hmd
