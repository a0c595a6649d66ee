// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "client/render/material.hpp"
#include "client/view/scene_view.hpp"
#include "client/view/skinned_surface.hpp"
#include "common/mesh/triangle_mesh.hpp"

namespace eti::render {

/// Lowest and highest points of a body above a level plane, by cells of `cell` [m]; y is posterior, thus
/// down.
struct BodyProfile {
    static constexpr float cell = 5e-3f;
    static constexpr int width = 80, length = 160;        ///< cells along x and z
    static constexpr float left = -0.20f, foot = -0.62f;  ///< [m], where the cells begin

    BodyProfile();
    /// Extends the profile around a point of the body [m].
    void add(const Vec3f& point);
    /// Back [m]: the largest y in the cell, and front: the smallest; an empty cell has back < front.
    [[nodiscard]] float back_at(float x, float z) const;
    [[nodiscard]] float front_at(float x, float z) const;

    std::vector<float> back, front;  ///< [length][width]
};

[[nodiscard]] BodyProfile profile_of(std::span<const Vec3f> points);

/// Points of a body's surfaces, evenly spread, from which its profile in any posture follows.
class BodyOutline {
  public:
    /// Chooses the points.
    void build(const view::SceneView& scene);
    /// The points [m] in the scene's current posture.
    [[nodiscard]] std::vector<Vec3f> points(const view::SceneView& scene) const;

  private:
    struct Point {
        Vec3f rest;
        SkinWeights skin;
    };
    std::vector<Point> points_;
};

/// The levels [m] at which a supine newborn rests; y and z of the patient frame.
struct Rest {
    float mattress = 0.0f;     ///< y of the mattress's surface, the head's back being the lowest
    float trunk = 0.0f;        ///< y of the trunk's back, on a folded blanket
    float neck_z = -0.05f;     ///< z where the neck leaves the trunk's level: the place of the shoulder roll
    float head_top_z = 0.1f;   ///< z of the head's end
    float half_width = 0.06f;  ///< of the body [m]
};

[[nodiscard]] Rest rest_of(const BodyProfile& body);

/// Mattress under a towel, which a folded blanket lifts under the trunk and a roll under the shoulders: a
/// height field that yields to the body wherever the body lies deeper, and meets the head's back at any
/// elevation.
class Bedding {
  public:
    static constexpr int columns = 45, rows = 73;  ///< odd, for coarse_triangles()

    Bedding() = default;
    Bedding(const Rest& rest, const BodyProfile& body);

    /// Follows the part of the body that has moved: what lies at `from_z` [m] and towards the head. Returns
    /// how many rows, from the first, may have changed.
    int follow(const BodyProfile& body, float from_z);

    [[nodiscard]] std::span<const view::LitVertex> vertices() const { return vertices_; }
    /// Darkened where the body hides the room.
    [[nodiscard]] std::span<const VertexColour> colours() const { return colours_; }
    [[nodiscard]] std::span<const Triangle> triangles() const { return triangles_; }
    /// The same surface with every other row and column.
    [[nodiscard]] std::vector<Triangle> coarse_triangles() const;
    /// Rows run from the head's end to the feet's. Height [m] of the surface, y of the patient frame.
    [[nodiscard]] float height(int column, int row) const {
        return vertices_[index(column, row)].position.y();
    }
    [[nodiscard]] const Rest& rest() const { return rest_; }

  private:
    [[nodiscard]] static std::size_t index(int column, int row) {
        return static_cast<std::size_t>(row * columns + column);
    }
    [[nodiscard]] float unloaded(float x, float z, float headrest) const;
    void shape(const BodyProfile& body, int row_count);

    Rest rest_;
    std::vector<view::LitVertex> vertices_;
    std::vector<VertexColour> colours_;
    std::vector<Triangle> triangles_;
};

/// Share of the ambient light, weighted with the cosine, that a body leaves to a point [m] beneath or beside
/// it.
[[nodiscard]] float sky_beside(const BodyProfile& body, const Vec3f& point);

/// Size of the mattress [m]: half its width, and from the head's end to the feet's.
inline constexpr float mattress_half_width = 0.225f, mattress_length = 0.60f;
/// Mattress beyond the head [m], in front of the operator.
inline constexpr float mattress_margin = 0.06f;

}  // namespace eti::render
