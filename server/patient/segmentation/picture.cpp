// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/segmentation/picture.hpp"

#include <algorithm>
#include <cmath>

#include "server/parallel/loops.hpp"
#include "server/patient/imaging/resample.hpp"

namespace eti::segmentation {

namespace {

using Colour = std::array<std::uint8_t, 3>;

/// One quarter of the picture.
class Panel {
  public:
    Panel(imaging::Picture& picture, int left, int top, int size)
        : picture_(picture), left_(left), top_(top), size_(size) {}
    [[nodiscard]] int size() const { return size_; }
    void set(int x, int y, const Vec3f& rgb) const {
        const std::size_t at =
            3 * (static_cast<std::size_t>(top_ + y) * static_cast<std::size_t>(picture_.width) +
                 static_cast<std::size_t>(left_ + x));
        for (int k = 0; k < 3; ++k) {
            picture_.rgb[at + static_cast<std::size_t>(k)] =
                static_cast<std::uint8_t>(std::clamp(rgb[k], 0.0f, 255.0f));
        }
    }

  private:
    imaging::Picture& picture_;
    int left_, top_, size_;
};

Vec3f rgb_of(Label label) {
    const Colour c = colour_of(label);
    return {static_cast<float>(c[0]), static_cast<float>(c[1]), static_cast<float>(c[2])};
}

struct Scene {
    const imaging::Volume& ct;
    const imaging::Mask& labels;
    Vec3d middle;   ///< [m], centre of the volume
    double extent;  ///< [m], longest side of the volume

    /// The label at a point; `outside` beyond the volume.
    [[nodiscard]] Label label_at(const Vec3d& point, std::size_t* index = nullptr) const {
        const imaging::Geometry& g = ct.geometry;
        const Vec3d at = (point - g.origin) / g.step(0, 0);
        const int x = static_cast<int>(std::floor(at.x() + 0.5));
        const int y = static_cast<int>(std::floor(at.y() + 0.5));
        const int z = static_cast<int>(std::floor(at.z() + 0.5));
        if (!g.contains(x, y, z)) {
            return Label::outside;
        }
        const std::size_t i = g.index(x, y, z);
        if (index != nullptr) {
            *index = i;
        }
        return static_cast<Label>(labels.value[i]);
    }
};

/// Draws a slice through `centre`; `right` and `down` are unit vectors of the picture.
void draw_slice(const Scene& scene, const Panel& panel, const Vec3d& centre, const Vec3d& right,
                const Vec3d& down) {
    const Vec3d normal = right.cross(down);
    // Shows the whole volume; only the position along the normal is the centre's.
    const Vec3d origin = scene.middle + normal * normal.dot(centre - scene.middle);
    const double pixel = scene.extent / panel.size();
    for (int y = 0; y < panel.size(); ++y) {
        for (int x = 0; x < panel.size(); ++x) {
            const Vec3d point =
                origin + pixel * ((x - 0.5 * panel.size()) * right + (y - 0.5 * panel.size()) * down);
            std::size_t i = scene.ct.value.size();
            const Label label = scene.label_at(point, &i);
            if (i == scene.ct.value.size()) {
                panel.set(x, y, Vec3f::Zero());
                continue;
            }
            // Window of 700 HU around 50 HU: soft tissue and a newborn's bone.
            const float grey = std::clamp((scene.ct.value[i] + 300.0f) / 700.0f, 0.0f, 1.0f) * 255.0f;
            const bool plain = label == Label::outside || label == Label::soft;
            const float share = plain ? 0.0f : 0.55f;
            panel.set(x, y, (1.0f - share) * Vec3f::Constant(grey) + share * rgb_of(label));
        }
    }
}

/// Ray casting of what is not cut away; the light is at the eye.
void draw_view(const Scene& scene, const Panel& panel, const Vec3d& centre) {
    const double h = scene.ct.geometry.step(0, 0);
    const Vec3d forward = Vec3d(-0.80, 0.55, -0.22).normalized();
    const Vec3d right = forward.cross(Vec3d::UnitZ()).normalized();
    const Vec3d down = forward.cross(right);
    const auto solid = [&](const Vec3d& point) {
        const Label label = scene.label_at(point);
        switch (label) {
            case Label::outside:
            case Label::enclosed_air:
                return Label::outside;
            case Label::soft:
            case Label::bone:
            case Label::spine:
                return point.x() > centre.x() ? Label::outside : label;
            default:
                return label;
        }
    };
    const double reach = 0.9 * scene.extent;
    parallel::for_each(panel.size(), 1, [&](int y) {
        for (int x = 0; x < panel.size(); ++x) {
            const double pixel = 0.95 * scene.extent / panel.size();
            const Vec3d start = scene.middle - reach * forward +
                                pixel * ((x - 0.5 * panel.size()) * right + (y - 0.5 * panel.size()) * down);
            Vec3f colour = Vec3f::Constant(24.0f);
            for (double way = 0.0; way < 2.0 * reach; way += 0.7 * h) {
                const Vec3d point = start + way * forward;
                const Label label = solid(point);
                if (label == Label::outside) {
                    continue;
                }
                // Outward direction of the solid, from the balance of the neighbourhood.
                Vec3d normal = Vec3d::Zero();
                for (int k = 0; k < 125; ++k) {
                    const Vec3d offset(k % 5 - 2, k / 5 % 5 - 2, k / 25 - 2);
                    if (solid(point + h * offset) != label) {
                        normal += offset;
                    }
                }
                const double facing =
                    normal.norm() > 0.0 ? std::max(0.0, -normal.normalized().dot(forward)) : 0.3;
                const double near = std::clamp(1.15 - 0.35 * way / (2.0 * reach), 0.0, 1.0);
                colour = static_cast<float>(near * (0.25 + 0.75 * facing)) * rgb_of(label);
                break;
            }
            panel.set(x, y, colour);
        }
    });
}

}  // namespace

Colour colour_of(Label label) {
    switch (label) {
        case Label::soft:
            return {214, 170, 150};
        case Label::bone:
            return {238, 228, 196};
        case Label::airway:
            return {70, 150, 240};
        case Label::mandible:
            return {250, 170, 60};
        case Label::spine:
            return {120, 200, 120};
        case Label::tongue:
            return {220, 70, 90};
        case Label::epiglottis:
            return {180, 90, 210};
        case Label::enclosed_air:
            return {90, 200, 200};
        case Label::outside:
            break;
    }
    return {0, 0, 0};
}

imaging::Picture draw(const imaging::Volume& volume, const imaging::Mask& labels, const Vec3d& centre,
                      int pixels) {
    const imaging::Volume ct = imaging::resample_upright(volume, std::size_t{1} << 25);
    const imaging::Mask mask = imaging::resample_labels(ct.geometry, labels);
    const imaging::Geometry& g = ct.geometry;
    const Vec3d far = g.point(g.size[0] - 1, g.size[1] - 1, g.size[2] - 1);
    const Scene scene{ct, mask, 0.5 * (g.origin + far), (far - g.origin).maxCoeff() + g.step(0, 0)};
    imaging::Picture picture{pixels, pixels, imaging::Bytes(3 * static_cast<std::size_t>(pixels * pixels))};
    const int half = pixels / 2;
    draw_slice(scene, Panel(picture, 0, 0, half), centre, Vec3d::UnitX(), Vec3d::UnitY());
    draw_slice(scene, Panel(picture, half, 0, half), centre, Vec3d::UnitY(), -Vec3d::UnitZ());
    draw_slice(scene, Panel(picture, 0, half, half), centre, Vec3d::UnitX(), -Vec3d::UnitZ());
    draw_view(scene, Panel(picture, half, half, half), centre);
    return picture;
}

}  // namespace eti::segmentation
