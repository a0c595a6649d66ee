// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/views/view_table.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "client/text/catalogue.hpp"

namespace eti::render {
namespace {

constexpr float between_eyes = 63e-3f;  // [m], interpupillary distance of an adult

using Cameras = std::vector<Camera>;

Cameras from_above(const view::SceneView& scene, const Vantage& from) {
    const float table_angle = scene.live().table_angle;
    return {overview_camera(scene.landmarks(), from.orbit, std::isfinite(table_angle) ? table_angle : 0.0f)};
}

Cameras on_the_blade(const view::SceneView& scene, const Vantage& from) {
    if (scene.laryngoscope_pose() && scene.keys()) {
        return {blade_camera(*scene.laryngoscope_pose(), scene.keys()->laryngoscope())};
    }
    // No laryngoscope yet.
    return {close_up_camera(from.eye, scene.landmarks())};
}

Cameras onto_the_cut(const view::SceneView& scene, const Vantage& from) {
    return {section_camera(from.section, scene.rest_landmarks(), scene.landmarks())};
}

Cameras from_the_eye(const view::SceneView& scene, const Vantage& from) {
    return {eye_camera(from.eye, scene.landmarks(), from.loupe.magnification)};
}

// Parallel axes, so that stereo pictures need only a lens correction.
Cameras from_both_eyes(const view::SceneView& scene, const Vantage& from) {
    Camera left = from_the_eye(scene, from).front(), right = left;
    const Vec3f aside = 0.5f * between_eyes * left.view().block<1, 3>(0, 0).transpose();
    for (const auto& [eye, shift] : {std::pair{&left, Vec3f(-aside)}, std::pair{&right, aside}}) {
        eye->eye += shift;
        eye->target += shift;
    }
    return {left, right};
}

constexpr float wheel_factor = 1.15f;  // for a notch: five notches double it
constexpr float least_worn = 1.5f;     // weaker loupes would look like none

const std::vector<Pass> of_a_mouth{Pass::lamp_shadow, Pass::hands,  Pass::patient, Pass::room,
                                   Pass::tools,       Pass::liquid, Pass::glottis, Pass::annotations};

const std::array table{
    View{.name = text::translatable("eye"),
         .key = '5',
         .help = text::translatable("the view from the trainee's eye"),
         .cameras = from_the_eye,
         .lighting = laryngoscope_lighting,
         .passes = of_a_mouth,
         .background = Vec3f(0.016f, 0.022f, 0.028f),
         .auto_show = AutoShow::always,
         .mouse_target = MouseTarget::eye,
         .lips_retracted = true,
         .loupe = true},
    View{.name = text::translatable("laryngoscope"),
         .key = '3',
         .help = text::translatable("video laryngoscope: a camera on the blade"),
         .cameras = on_the_blade,
         .lighting = laryngoscope_lighting,
         .passes = of_a_mouth,
         .overlays = {Overlay::sight_dot},  // the gum is behind the lens
         .tone = {.metered = 0.28f, .vignette = 1.0f},
         .auto_show = AutoShow::always,
         .mouse_target = MouseTarget::eye,
         .lips_retracted = true,
         .near_only = true,
         .lens = true},
    View{.name = text::translatable("overview"),
         .key = '1',
         .help = text::translatable("head and hands from outside"),
         .cameras = from_above,
         .lighting = overview_lighting,
         // An observer sees little of the lamp's light through the mouth, with or without lips.
         .passes = {Pass::room_shadow, Pass::hands, Pass::patient, Pass::room, Pass::tools, Pass::liquid,
                    Pass::annotations},
         .overlays = {Overlay::gum_force, Overlay::line_of_sight},
         .background = Vec3f(0.11f, 0.12f, 0.125f),
         .auto_show = AutoShow::always,
         .mouse_target = MouseTarget::onlooker},
    View{.name = text::translatable("section"),
         .key = '2',
         .help = text::translatable("section in the midline or any other plane"),
         .cameras = onto_the_cut,
         .lighting = section_lighting,
         .passes = {Pass::caps, Pass::patient, Pass::tools, Pass::liquid, Pass::hidden_tools,
                    Pass::annotations},
         .overlays = {Overlay::gum_force, Overlay::line_of_sight, Overlay::axes},
         .background = Vec3f(0.016f, 0.022f, 0.028f),
         .auto_show = AutoShow::enhanced,
         .mouse_target = MouseTarget::section,
         .cut = true},
    View{.name = text::translatable("stereo"),
         .key = '6',
         .help = text::translatable("both of the trainee's eyes, side by side"),
         .cameras = from_both_eyes,
         .lighting = laryngoscope_lighting,
         .passes = of_a_mouth,
         .overlays = {},  // they would need a depth
         .background = Vec3f(0.016f, 0.022f, 0.028f),
         .auto_show = AutoShow::alone,
         .mouse_target = MouseTarget::eye,
         .lips_retracted = true,
         .near_only = true,
         .loupe = true},
};

}  // namespace

const View& headset_view() {
    // The whole patient in front of the trainee, with one room lamp for both eyes.
    static const View view{
        .name = text::translatable("hmd"),
        .key = '\0',
        .help = text::translatable("the trainee's headset"),
        .cameras = [](const view::SceneView&, const Vantage& from) { return from.headset_eyes; },
        .lighting = headset_lighting,
        .passes = {Pass::lamp_shadow, Pass::hands, Pass::patient, Pass::room, Pass::tools, Pass::liquid,
                   Pass::glottis, Pass::annotations},
        .overlays = {Overlay::gum_force, Overlay::sight_dot, Overlay::axes},
        .background = Vec3f(0.11f, 0.12f, 0.125f),
        .auto_show = AutoShow::alone,
        .mouse_target = MouseTarget::eye,
        .lips_retracted = true};
    return view;
}

void Loupe::toggle() {
    if (on()) {
        worn_ = magnification;
    }
    magnification = on() ? 1.0f : worn_;
}

void Loupe::turn_wheel(float notches) {
    if (on()) {
        magnification =
            std::clamp(magnification * std::pow(wheel_factor, notches), least_worn, max_magnification);
    }
}

bool View::has(Pass pass) const {
    return std::ranges::find(passes, pass) != passes.end();
}

bool View::has(Overlay overlay) const {
    return std::ranges::find(overlays, overlay) != overlays.end();
}

Camera View::camera(const view::SceneView& scene, const Vantage& from) const {
    return cameras(scene, from).front();
}

std::span<const View> views() {
    return table;
}

const View* view_named(std::string_view name) {
    const auto found = std::ranges::find(table, name, &View::name);
    return found == table.end() ? nullptr : &*found;
}

}  // namespace eti::render
