// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include "client/app/window/compositor.hpp"
#include "client/render/image.hpp"
#include "client/view/scene_view.hpp"

namespace eti::client {

/// Creates the folder and checks that it is writable. Throws std::runtime_error naming folder, cause and
/// remedy.
void prepare_folder(const std::filesystem::path& folder);

/// "laryngoscope_012.345s.png"; with an occasion "laryngoscope_best_012.345s.png".
[[nodiscard]] std::string picture_name(std::string_view view, std::string_view occasion, double time_s);

/// Keeps a copy of the scene at the best glottic view so far.
class BestView {
  public:
    /// Copies the scene (sharing its rest shapes) when the view exceeds the previous best by half a per
    /// cent.
    void consider(const view::SceneView& scene);
    [[nodiscard]] const std::optional<view::SceneView>& scene() const { return scene_; }
    [[nodiscard]] float percent() const { return percent_; }

  private:
    float percent_ = 0.0f;
    std::optional<view::SceneView> scene_;
};

/// Draws pictures of single views, and of several side by side if so selected, into a folder.
class PictureWriter {
  public:
    explicit PictureWriter(std::filesystem::path folder) : folder_(std::move(folder)) {}

    /// Calls `between` before each picture, which takes a software rasteriser seconds. Throws
    /// std::runtime_error when a picture cannot be written.
    void take(Compositor& compositor, const Selection& selection, const view::SceneView& scene,
              const hud::Readout& readout, const render::Vantage& from, std::string_view occasion,
              const std::function<void()>& between);
    [[nodiscard]] const std::vector<std::filesystem::path>& files() const { return files_; }

  private:
    std::filesystem::path folder_;
    std::vector<std::filesystem::path> files_;
};

}  // namespace eti::client
