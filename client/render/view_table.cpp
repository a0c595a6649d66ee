// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/view_table.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace eti::render {
namespace {

Camera from_above(const view::SceneView& scene, const Vantage& from) {
    const float table_angle = scene.live().table_angle;
    return overview_camera(scene.landmarks(), from.orbit, std::isfinite(table_angle) ? table_angle : 0.0f);
}

Camera under_the_blade(const view::SceneView& scene, const Vantage& from) {
    return close_up_camera(from.eye, scene.landmarks());
}

Camera from_the_left(const view::SceneView& scene, const Vantage&) {
    return section_camera(scene.landmarks());
}

Camera from_the_eye(const view::SceneView& scene, const Vantage& from) {
    return eye_camera(from.eye, scene.landmarks());
}

const std::array table{
    View{.name = "laryngoscope",
         .key = '3',
         .help = "under the blade",
         .camera = under_the_blade,
         .lighting = laryngoscope_lighting,
         .background = Vec3f::Zero(),
         .automatic = Automatic::always,
         .moves = Moves::eye,
         .skin = Skin::lips_aside,
         .vignette = true},
    View{.name = "overview",
         .key = '1',
         .help = "head and hands from outside",
         .camera = from_above,
         .lighting = overview_lighting,
         .background = Vec3f(0.035f, 0.065f, 0.075f),
         .automatic = Automatic::always,
         .moves = Moves::onlooker,
         .skin = Skin::shadowed},
    View{.name = "section",
         .key = '2',
         .help = "cut open along the middle",
         .camera = from_the_left,
         .lighting = section_lighting,
         .background = Vec3f(0.016f, 0.022f, 0.028f),
         .automatic = Automatic::enhanced,
         .cut = true},
    View{.name = "eye",
         .key = '5',
         .help = "what the trainee's own eye sees",
         .camera = from_the_eye,
         .lighting = laryngoscope_lighting,
         .background = Vec3f(0.016f, 0.022f, 0.028f),
         .moves = Moves::eye,
         .skin = Skin::lips_aside},
};

}  // namespace

std::span<const View> views() {
    return table;
}

const View* view_named(std::string_view name) {
    const auto found = std::ranges::find(table, name, &View::name);
    return found == table.end() ? nullptr : &*found;
}

}  // namespace eti::render
