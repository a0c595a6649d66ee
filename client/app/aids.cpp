// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/app/aids.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "client/render/annotation_pass.hpp"
#include "client/view/airway_axes.hpp"
#include "common/math/units.hpp"

namespace eti::client {
namespace {

/// Where points of the scene lie in a picture.
class Projection {
  public:
    Projection(const render::Camera& camera, const hud::Tile& tile)
        : matrix_(camera.projection(static_cast<float>(tile.width) / static_cast<float>(tile.height)) *
                  camera.view()),
          corner_(static_cast<float>(tile.x), static_cast<float>(tile.y)),
          half_(0.5f * static_cast<float>(tile.width), 0.5f * static_cast<float>(tile.height)) {}

    /// Pixels from the picture's upper left; nothing for what lies behind the camera.
    [[nodiscard]] std::optional<Eigen::Vector2f> pixel(const Vec3f& point) const {
        const Eigen::Vector4f clip = matrix_ * point.homogeneous();
        return clip.w() > 0.0f ? std::optional(pixel_of(clip)) : std::nullopt;
    }
    /// Both ends of what of a line lies before the camera.
    [[nodiscard]] std::optional<std::pair<Eigen::Vector2f, Eigen::Vector2f>> line(const Vec3f& from,
                                                                                  const Vec3f& to) const {
        constexpr float nearest = 1e-2f;  // [m]; nearer ones would lie far outside
        Eigen::Vector4f a = matrix_ * from.homogeneous(), b = matrix_ * to.homogeneous();
        if (a.w() < nearest && b.w() < nearest) {
            return std::nullopt;
        }
        const Eigen::Vector4f cut = a + (nearest - a.w()) / (b.w() - a.w()) * (b - a);
        a = a.w() < nearest ? cut : a;
        b = b.w() < nearest ? cut : b;
        return std::pair(pixel_of(a), pixel_of(b));
    }

  private:
    [[nodiscard]] Eigen::Vector2f pixel_of(const Eigen::Vector4f& clip) const {
        const Eigen::Vector2f place(1.0f + clip.x() / clip.w(), 1.0f - clip.y() / clip.w());
        return corner_ + place.cwiseProduct(half_);
    }

    Eigen::Matrix4f matrix_;
    Eigen::Vector2f corner_, half_;
};

void add(std::vector<hud::Mark>& marks, const Projection& projection, const Vec3f& from, const Vec3f& to,
         hud::Level level, std::string text = {}, bool text_left = false) {
    const auto a = projection.pixel(from), b = projection.pixel(to);
    if (a && b) {
        marks.push_back({*a, *b, level, std::move(text), text_left});
    }
}

void add_sight(std::vector<hud::Mark>& marks, const Projection& projection, const view::Look& look,
               bool whole) {
    const auto& [sight, met] = look;
    if (whole) {
        add(marks, projection, sight.from, met ? met->where : sight.to, hud::Level::good);
    }
    if (met) {
        if (whole) {
            add(marks, projection, met->where, sight.to, hud::Level::bad);
        }
        add(marks, projection, met->where, met->where, hud::Level::bad, std::string(met->name));
    } else {
        add(marks, projection, sight.to, sight.to, hud::Level::good, "glottis in sight");
    }
}

// What was written beside points; the points themselves lie in the scene.
void add_words(std::vector<hud::Mark>& marks, const Projection& projection, const render::View& view,
               const view::SceneView& scene, const render::Vantage& from) {
    for (const render::DrawnMark& mark : render::drawn_marks(view, scene, from)) {
        if (const auto pixel = projection.pixel(mark.points.front());
            pixel && !mark.annotation->text.empty()) {
            marks.push_back({*pixel, *pixel, hud::Level::neutral, mark.annotation->text, false, true});
        }
    }
}

void add_axes(std::vector<hud::Mark>& marks, const Projection& projection, const view::SceneView& scene) {
    const view::AirwayAxes axes = view::airway_axes(scene.landmarks(), scene.live().head_elevation);
    const auto degrees = [](float angle) { return static_cast<double>(angle / degree); };
    // The angle to the axis before stands beside each but the first.
    const std::array texts{std::string(axes.axes[0].name),
                           fmt::format("{}, {:.0f} deg", axes.axes[1].name, degrees(axes.mouth_to_throat)),
                           fmt::format("{}, {:.0f} deg", axes.axes[2].name, degrees(axes.throat_to_larynx))};
    for (std::size_t i = 0; i < texts.size(); ++i) {
        // A worn eye may have come nearer than an axis reaches.
        if (const auto line = projection.line(axes.axes[i].from, axes.axes[i].to)) {
            marks.push_back({line->first, line->second, hud::Level::neutral, texts[i]});
        }
    }
}

bool shows_look(const render::View& view) {
    return view.has(render::Overlay::line_of_sight) || view.has(render::Overlay::sight_dot);
}

}  // namespace

std::optional<view::Look> look_for(const std::vector<const render::View*>& views,
                                   const view::SceneView& scene, const render::Vantage& from) {
    const bool shown = scene.metrics() && scene.shows(&LiveValues::view_sight_line) &&
                       std::ranges::any_of(views, [](const render::View* view) { return shows_look(*view); });
    return shown ? std::optional(view::look_of(scene, from.eye)) : std::nullopt;
}

std::optional<hud::Mark> line_of(const Vec3f& from, const Vec3f& to, const render::Camera& camera,
                                 const hud::Tile& tile) {
    const auto line = Projection(camera, tile).line(from, to);
    return line ? std::optional(hud::Mark{line->first, line->second, hud::Level::neutral, {}}) : std::nullopt;
}

std::vector<hud::Mark> aids_of(const render::View& view, const render::Camera& camera,
                               const view::SceneView& scene, const render::Vantage& from,
                               const std::optional<view::Look>& look, const hud::Tile& tile) {
    using render::Overlay;
    std::vector<hud::Mark> marks;
    if (!scene.metrics()) {
        return marks;
    }
    const Projection projection(camera, tile);
    if (view.has(Overlay::axes) && scene.shows(&LiveValues::view_axes)) {
        add_axes(marks, projection, scene);
    }
    if (look && shows_look(view)) {
        add_sight(marks, projection, *look, view.has(Overlay::line_of_sight));
    }
    if (view.has(render::Pass::annotations)) {
        add_words(marks, projection, view, scene, from);
    }
    if (view.has(Overlay::gum_force) && scene.shows(&LiveValues::view_gum_force)) {
        const Vec3f gum = scene.gum_contact().value_or(at(scene.landmarks(), Landmark::upper_gum));
        const float force = scene.metrics()->gum_force_n();
        // The name of the dot, which is often near, stands at the right.
        add(marks, projection, gum, gum, hud::gum_force_level(force), fmt::format("{:.1f} N", force), true);
    }
    return marks;
}

}  // namespace eti::client
