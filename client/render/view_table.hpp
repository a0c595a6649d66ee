// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "client/render/camera.hpp"
#include "client/render/lighting.hpp"
#include "client/render/tone_pass.hpp"
#include "client/render/vantage.hpp"
#include "client/view/scene_view.hpp"

namespace eti::render {

/// What a view draws, in the order of its row.
enum class Pass : std::uint8_t {
    room_shadow,  ///< light 0 throws shadows
    lamp_shadow,  ///< light 1, the laryngoscope's, throws shadows
    caps,         ///< faces of the cut; before the patient, whom they hide in good part
    patient,
    table,  ///< beneath the patient
    tools,
    liquid,
    glottis,       ///< its opening, tinted, where the session asks for it
    hidden_tools,  ///< what of the tools lies behind what was drawn, shining through
    annotations,   ///< what instructors and observers point at and draw
};

/// What the enhanced view draws over a view.
enum class Overlay : std::uint8_t {
    gum_force,      ///< a mark where the upper gum is pressed
    sight_dot,      ///< where the look from the eye onto the glottis ends
    line_of_sight,  ///< the look itself, too
    axes,           ///< of mouth, throat and larynx
};

/// Whether a view is shown where nothing was asked for.
enum class Automatic : std::uint8_t {
    alone,  ///< only by itself, not even among all
    never,
    always,
    enhanced,  ///< while the session asks for the enhanced view
};

/// What a mouse moves in a view's picture.
enum class Moves : std::uint8_t { onlooker, eye, section };

/// One row of the table of views. Options, keys, layout, pictures, timing and the renderer all walk it, so
/// that a view is added in one place.
struct View {
    std::string_view name;  ///< on the command line, in file names and in pictures
    char key;               ///< that shows it in a window
    std::string_view help;
    /// One, or one for each eye; they then stand side by side.
    std::vector<Camera> (*cameras)(const view::SceneView& scene, const Vantage& from);
    /// `lamp`: the laryngoscope's, where there is one.
    Lighting (*lighting)(const Camera& camera, const std::optional<Light>& lamp);
    std::vector<Pass> passes;
    std::vector<Overlay> overlays = {Overlay::gum_force, Overlay::sight_dot};
    Vec3f background = Vec3f::Zero();  ///< linear
    ToneMapping tone = {};
    Automatic automatic = Automatic::never;
    Moves moves = Moves::eye;
    bool lips_aside = false;  ///< fingers hold the lips aside for the trainee, see LipRetraction
    bool cut = false;         ///< opened along the vantage's section
    bool lens = false;        ///< seen through a lens in the mouth, which fogs

    [[nodiscard]] bool has(Pass pass) const;
    [[nodiscard]] bool has(Overlay overlay) const;
    /// The only camera, or the left eye's.
    [[nodiscard]] Camera camera(const view::SceneView& scene, const Vantage& from) const;
};

/// Every view; the first takes the larger part of a picture with several.
[[nodiscard]] std::span<const View> views();

/// What a headset shows, from the vantage's worn eyes. Not in the table: without a headset nothing draws it.
[[nodiscard]] const View& headset_view();

/// The row of a name, or nullptr.
[[nodiscard]] const View* view_named(std::string_view name);

}  // namespace eti::render
