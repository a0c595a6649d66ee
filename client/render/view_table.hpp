// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "client/render/lighting.hpp"
#include "client/render/vantage.hpp"
#include "client/view/scene_view.hpp"

namespace eti::render {

/// How the patient's surfaces are shaded.
enum class Skin : std::uint8_t {
    plain,
    shadowed,    ///< light 0 throws shadows
    lips_aside,  ///< fingers hold the lips aside for the eye that looks, see LipRetraction
};

/// Whether a view is shown where nothing was asked for.
enum class Automatic : std::uint8_t {
    never,
    always,
    enhanced,  ///< while the session asks for the enhanced view
};

/// What a mouse moves in a view's picture.
enum class Moves : std::uint8_t { nothing, onlooker, eye };

/// One row of the table of views. Options, keys, layout, pictures, timing and the renderer all walk it, so
/// that a view is added in one place.
struct View {
    std::string_view name;  ///< on the command line, in file names and in pictures
    char key;               ///< that shows it in a window
    std::string_view help;
    Camera (*camera)(const view::SceneView& scene, const Vantage& from);
    /// `lamp`: the laryngoscope's, where there is one.
    Lighting (*lighting)(const Camera& camera, const std::optional<Light>& lamp);
    Vec3f background;  ///< linear
    Automatic automatic = Automatic::never;
    Moves moves = Moves::nothing;
    Skin skin = Skin::plain;
    bool cut = false;       ///< opened along the mid-sagittal plane, with the faces of the cut
    bool vignette = false;  ///< darker towards the edges, as through a mouth
};

/// Every view; the first takes the larger part of a picture with several.
[[nodiscard]] std::span<const View> views();

/// The row of a name, or nullptr.
[[nodiscard]] const View* view_named(std::string_view name);

}  // namespace eti::render
