// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "client/hands/hands.hpp"
#include "client/render/view_table.hpp"
#include "client/view/scene_view.hpp"

namespace eti::client {

/// What somebody does with mouse and keys for a while.
struct PlayStep {
    std::string name;
    const render::View* view = nullptr;  ///< to be looked at from now on; null: as before
    bool takes_hand = false;             ///< `hand` takes over
    Tool hand = Tool::laryngoscope;
    Drag mouse;             ///< in all, spread evenly
    char32_t hold = U'\0';  ///< a key of the hands
    float over = 0.0f;      ///< [s], of simulation time
    // Ends earlier where these are reached, all of those set.
    float until_view_percent = -1.0f;
    float until_tube_depth = -1.0f;  ///< [m] past the glottis
};

/// Plays a list of what mouse and keys do, in simulation time: a demonstration, and what tests the hands by.
class HandPlay {
  public:
    /// Reads and validates a list. Throws InputError.
    [[nodiscard]] static HandPlay load(const std::filesystem::path& file);
    [[nodiscard]] static HandPlay parse(const std::string& text, const std::string& file);

    /// Does what is due within `dt` [s]; `seen`: the session as it is.
    void advance(float dt, Hands& hands, const view::SceneView& seen, const render::Vantage& vantage);

    [[nodiscard]] bool finished() const { return step_ == steps_.size(); }
    /// Of the step that goes on; empty at the end.
    [[nodiscard]] const std::string& step_name() const;
    /// What is looked at; null before the first step names a view.
    [[nodiscard]] const render::View* view() const { return view_; }
    [[nodiscard]] std::size_t step() const { return step_; }

  private:
    std::vector<PlayStep> steps_;
    float height_ = 540.0f;  // [pixels], of the picture that the mouse moves in
    std::size_t step_ = 0;
    bool begun_ = false;
    float passed_ = 0.0f;  // [s], of the step
    const render::View* view_ = nullptr;
};

}  // namespace eti::client
