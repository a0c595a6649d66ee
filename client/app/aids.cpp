// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/app/aids.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "client/render/passes/annotation_pass.hpp"
#include "client/text/catalogue.hpp"
#include "client/view/sight/airway_axes.hpp"
#include "common/math/units.hpp"

namespace eti::client {
namespace {

/// Projects points of the scene into a picture.
class Projection {
  public:
    Projection(const render::Camera& camera, const hud::Tile& tile)
        : matrix_(camera.projection(static_cast<float>(tile.width) / static_cast<float>(tile.height)) *
                  camera.view()),
          corner_(static_cast<float>(tile.x), static_cast<float>(tile.y)),
          half_(0.5f * static_cast<float>(tile.width), 0.5f * static_cast<float>(tile.height)) {}

    /// Pixels from the picture's upper left; nullopt behind the camera.
    [[nodiscard]] std::optional<Eigen::Vector2f> pixel(const Vec3f& point) const {
        const Eigen::Vector4f clip = matrix_ * point.homogeneous();
        return clip.w() > 0.0f ? std::optional(pixel_of(clip)) : std::nullopt;
    }
    /// Both ends of the part of a line in front of the camera.
    [[nodiscard]] std::optional<std::pair<Eigen::Vector2f, Eigen::Vector2f>> line(const Vec3f& from,
                                                                                  const Vec3f& to) const {
        constexpr float nearest = 1e-2f;  // [m]; nearer points would project far outside
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

void add_line_of_sight(std::vector<hud::Mark>& marks, const Projection& projection,
                       const view::LineOfSight& look, bool whole) {
    const auto& [sight, met] = look;
    if (whole) {
        add(marks, projection, sight.from, met ? met->position : sight.to, hud::Level::good);
    }
    if (met) {
        if (whole) {
            add(marks, projection, met->position, sight.to, hud::Level::bad);
        }
        add(marks, projection, met->position, met->position, hud::Level::bad,
            std::string(text::translate(met->name)));
    } else {
        add(marks, projection, sight.to, sight.to, hud::Level::good,
            std::string(text::translate("glottis in sight")));
    }
}

// Texts beside points; the points themselves are drawn in the scene.
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
    // Each axis but the first shows its angle to the previous one.
    const std::array texts{
        std::string(text::translate(axes.axes[0].name)),
        fmt::format("{}, {:.0f} deg", text::translate(axes.axes[1].name), degrees(axes.mouth_to_throat)),
        fmt::format("{}, {:.0f} deg", text::translate(axes.axes[2].name), degrees(axes.throat_to_larynx))};
    for (std::size_t i = 0; i < texts.size(); ++i) {
        // A headset's eye may be nearer than the axis extends.
        if (const auto line = projection.line(axes.axes[i].from, axes.axes[i].to)) {
            marks.push_back({line->first, line->second, hud::Level::neutral, texts[i]});
        }
    }
}

bool shows_line_of_sight(const render::View& view) {
    return view.has(render::Overlay::line_of_sight) || view.has(render::Overlay::sight_dot);
}

}  // namespace

std::optional<view::LineOfSight> find_line_of_sight(const std::vector<const render::View*>& views,
                                                    const view::SceneView& scene,
                                                    const render::Vantage& from) {
    const bool shown =
        scene.metrics() && scene.shows(&RuntimeParameters::view_sight_line) &&
        std::ranges::any_of(views, [](const render::View* view) { return shows_line_of_sight(*view); });
    return shown ? std::optional(view::trace_line_of_sight(scene, from.eye)) : std::nullopt;
}

std::optional<hud::Mark> project_line(const Vec3f& from, const Vec3f& to, const render::Camera& camera,
                                      const hud::Tile& tile) {
    const auto line = Projection(camera, tile).line(from, to);
    return line ? std::optional(hud::Mark{line->first, line->second, hud::Level::neutral, {}}) : std::nullopt;
}

std::vector<hud::Mark> aid_marks(const render::View& view, const render::Camera& camera,
                                 const view::SceneView& scene, const render::Vantage& from,
                                 const std::optional<view::LineOfSight>& look, const hud::Tile& tile) {
    using render::Overlay;
    std::vector<hud::Mark> marks;
    if (!scene.metrics()) {
        return marks;
    }
    const Projection projection(camera, tile);
    if (view.has(Overlay::axes) && scene.shows(&RuntimeParameters::view_axes)) {
        add_axes(marks, projection, scene);
    }
    if (look && shows_line_of_sight(view)) {
        add_line_of_sight(marks, projection, *look, view.has(Overlay::line_of_sight));
    }
    if (view.has(render::Pass::annotations)) {
        add_words(marks, projection, view, scene, from);
    }
    if (view.has(Overlay::gum_force) && scene.shows(&RuntimeParameters::view_gum_force)) {
        const Vec3f gum = scene.gum_contact().value_or(at(scene.landmarks(), Landmark::upper_gum));
        const float force = scene.measures().gum_force_n;
        // The name of the nearby dot is on the right.
        add(marks, projection, gum, gum, hud::level_of(&LiveMeasures::gum_force_n, force),
            fmt::format("{:.1f} N", force), true);
    }
    return marks;
}

}  // namespace eti::client
