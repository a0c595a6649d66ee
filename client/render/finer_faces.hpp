// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "client/render/triangle_blocks.hpp"
#include "client/view/skinned_surface.hpp"
#include "common/mesh/triangle_mesh.hpp"

namespace eti::render {

/// A triangle that is drawn as a grid of smaller ones, bent as the normals at its corners say.
struct FinerFace {
    std::array<std::uint32_t, 3> corners{};  ///< vertices, ascending: neighbours compute a common edge alike
    std::array<std::uint8_t, 3> steps{1, 1, 1};  ///< of the edges 0-1, 1-2 and 0-2, as of steps_of()
    std::uint8_t turned = 0;                     ///< 1: its face turns the other way round than its corners

    /// Steps of the grid along each side.
    [[nodiscard]] int grid() const { return std::max({steps[0], steps[1], steps[2]}); }
};

/// The same as the graphics card takes it, which knows the corners.
struct FinerInstance {
    std::uint32_t triangle = 0;  ///< in the mesh's index buffer, below most_triangles
    std::array<std::uint8_t, 3> steps{1, 1, 1};
    std::uint8_t turned = 0;

    [[nodiscard]] int grid() const { return std::max({steps[0], steps[1], steps[2]}); }
};

/// Edges have 1, 2, 3 ... 8, 10, 12, 14, 16, 20, 24, 28 or 32 steps: as numbers of four bits, like floats of
/// two bits of mantissa.
inline constexpr int step_codes = 16;
[[nodiscard]] constexpr int steps_of(int code) {
    return code < 4 ? code + 1 : ((code & 3) + 5) << ((code >> 2) - 1);
}
/// No edge gets more steps.
inline constexpr int most_steps = steps_of(step_codes - 1);
/// The fewest of those steps that are not fewer than `steps`, which is positive.
[[nodiscard]] int code_of(float steps);

/// A mesh of more triangles cannot be drawn finer.
inline constexpr std::size_t most_triangles = std::size_t{1} << 20;
/// The triangle's number in the lowest 20 bits and above them its edges' codes. Which way it is turned is
/// left out.
[[nodiscard]] std::uint32_t packed(const FinerInstance& face);

/// No bend goes farther from the flat triangle [m], so that what is drawn stays well within a tenth of a
/// millimetre of what the server measures.
inline constexpr float most_bend = 0.035e-3f;

/// The corners' shares in a place of the grid, `i` steps towards corner 1 and `j` towards corner 2. On an
/// edge of fewer steps places gather: triangles of an edge agree on them, so that no gap opens.
[[nodiscard]] Vec3f shares_of(const FinerFace& face, int i, int j);

/// The grid's triangles, places numbered row by row of `j`; turned the other way round where `turned`.
[[nodiscard]] std::vector<Triangle> grid_triangles(int grid, bool turned);

/// Of a triangle with these corners the bent surface there, [m] and unit normal. It goes half the way to the
/// mean of the corners' tangent planes (Boubekeur & Alexa 2008); of a circle half the way is its arc.
/// `bend` of client/render/finer_shaders.hpp computes the same.
[[nodiscard]] view::LitVertex bent(const std::array<view::LitVertex, 3>& corners, const Vec3f& shares);

/// From where one looks at a mesh whose outlines are to be fine.
struct OutlineLook {
    Eigen::Matrix4f view_projection;
    Vec3f eye;  ///< [m]
};

/// Which triangles of a mesh are drawn finer: those about its outline, where an edge would be seen longer
/// than some pixels.
class FinerFaces {
  public:
    FinerFaces() = default;
    /// The triangles in their blocks' order.
    FinerFaces(std::span<const Triangle> triangles, std::size_t vertex_count);

    /// Where a vertex is drawn [m].
    using Place = std::function<Vec3f(std::uint32_t)>;
    /// Chooses among the triangles in `near`, beyond which no edge is seen too long.
    void choose(std::span<const TriangleBlocks::Range> near, const OutlineLook& look, const Place& place);
    /// None.
    void clear();

    /// Those chosen, their corners as in the mesh.
    [[nodiscard]] std::span<const FinerFace> faces() const { return faces_; }
    /// Which of faces() a triangle is drawn as, or -1.
    [[nodiscard]] std::int32_t face_of(std::size_t triangle) const { return face_of_[triangle]; }

    /// Whether an edge of so many metres may be too long at this distance from the eye [m].
    [[nodiscard]] static bool may_be_long(float edge, float distance, const OutlineLook& look);

  private:
    struct Seen {
        Vec3f place = Vec3f::Zero();                   // [m]
        Eigen::Vector3f at = Eigen::Vector3f::Zero();  // in the picture; its third the depth before the eye
        std::uint64_t look = 0;
        std::uint16_t triangles = 0;
        bool faces = false, averted = false;
    };
    [[nodiscard]] bool outline_at(std::uint32_t vertex) const;
    [[nodiscard]] std::uint8_t steps(std::uint32_t a, std::uint32_t b) const;

    std::vector<Triangle> triangles_;
    std::vector<std::uint16_t> triangles_at_;  // by vertex, how many
    std::vector<Seen> seen_;                   // by vertex
    std::uint64_t look_ = 0;
    std::vector<FinerFace> faces_;
    std::vector<std::size_t> chosen_;  // triangles
    std::vector<std::int32_t> face_of_;
    Eigen::Vector2f border_ = Eigen::Vector2f::Zero();  // of the picture, in halves of its height
    float scale_ = 0.0f;                                // half of the height over the distance
};

}  // namespace eti::render
