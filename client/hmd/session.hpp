// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "client/hmd/actions.hpp"
#include "client/hmd/eye_images.hpp"
#include "client/hmd/life_cycle.hpp"
#include "client/hmd/quad.hpp"
#include "client/hmd/runtime.hpp"

namespace eti::hmd {

/// Predicted state of an eye at display time, world frame.
struct Eye {
    RigidTransform pose;
    render::FieldOfView field;
};
using Eyes = std::array<Eye, 2>;  ///< left first

/// A frame requested by the runtime.
struct Frame {
    XrTime display_time = 0;     ///< predicted display time
    bool should_render = false;  ///< the frame will be visible
};

/// The program's OpenXR session with a headset, from its creation to its loss or end. All calls must come
/// from the thread whose OpenGL context is `graphics`. Unrecoverable errors end the session; see life().
class Session {
  public:
    /// Size of a panel's picture [pixels].
    struct QuadSize {
        int width, height;
    };

    /// Throws OpenXrError.
    Session(const Runtime& runtime, const Headset& headset, const Graphics& graphics,
            std::span<const QuadSize> panels);

    /// Processes the runtime's events and makes the calls that they require.
    void poll();
    /// Starts leaving the session; life() reports when it has ended.
    void leave();
    [[nodiscard]] const LifeCycle& life() const { return life_; }

    /// Waits until the next frame is due. Only while life().running().
    [[nodiscard]] std::optional<Frame> wait_frame();
    /// nullopt while the headset is not tracked.
    [[nodiscard]] std::optional<Eyes> eyes(const Frame& frame);
    [[nodiscard]] HandInput hands(const Frame& frame);
    /// Sets the images for the next end_frame(): both eyes side by side, left first, and the pictures of
    /// the first panels.
    void draw(const render::RenderTarget& both, std::span<const render::RenderTarget* const> panels);
    /// Ends the frame with the images drawn for these eyes; nullopt: with an empty frame. `panels`: poses
    /// of the panels that were drawn.
    void end_frame(const Frame& frame, const std::optional<Eyes>& seen_by, std::span<const Quad> panels);

    /// Number of times the user has recentred the headset.
    [[nodiscard]] unsigned recentred() const { return recentred_; }
    [[nodiscard]] bool layered() const { return eye_images_->layered(); }

  private:
    template <class Call>
    auto guarded(Call call) -> decltype(call());
    void on_state(const XrEventDataSessionStateChanged& event);

    const Runtime& runtime_;
    LifeCycle life_;
    UniqueHandle<XrSession, xrDestroySession> session_;
    UniqueHandle<XrSpace, xrDestroySpace> world_;
    std::optional<Actions> actions_;
    std::optional<EyeImages> eye_images_;
    std::vector<std::unique_ptr<QuadImage>> panel_images_;
    unsigned recentred_ = 0;
};

}  // namespace eti::hmd
