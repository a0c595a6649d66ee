// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <vector>

#include "client/app/headset/laser_pointer.hpp"
#include "client/render/gl/render_target.hpp"

namespace eti::client {

/// The instructor's panel in a headset: a quad beside the patient, operated with laser pointers.
class HeadsetPanel {
  public:
    using Time = panel::Model::Time;

    /// Size of the panel's picture [pixels]; letters are 20 pixels high.
    static constexpr int width = 540, height = 640;
    /// Pose of the panel: 40 deg to the right and 0.9 m away, beside the readout and the patient. Its
    /// letters are 20 mm high there, 1.3 deg.
    [[nodiscard]] static hmd::Quad place();

    /// `model` must outlive the panel.
    HeadsetPanel(panel::Model& model, bool shown) : model_(model), shown_(shown) {}

    void toggle() { shown_ = !shown_; }
    [[nodiscard]] bool shown() const { return shown_; }
    /// Takes the panel's input from `hands`.
    void point(hmd::HandInput& hands);
    /// Rays from the hands to their targets, world frame.
    [[nodiscard]] const std::vector<LaserRay>& rays() const { return laser_.rays(); }
    /// Redraws and returns the panel's picture.
    const render::RenderTarget& draw(Time now);

  private:
    panel::Model& model_;
    render::RenderTarget picture_{width, height, 1};
    panel::PanelRenderer drawing_;
    LaserPointer laser_;
    bool shown_;
};

}  // namespace eti::client
