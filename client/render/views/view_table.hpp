// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "client/render/lighting.hpp"
#include "client/render/passes/tone_pass.hpp"
#include "client/render/views/camera.hpp"
#include "client/render/views/vantage.hpp"
#include "client/view/scene_view.hpp"

namespace eti::render {

/// Draw passes of a view, in the order of its row.
enum class Pass : std::uint8_t {
    room_shadow,  ///< light 0 casts shadows
    lamp_shadow,  ///< light 1, the laryngoscope's lamp, casts shadows
    caps,         ///< section faces; drawn before the patient, whom they largely occlude
    patient,
    hands,  ///< on the tools; before the patient, many of whose pixels they hide
    room,   ///< bedding, furniture and monitor
    tools,
    liquid,
    glottis,       ///< tinted glottic opening, if the session requests it
    hidden_tools,  ///< occluded parts of the tools, shown through
    annotations,   ///< marks of instructors and observers
};

/// Overlays that the enhanced view adds to a view.
enum class Overlay : std::uint8_t {
    gum_force,      ///< a mark where the upper gum is under load
    sight_dot,      ///< end of the line of sight from the eye to the glottis
    line_of_sight,  ///< the line of sight itself, too
    axes,           ///< of mouth, pharynx and larynx
};

/// Whether a view is shown by default.
enum class AutoShow : std::uint8_t {
    alone,  ///< only on its own, not among all views
    never,
    always,
    enhanced,  ///< while the session requests the enhanced view
};

/// What the mouse moves in a view.
enum class MouseTarget : std::uint8_t { onlooker, eye, section };

/// One row of the table of views. Options, keys, layout, pictures, timing and the renderer all iterate over
/// the table, so that a view is added in one place.
struct View {
    std::string_view name;  ///< on the command line, in file names and in pictures
    char key;               ///< key that shows it in a window
    std::string_view help;
    /// One camera, or one per eye, drawn side by side.
    std::vector<Camera> (*cameras)(const view::SceneView& scene, const Vantage& from);
    /// `lamp`: the laryngoscope's, if present.
    Lighting (*lighting)(const Camera& camera, const std::optional<Light>& lamp);
    std::vector<Pass> passes;
    std::vector<Overlay> overlays = {Overlay::gum_force, Overlay::sight_dot};
    Vec3f background = Vec3f::Zero();  ///< linear
    ToneMapping tone = {};
    AutoShow auto_show = AutoShow::never;
    MouseTarget mouse_target = MouseTarget::eye;
    bool lips_retracted = false;  ///< the trainee's fingers retract the lips, see LipRetraction
    bool cut = false;             ///< cut along the vantage's section plane
    bool near_only = false;       ///< without the room at a quality that has no walls
    bool loupe = false;           ///< through the vantage's loupe
    bool lens = false;            ///< seen through a lens in the mouth, which can fog

    [[nodiscard]] bool has(Pass pass) const;
    [[nodiscard]] bool has(Overlay overlay) const;
    /// The only camera, or the left eye's.
    [[nodiscard]] Camera camera(const view::SceneView& scene, const Vantage& from) const;
};

/// All views; in a picture of several the first is the largest.
[[nodiscard]] std::span<const View> views();

/// A headset's view, from the vantage's headset eyes. Not in the table: it is drawn only with a headset.
[[nodiscard]] const View& headset_view();

/// The row of a name, or nullptr.
[[nodiscard]] const View* view_named(std::string_view name);

}  // namespace eti::render
