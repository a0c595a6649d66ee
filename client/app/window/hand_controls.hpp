// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "client/app/controls.hpp"
#include "client/app/tutorial.hpp"
#include "client/app/window/window.hpp"
#include "client/hands/hands_link.hpp"

namespace eti::client {

/// Mouse and keys and their effects on the hands, for on-screen and command-line help.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> hand_controls_help();

/// Two hands in a window: claims their share of mouse and keys and shows their state. With the shift key
/// down the mouse moves the vantage, as it does without hands.
class HandControls {
  public:
    /// `play`: playback list that moves the hands; empty: none. Throws InputError.
    HandControls(bus::Node& node, const std::filesystem::path& play, bool tutorial);

    /// Returns true if the event was consumed.
    bool key(const KeyEvent& event);
    bool drag(const hands::Drag& mouse, const Controls& controls, const view::SceneView& scene, int width,
              int height);

    /// Updates from the scene; `shown`: the views in the window. Returns true when the next lesson begins.
    bool update(const view::SceneView& scene, const Selection& shown);
    /// Number of the lesson, from 1; 0 without a tutorial.
    [[nodiscard]] std::size_t lesson() const { return tutorial_ ? tutorial_->lesson() + 1 : 0; }
    /// The view chosen by the playback list, otherwise `chosen`.
    [[nodiscard]] const Selection& shown(const Selection& chosen) const;
    void add_to(hud::Readout& readout) const;
    /// All keys of the window except those that move the vantage, which do not fit on the screen.
    [[nodiscard]] static std::vector<std::pair<std::string, std::string>> help();
    [[nodiscard]] nlohmann::json report() const;

  private:
    bool played_;
    std::optional<Tutorial> tutorial_;
    hands::HandsLink link_;
};

}  // namespace eti::client
