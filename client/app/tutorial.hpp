// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "client/app/special_keys.hpp"
#include "client/hands/hands_link.hpp"
#include "client/hud/readout.hpp"
#include "client/view/scene_view.hpp"

namespace eti::client {

/// What a lesson is judged by.
struct LessonSight {
    const view::SceneView& scene;
    std::string_view view;  ///< of the window
};

/// One of the steps that lead a first intubation.
struct Lesson {
    std::string_view title;
    std::string_view text;                   ///< what to do, and with which keys
    bool (*done)(const LessonSight& sight);  ///< by the session's numbers
};

[[nodiscard]] std::span<const Lesson> lessons();

/// Enter passes over a lesson.
inline constexpr char32_t skip_key = key_enter;

/// Leads through a first intubation: shows a lesson until the session says that it is done. After an attempt
/// that failed it begins again with the blade.
class Tutorial {
  public:
    void look(const LessonSight& sight);
    void skip();

    [[nodiscard]] bool finished() const { return lesson_ == lessons().size(); }
    [[nodiscard]] std::size_t lesson() const { return lesson_; }
    void put_into(hud::Readout& readout) const;

  private:
    std::size_t lesson_ = 0;
    std::uint32_t attempts_judged_ = 0;
    std::string failed_;  ///< why the last attempt did
};

/// Whether somebody has been led here before: by a file of the user's settings, as XDG's Base Directory
/// Specification places it.
[[nodiscard]] bool tutorial_was_shown();
/// Says so from now on; where the file cannot be written it will be shown again.
void note_tutorial_shown();
[[nodiscard]] std::filesystem::path tutorial_mark();

}  // namespace eti::client
