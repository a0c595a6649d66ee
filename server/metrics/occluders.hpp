// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/mesh/skinning.hpp"
#include "common/mesh/triangle_mesh.hpp"
#include "common/model/tools/blade_clearance_deformer.hpp"
#include "common/model/tools/lip_retraction.hpp"

namespace eti::metrics {

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

    /// Returns false when a ball (centre in the eye frame, radius) cannot meet any line.
    [[nodiscard]] bool may_meet(const Vec3f& centre, float radius) const;

    /// Blocks the lines that cross a triangle (corners in the eye frame; two-sided).
    void block_by_triangle(const Vec3f& a, const Vec3f& b, const Vec3f& c);

    /// Blocks the lines that pass within `radius` [m] of a segment (ends in the eye frame).
    void block_by_capsule(const Vec3f& a, const Vec3f& b, float radius);

    /// Blocks the lines that cross a cylinder about a segment (distinct ends, in the eye frame) that is flat
    /// at `a`, less the part cut off by a plane: points p with (p - b).dot(cut) > beyond [m].
    void block_by_cut_cylinder(const Vec3f& a, const Vec3f& b, float radius, const Vec3f& cut, float beyond);

  private:
    Vec3f eye_;
    Mat3f to_eye_;
    std::vector<Vec3f> lines_;  // eye to target, in the eye frame
    std::vector<float> last_;   // fraction of each line beyond which nothing blocks it
    std::vector<Eigen::Vector2f> image_;
    std::vector<std::uint8_t> blocked_;
    Eigen::Vector2f low_;  // bounding box of the tested targets' image
    Eigen::Vector2f high_;
    float level_ = 0.0f;     // [m], along the third axis
    float farthest_ = 0.0f;  // [m], along the third axis
    std::size_t open_ = 0;
};

/// A skinned mesh divided into small blocks of neighbouring triangles, so that a narrow bundle of sight lines
/// skins and tests only the few blocks that it may meet.
///
/// A vertex blended from several frames lies in the convex hull of its images under each frame alone. A ball
/// around the block's images under all its frames is therefore a safe bound for any deformation.
class Occluder {
  public:
    Occluder(const TriangleMesh& mesh, std::span<const SkinWeights> skin);

    /// The mesh's current deformation.
    struct DeformedState {
        std::span<const FrameMap> frames;
        std::optional<PosedBladeClearanceDeformer> pressed =
            std::nullopt;                     ///< the blade that deforms the drawn surface
        const LipRetraction* lips = nullptr;  ///< retraction applied to the lips after it
    };
    /// The blocks that blocked a line in the last test.
    using RecentBlocks = std::vector<std::uint32_t>;

    /// Tests `recent` alone, and leaves in it the blocks that still block a line.
    void block_by_recent(SightLines& lines, const DeformedState& posture, RecentBlocks& recent);
    /// Tests the whole mesh, and adds to `recent` the blocks that blocked an open line.
    void block(SightLines& lines, const DeformedState& posture, RecentBlocks& recent);

  private:
    struct Block {
        Vec3f centre = Vec3f::Zero();  // [m], at rest
        float radius = 0.0f;           // [m], at rest
        std::uint32_t first_frame = 0, end_frame = 0;
        std::uint32_t first_triangle = 0, end_triangle = 0;
    };

    [[nodiscard]] bool may_hide(const Block& block, const SightLines& lines,
                                const DeformedState& posture) const;
    // Tests one block. Returns whether it blocked any line.
    bool block_by(const Block& block, SightLines& lines, const DeformedState& posture);

    std::vector<Vec3f> rest_;
    std::vector<SkinWeights> skin_;
    std::vector<Triangle> triangles_;  // grouped by block
    std::vector<Block> blocks_;
    std::vector<std::uint16_t> frames_;   // frames of all blocks
    std::vector<Vec3f> seen_;             // skinned vertices in the eye frame
    std::vector<std::uint32_t> seen_in_;  // call in which each entry of seen_ was computed
    std::uint32_t call_ = 0;
};

}  // namespace eti::metrics
