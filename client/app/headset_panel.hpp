// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <span>
#include <vector>

#include "client/app/laser_pointer.hpp"
#include "client/app/session_panel.hpp"
#include "client/render/render_target.hpp"

namespace eti::client {

/// The instructor's panel in a headset: a sheet beside the patient, which hands point at.
class HeadsetPanel {
  public:
    using Time = SessionPanel::Time;

    /// Of its picture [pixels]: letters of 20 pixels.
    static constexpr int width = 540, height = 640;
    /// Where it hangs: 40 deg to the right and 0.9 m away, beside the readout and the patient. Its letters
    /// are 20 mm high there, 1.3 deg.
    [[nodiscard]] static hmd::Panel place();

    /// `commands`: null for an observer. All have to outlive it.
    HeadsetPanel(bus::Node& node, bus::CommandSender* commands, bool shown);

    void toggle() { shown_ = !shown_; }
    [[nodiscard]] bool shown() const { return shown_; }
    /// Takes from `hands` what is the panel's.
    void point(hmd::HandInput& hands);
    /// Takes in what the server says, and sends what was asked for.
    void follow(const view::SceneView& scene, const SessionInput& input,
                std::span<const bus::Refusal> refusals, Time now) {
        session_.follow(scene, input, refusals, now);
    }
    /// Lines from hands to what they point at, in the world.
    [[nodiscard]] const std::vector<LaserPointer::Ray>& rays() const { return laser_.rays(); }
    /// Its picture, drawn anew.
    const render::RenderTarget& draw(Time now);

  private:
    SessionPanel session_;
    render::RenderTarget picture_{width, height, 1};
    panel::Drawing drawing_;
    LaserPointer laser_;
    bool shown_;
};

}  // namespace eti::client
