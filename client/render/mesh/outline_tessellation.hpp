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

#include "client/render/mesh/triangle_blocks.hpp"
#include "client/view/skinned_surface.hpp"
#include "common/mesh/triangle_mesh.hpp"

namespace eti::render {

/// A triangle drawn as a grid of smaller ones, curved according to its vertex normals.
struct TessellatedFace {
    std::array<std::uint32_t, 3> corners{};      ///< vertex indices, ascending, so that neighbours compute a
                                                 ///< shared edge identically
    std::array<std::uint8_t, 3> steps{1, 1, 1};  ///< of the edges 0-1, 1-2 and 0-2, as given by steps_of()
    std::uint8_t turned = 0;                     ///< 1: the face is oriented opposite to its corners

    /// Grid steps along each side.
    [[nodiscard]] int grid() const { return std::max({steps[0], steps[1], steps[2]}); }
};

/// The same for the GPU, which looks up the corners.
struct TessellatedInstance {
    std::uint32_t triangle = 0;  ///< in the mesh's index buffer, below max_triangles
    std::array<std::uint8_t, 3> steps{1, 1, 1};
    std::uint8_t turned = 0;

    [[nodiscard]] int grid() const { return std::max({steps[0], steps[1], steps[2]}); }
};

/// Edges have 1, 2, 3 ... 8, 10, 12, 14, 16, 20, 24, 28 or 32 steps, encoded in four bits like floats with
/// a two-bit mantissa.
inline constexpr int step_codes = 16;
[[nodiscard]] constexpr int steps_of(int code) {
    return code < 4 ? code + 1 : ((code & 3) + 5) << ((code >> 2) - 1);
}
/// Maximum number of steps per edge.
inline constexpr int max_steps = steps_of(step_codes - 1);
/// The smallest code with at least `steps` steps; `steps` must be positive.
[[nodiscard]] int code_of(float steps);

/// Larger meshes cannot be tessellated.
inline constexpr std::size_t max_triangles = std::size_t{1} << 20;
/// Packs the triangle's number into the lowest 20 bits and its edges' codes above. The orientation is
/// omitted.
[[nodiscard]] std::uint32_t pack(const TessellatedInstance& face);

/// Maximum deviation from the flat triangle [m], so that the drawn surface stays well within a tenth of a
/// millimetre of the one the server measures.
inline constexpr float max_bend = 0.035e-3f;

/// Barycentric coordinates of a grid point, `i` steps towards corner 1 and `j` towards corner 2. On an edge
/// with fewer steps several points coincide: neighbouring triangles agree on them, so that no gap opens.
[[nodiscard]] Vec3f barycentric_at(const TessellatedFace& face, int i, int j);

/// The grid's triangles, points numbered row by row of `j`; with reversed orientation if `turned`.
[[nodiscard]] std::vector<Triangle> grid_triangles(int grid, bool turned);

/// Position [m] and unit normal of the curved surface of a triangle. The surface goes halfway to the mean
/// of the corners' tangent planes (Boubekeur & Alexa 2008); for a circle halfway is its arc. `bend` in the
/// shader scene/finer_vertex computes the same.
[[nodiscard]] view::LitVertex curved_vertex(const std::array<view::LitVertex, 3>& corners,
                                            const Vec3f& shares);

/// View of a mesh whose outlines are refined.
struct OutlineView {
    Eigen::Matrix4f view_projection;
    Vec3f eye;  ///< [m]
};

/// Selects the triangles of a mesh to tessellate: those at its outline with an edge that would appear
/// longer than some pixels.
class OutlineTessellation {
  public:
    OutlineTessellation() = default;
    /// The triangles in block order.
    OutlineTessellation(std::span<const Triangle> triangles, std::size_t vertex_count);

    /// Drawn position of a vertex [m].
    using Place = std::function<Vec3f(std::uint32_t)>;
    /// Selects among the triangles in `near`; edges outside it never appear too long.
    void choose(std::span<const TriangleBlocks::Range> near, const OutlineView& look, const Place& place);
    /// Selects none.
    void clear();

    /// The selected triangles, with the mesh's vertex indices.
    [[nodiscard]] std::span<const TessellatedFace> faces() const { return faces_; }
    /// Index in faces() of a triangle, or -1.
    [[nodiscard]] std::int32_t face_of(std::size_t triangle) const { return face_of_[triangle]; }

    /// Whether an edge [m] may appear too long at this distance from the eye [m].
    [[nodiscard]] static bool may_be_long(float edge, float distance, const OutlineView& look);

  private:
    struct Seen {
        Vec3f place = Vec3f::Zero();                   // [m]
        Eigen::Vector3f at = Eigen::Vector3f::Zero();  // position in the picture; z: depth
        std::uint64_t look = 0;
        std::uint16_t triangles = 0;
        bool faces = false, back_facing = false;
    };
    [[nodiscard]] bool outline_at(std::uint32_t vertex) const;
    [[nodiscard]] std::uint8_t steps(std::uint32_t a, std::uint32_t b) const;

    std::vector<Triangle> triangles_;
    std::vector<std::uint16_t> triangles_at_;  // by vertex: number of triangles
    std::vector<Seen> seen_;                   // by vertex
    std::uint64_t look_ = 0;
    std::vector<TessellatedFace> faces_;
    std::vector<std::size_t> chosen_;  // triangle indices
    std::vector<std::int32_t> face_of_;
    Eigen::Vector2f border_ = Eigen::Vector2f::Zero();  // of the picture, in half picture heights
    float scale_ = 0.0f;                                // half the height divided by the distance
};

}  // namespace eti::render
