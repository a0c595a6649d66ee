// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <optional>

#include "client/hmd/actions.hpp"
#include "client/hmd/eye_images.hpp"
#include "client/hmd/life_cycle.hpp"
#include "client/hmd/runtime.hpp"

namespace eti::hmd {

/// A flat sheet in the room, of one colour picture: where it hangs in the world and how wide it is [m].
struct Panel {
    RigidTransform pose;
    float width = 0.0f, height = 0.0f;
};

/// An eye as it will be when the frame is seen, in the world.
struct Eye {
    RigidTransform pose;
    render::Field field;
};
using Eyes = std::array<Eye, 2>;  ///< left first

/// A frame that the runtime waits for.
struct Frame {
    XrTime seen_at = 0;   ///< when it will be seen
    bool wanted = false;  ///< somebody will see it
};

/// The program's time with a headset, from its being free to its being lost or left. Everything is called by
/// the thread whose OpenGL context `graphics` is. Calls that the runtime refuses for good end the session;
/// see life().
class Session {
  public:
    /// Throws CallFailed.
    Session(const Runtime& runtime, const Headset& headset, const Graphics& graphics, int panel_width,
            int panel_height);

    /// Takes in what the runtime says, and does what that obliges to.
    void poll();
    /// Begins to leave; life() tells when that is done.
    void leave();
    [[nodiscard]] const LifeCycle& life() const { return life_; }

    /// Waits until it is time to draw the next frame. Only while life().running().
    [[nodiscard]] std::optional<Frame> wait_frame();
    /// Nothing while the headset does not know where it is.
    [[nodiscard]] std::optional<Eyes> eyes(const Frame& frame);
    [[nodiscard]] HandInput hands();
    /// What the next end_frame() shows: both eyes side by side, left first, and the sheet.
    void draw(const render::RenderTarget& both, const render::RenderTarget& panel);
    /// Ends the frame with what was drawn for these eyes; nothing: with an empty picture.
    void end_frame(const Frame& frame, const std::optional<Eyes>& seen_by, const Panel& panel);

    /// How often whoever wears the headset has centred it anew.
    [[nodiscard]] unsigned recentred() const { return recentred_; }
    [[nodiscard]] bool layered() const { return eye_images_->layered(); }

  private:
    template <class Call>
    auto guarded(Call call) -> decltype(call());
    void on_state(const XrEventDataSessionStateChanged& event);

    const Runtime& runtime_;
    LifeCycle life_;
    Owned<XrSession, xrDestroySession> session_;
    Owned<XrSpace, xrDestroySpace> world_;
    std::optional<Actions> actions_;
    std::optional<EyeImages> eye_images_;
    std::optional<PanelImage> panel_image_;
    unsigned recentred_ = 0;
};

}  // namespace eti::hmd
