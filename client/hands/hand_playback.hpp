// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "client/hands/hands.hpp"
#include "client/render/views/view_table.hpp"
#include "client/view/scene_view.hpp"

namespace eti::hands {

/// Mouse and key input over a period of time.
struct PlaybackStep {
    const render::View* view = nullptr;  ///< view to show from now on; null: unchanged
    bool selects_hand = false;           ///< switches to `hand`
    Tool hand = Tool::laryngoscope;
    Drag mouse;             ///< total displacement, spread evenly over the step
    char32_t hold = U'\0';  ///< a hand key to hold
    float duration = 0.0f;  ///< [s], simulation time
    // The step ends early once all thresholds that are set are reached.
    float until_view_percent = -1.0f;
    float until_tube_depth = -1.0f;  ///< [m] past the glottis
};

/// Plays a list of mouse and key input in simulation time, for demonstrations and tests.
class HandPlayback {
  public:
    /// Reads and validates a list. Throws InputError.
    [[nodiscard]] static HandPlayback load(const std::filesystem::path& file);
    [[nodiscard]] static HandPlayback parse(const std::string& text, const std::string& file);

    /// Applies the input due within `dt` [s]; `seen`: the current session.
    void advance(float dt, Hands& hands, const view::SceneView& seen, const render::Vantage& vantage);

    [[nodiscard]] bool finished() const { return step_ == steps_.size(); }
    /// The view to show; null before the first step names one.
    [[nodiscard]] const render::View* view() const { return view_; }
    [[nodiscard]] std::size_t step() const { return step_; }

  private:
    std::vector<PlaybackStep> steps_;
    float height_ = 540.0f;  // [pixels], of the picture in which the mouse moves
    std::size_t step_ = 0;
    bool step_started_ = false;
    float elapsed_ = 0.0f;  // [s], in the current step
    const render::View* view_ = nullptr;
};

}  // namespace eti::hands
