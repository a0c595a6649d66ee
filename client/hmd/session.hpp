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
#include "client/hmd/panel.hpp"
#include "client/hmd/runtime.hpp"

namespace eti::hmd {

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
    /// Of a panel's picture [pixels].
    struct PanelSize {
        int width, height;
    };

    /// Throws CallFailed.
    Session(const Runtime& runtime, const Headset& headset, const Graphics& graphics,
            std::span<const PanelSize> panels);

    /// Takes in what the runtime says, and does what that obliges to.
    void poll();
    /// Begins to leave; life() tells when that is done.
    void leave();
    [[nodiscard]] const LifeCycle& life() const { return life_; }

    /// Waits until it is time to draw the next frame. Only while life().running().
    [[nodiscard]] std::optional<Frame> wait_frame();
    /// Nothing while the headset does not know where it is.
    [[nodiscard]] std::optional<Eyes> eyes(const Frame& frame);
    [[nodiscard]] HandInput hands(const Frame& frame);
    /// What the next end_frame() shows: both eyes side by side, left first, and the first of the panels.
    void draw(const render::RenderTarget& both, std::span<const render::RenderTarget* const> panels);
    /// Ends the frame with what was drawn for these eyes; nothing: with an empty picture. Where the panels
    /// that were drawn hang.
    void end_frame(const Frame& frame, const std::optional<Eyes>& seen_by, std::span<const Panel> panels);

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
    std::vector<std::unique_ptr<PanelImage>> panel_images_;
    unsigned recentred_ = 0;
};

}  // namespace eti::hmd
