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
#include "client/app/window.hpp"
#include "client/hands/hands_link.hpp"

namespace eti::client {

/// Mouse and keys and what they do to the hands, for help on the screen and on the command line.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> hand_controls_help();

/// Two hands at a window: what of mouse and keys is theirs, and what the screen says of them. With the shift
/// key down the mouse moves what one looks from, as it does without hands.
class HandControls {
  public:
    /// `play`: a list that moves them instead; empty: none. Throws InputError.
    HandControls(bus::Node& node, const std::filesystem::path& play, bool tutorial);

    /// True: taken.
    bool key(const KeyEvent& event);
    bool drag(const Drag& mouse, const Controls& controls, const view::SceneView& scene, int width,
              int height);

    /// Sees what there is to be seen; `shown`: in the window. True: another lesson begins.
    bool look(const view::SceneView& scene, const Selection& shown);
    /// The lesson's place, from 1; 0 without a tutorial.
    [[nodiscard]] std::size_t lesson() const { return tutorial_ ? tutorial_->lesson() + 1 : 0; }
    /// What the list that is played looks at; else what is chosen.
    [[nodiscard]] const Selection& shown(const Selection& chosen) const;
    void put_into(hud::Readout& readout) const;
    /// All keys of the window but those that move what one looks from: together they would not fit.
    [[nodiscard]] static std::vector<std::pair<std::string, std::string>> help();
    [[nodiscard]] nlohmann::json report() const;

  private:
    bool played_;
    std::optional<Tutorial> tutorial_;
    HandsLink link_;
};

}  // namespace eti::client
