// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/mesh/skinning.hpp"
#include "common/mesh/triangle_mesh.hpp"
#include "common/model/tools/blade_clearance_deformer.hpp"
#include "common/model/tools/lip_retraction.hpp"

namespace eti::metrics {

/// A frame's map of rest points as eti::FrameMap, with columns padded for SIMD. Gives the same bits.
class WideFrameMap {
  public:
    // NOLINTNEXTLINE(google-explicit-constructor): the same map
    WideFrameMap(const FrameMap& map) {
        for (int column = 0; column < 3; ++column) {
            columns_[static_cast<std::size_t>(column)] << map.linear.col(column), 0.0f;
        }
        columns_[3] << map.offset, 0.0f;
    }
    [[nodiscard]] Eigen::Vector4f operator*(const Vec3f& rest) const {
        return (columns_[0] * rest.x() + (columns_[1] * rest.y() + columns_[2] * rest.z())) + columns_[3];
    }

  private:
    std::array<Eigen::Vector4f, 4> columns_;
};

/// Sight lines from one eye to many targets, each open or blocked.
class SightLines {
  public:
    /// Geometry within `tolerance` [m] of a target does not block its line.
    SightLines(const Vec3f& eye, std::span<const Vec3f> targets, float tolerance);

    [[nodiscard]] std::size_t size() const { return lines_.size(); }
    [[nodiscard]] bool blocked(std::size_t line) const { return blocked_[line] != 0; }
    [[nodiscard]] std::size_t open() const { return open_; }
    [[nodiscard]] bool all_blocked() const { return open_ == 0; }
    /// Share [%] of open lines; 0 without lines.
    [[nodiscard]] float open_percent() const {
        return lines_.empty() ? 0.0f : 100.0f * static_cast<float>(open_) / static_cast<float>(lines_.size());
    }

    /// Position [m] relative to the eye, third axis towards the targets.
    [[nodiscard]] Vec3f to_eye_frame(const Vec3f& point) const { return to_eye_ * (point - eye_); }
    /// The same for a direction.
    [[nodiscard]] Vec3f direction_in_eye_frame(const Vec3f& direction) const { return to_eye_ * direction; }

    /// From now on, geometry nearer than `level` [m] along the third axis does not block.
    void set_min_depth(float level) { level_ = level; }

    /// From now on, only geometry that may meet open lines is tested.
    void restrict_to_open_lines();

    /// Returns false when a ball (centre in the eye frame, radius) cannot meet any line: against the cone
    /// around the tested lines, and then against each of them.
    [[nodiscard]] bool may_meet(const Vec3f& centre, float radius) const {
        return may_meet_cone(centre, radius) && may_meet_line(centre, radius);
    }

    /// Blocks the lines that cross a triangle (corners in the eye frame; two-sided).
    void block_by_triangle(const Vec3f& a, const Vec3f& b, const Vec3f& c);

    /// Blocks the lines that pass within `radius` [m] of a segment (ends in the eye frame).
    void block_by_capsule(const Vec3f& a, const Vec3f& b, float radius);

    /// Blocks the lines that cross a cylinder about a segment (distinct ends, in the eye frame) that is flat
    /// at `a`, less the part cut off by a plane: points p with (p - b).dot(cut) > beyond [m].
    void block_by_cut_cylinder(const Vec3f& a, const Vec3f& b, float radius, const Vec3f& cut, float beyond);

  private:
    [[nodiscard]] bool may_meet_cone(const Vec3f& centre, float radius) const;
    [[nodiscard]] bool may_meet_line(const Vec3f& centre, float radius) const;

    Vec3f eye_;
    Mat3f to_eye_;
    std::vector<Vec3f> lines_;  // eye to target, in the eye frame
    std::vector<float> last_;   // fraction of each line beyond which nothing blocks it
    std::vector<Eigen::Vector2f> image_;
    std::vector<std::uint8_t> blocked_;
    Eigen::Vector2f low_;  // bounding box of the tested targets' image
    Eigen::Vector2f high_;
    Eigen::Matrix<float, 3, Eigen::Dynamic, Eigen::RowMajor> tested_;  // unit directions of the tested lines
    float level_ = 0.0f;                                               // [m], along the third axis
    float farthest_ = 0.0f;                                            // [m], along the third axis
    std::size_t open_ = 0;
};

/// A skinned mesh divided into small blocks of neighbouring triangles, so that a narrow bundle of sight lines
/// skins and tests only the few blocks that it may meet.
///
/// Bounds hold for any deformation. Let c be the centre of a block, r its radius at rest, p_k the images of c
/// under the frames, and w_k the mean weights of the block's vertices. A vertex with weights w_k + d_k lies
/// within r + sum |d_k| / 2 · max |p_i - p_j| of sum w_k p_k, since the d_k sum to zero.
class Occluder {
  public:
    Occluder(const TriangleMesh& mesh, std::span<const SkinWeights> skin);

    /// The mesh's current deformation.
    struct DeformedState {
        std::span<const WideFrameMap> frames;
        std::optional<PosedBladeClearanceDeformer> pressed =
            std::nullopt;                     ///< the blade that deforms the drawn surface
        const LipRetraction* lips = nullptr;  ///< retraction applied to the lips after it
    };
    /// The blocks that blocked a line in the last test.
    using RecentBlocks = std::vector<std::uint32_t>;

    /// Call when the deformation may have changed.
    void forget() { ++deformation_; }
    /// Tests `recent` alone, and leaves in it the blocks that still block a line.
    void block_by_recent(SightLines& lines, const DeformedState& posture, RecentBlocks& recent);
    /// Tests the whole mesh, and adds to `recent` the blocks that blocked an open line.
    void block(SightLines& lines, const DeformedState& posture, RecentBlocks& recent);

  private:
    struct Block {
        Vec3f centre = Vec3f::Zero();  // [m], at rest
        float radius = 0.0f;           // [m], at rest
        float unlike = 0.0f;           // greatest sum |d_k| / 2 of its vertices
        std::uint32_t first_frame = 0, end_frame = 0;
        std::uint32_t first_triangle = 0, end_triangle = 0;
    };
    struct Carrier {
        std::uint16_t frame;
        float weight;  // mean
    };

    /// Adds the block of these triangles of triangles_.
    void add_block(std::size_t first, std::size_t end);
    /// Whether anything within `radius` [m] of `centre`, once moved by blade and fingers, may meet a line.
    [[nodiscard]] static bool may_meet(const SightLines& lines, const DeformedState& posture,
                                       const Vec3f& centre, float radius);
    [[nodiscard]] bool may_hide(const Block& block, const SightLines& lines,
                                const DeformedState& posture) const;
    /// The vertex under its frames alone [m], without what blade and fingers move.
    const Vec3f& skinned(std::uint32_t vertex, const DeformedState& posture);
    // Tests one block. Returns whether it blocked any line.
    bool block_by(const Block& block, SightLines& lines, const DeformedState& posture);

    std::vector<Vec3f> rest_;
    std::vector<SkinWeights> skin_;
    std::vector<Triangle> triangles_;  // grouped by block
    std::vector<Block> blocks_;
    std::vector<Carrier> frames_;            // of all blocks
    std::vector<Vec3f> skinned_;             // [vertices][m]
    std::vector<std::uint32_t> skinned_in_;  // deformation in which each entry of skinned_ was computed
    std::vector<Vec3f> seen_;                // [vertices][m], deformed, in the eye frame
    std::vector<std::uint32_t> seen_in_;     // call in which each entry of seen_ was computed
    std::uint32_t deformation_ = 1;
    std::uint32_t call_ = 0;
};

}  // namespace eti::metrics
