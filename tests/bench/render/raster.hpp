// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "common/math/transform.hpp"
#include "common/mesh/triangle_mesh.hpp"

namespace eti::bench {

/// Calls `pixel(x, y, depth)` for each pixel whose centre a triangle covers; y from the top, depth from 0 at
/// the near plane to 1 at the far one, as in OpenGL. Clips at the near plane.
template <typename Pixel>
void rasterise(const Eigen::Matrix4f& view_projection, int width, int height,
               const std::array<Vec3f, 3>& corners, Pixel&& pixel) {
    std::array<Eigen::Vector4f, 4> kept;
    std::size_t count = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const Eigen::Vector4f a = view_projection * corners[i].homogeneous();
        const Eigen::Vector4f b = view_projection * corners[(i + 1) % 3].homogeneous();
        const float before = a.z() + a.w(), after = b.z() + b.w();
        if (before > 0.0f) {
            kept[count++] = a;
        }
        if ((before > 0.0f) != (after > 0.0f)) {
            kept[count++] = a + before / (before - after) * (b - a);
        }
    }
    const auto seen = [&](const Eigen::Vector4f& clip) {
        return Eigen::Vector3d(0.5 * width * (1.0 + clip.x() / clip.w()),
                               0.5 * height * (1.0 - clip.y() / clip.w()), 0.5 + 0.5 * clip.z() / clip.w());
    };
    for (std::size_t k = 2; k < count; ++k) {
        const Eigen::Vector3d a = seen(kept[0]), b = seen(kept[k - 1]), c = seen(kept[k]);
        const double area = (b - a).head<2>().x() * (c - a).y() - (b - a).y() * (c - a).x();
        if (area == 0.0) {
            continue;
        }
        const auto first = [](double low, int) {
            return std::max(0, static_cast<int>(std::ceil(low - 0.5)));
        };
        const auto last = [](double high, int side) {
            return std::min(side - 1, static_cast<int>(std::ceil(high - 0.5)) - 1);
        };
        const double lowest = std::min({a.y(), b.y(), c.y()}), highest = std::max({a.y(), b.y(), c.y()});
        const double left = std::min({a.x(), b.x(), c.x()}), right = std::max({a.x(), b.x(), c.x()});
        for (int y = first(std::max(lowest, -1.0), height);
             y <= last(std::min(highest, height + 1.0), height); ++y) {
            for (int x = first(std::max(left, -1.0), width); x <= last(std::min(right, width + 1.0), width);
                 ++x) {
                const Eigen::Vector2d p(x + 0.5, y + 0.5);
                const Eigen::Vector2d ab = (b - a).head<2>(), ac = (c - a).head<2>(), ap = p - a.head<2>();
                const double v = (ap.x() * ac.y() - ap.y() * ac.x()) / area;
                const double w = (ab.x() * ap.y() - ab.y() * ap.x()) / area;
                if (v >= 0.0 && w >= 0.0 && v + w <= 1.0) {
                    const double depth = a.z() + v * (b.z() - a.z()) + w * (c.z() - a.z());
                    if (depth <= 1.0) {
                        pixel(x, y, static_cast<float>(depth));
                    }
                }
            }
        }
    }
}

/// Contents of one pixel of a Raster.
struct Hit {
    float depth = 1.0f;
    std::int16_t object = -1;  ///< as given to draw(); -1: nothing
    bool back = false;         ///< its back face is seen
    std::uint32_t triangle = 0;
};

/// A software rasteriser, independent of OpenGL: the nearest object per pixel.
class Raster {
  public:
    Raster(int width, int height, const Eigen::Matrix4f& view_projection, const Vec3f& eye)
        : width_(width),
          height_(height),
          view_projection_(view_projection),
          eye_(eye),
          hits_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {}

    /// The mesh must be closed and oriented outwards, otherwise `back` is meaningless.
    void draw(std::span<const Triangle> triangles, std::span<const Vec3f> vertices, std::int16_t object) {
        for (std::uint32_t t = 0; t < triangles.size(); ++t) {
            const std::array<Vec3f, 3> c{vertices[triangles[t][0]], vertices[triangles[t][1]],
                                         vertices[triangles[t][2]]};
            const bool back = (c[1] - c[0]).cross(c[2] - c[0]).dot(eye_ - c[0]) < 0.0f;
            rasterise(view_projection_, width_, height_, c, [&](int x, int y, float depth) {
                Hit& hit = hits_[index(x, y)];
                if (depth < hit.depth) {
                    hit = {depth, object, back, t};
                }
            });
        }
    }

    [[nodiscard]] const Hit& at(int x, int y) const { return hits_[index(x, y)]; }
    [[nodiscard]] int width() const { return width_; }
    [[nodiscard]] int height() const { return height_; }
    [[nodiscard]] std::span<const Hit> hits() const { return hits_; }
    [[nodiscard]] const Eigen::Matrix4f& view_projection() const { return view_projection_; }
    [[nodiscard]] const Vec3f& eye() const { return eye_; }

  private:
    [[nodiscard]] std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
    }

    int width_, height_;
    Eigen::Matrix4f view_projection_;
    Vec3f eye_;
    std::vector<Hit> hits_;
};

}  // namespace eti::bench
