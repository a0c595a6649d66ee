// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "client/app/window/special_keys.hpp"
#include "client/hands/hands_link.hpp"
#include "client/hud/readout.hpp"
#include "client/view/scene_view.hpp"

namespace eti::client {

/// Input to a lesson's completion test.
struct LessonState {
    const view::SceneView& scene;
    std::string_view view;  ///< shown in the window
};

/// One lesson of the guided first intubation.
struct Lesson {
    std::string_view title;
    std::string_view text;                   ///< instructions, with the keys to use
    bool (*done)(const LessonState& sight);  ///< completion test on the session's metrics
};

[[nodiscard]] std::span<const Lesson> lessons();

/// Enter skips a lesson.
inline constexpr char32_t skip_key = key_enter;

/// Guides through a first intubation: shows each lesson until the session meets its condition. After a
/// failed attempt it restarts with the blade.
class Tutorial {
  public:
    void update(const LessonState& sight);
    void skip();

    [[nodiscard]] bool finished() const { return lesson_ == lessons().size(); }
    [[nodiscard]] std::size_t lesson() const { return lesson_; }
    void add_to(hud::Readout& readout) const;

  private:
    std::size_t lesson_ = 0;
    std::uint32_t attempts_judged_ = 0;
    std::string failed_;  ///< reason the last attempt failed
};

/// Whether the tutorial has been shown to this user: a marker file in the directory that the XDG Base
/// Directory Specification defines.
[[nodiscard]] bool tutorial_was_shown();
/// Creates the marker file; if that fails, the tutorial is shown again next time.
void mark_tutorial_shown();
[[nodiscard]] std::filesystem::path tutorial_marker_file();

}  // namespace eti::client
