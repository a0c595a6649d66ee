// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/mesh/skinning.hpp"
#include "common/mesh/triangle_mesh.hpp"
#include "common/model/give_way.hpp"
#include "common/model/lip_retraction.hpp"

namespace eti::metrics {

/// Straight lines from one eye to many targets, and which of them something blocks.
class SightLines {
  public:
    /// What lies within `tolerance` [m] of a target does not hide it.
    SightLines(const Vec3f& eye, std::span<const Vec3f> targets, float tolerance);

    [[nodiscard]] std::size_t size() const { return lines_.size(); }
    [[nodiscard]] bool blocked(std::size_t line) const { return blocked_[line] != 0; }
    [[nodiscard]] std::size_t open() const { return open_; }
    [[nodiscard]] bool all_blocked() const { return open_ == 0; }
    /// Share [%] of the lines that nothing blocks; 0 without lines.
    [[nodiscard]] float open_percent() const {
        return lines_.empty() ? 0.0f : 100.0f * static_cast<float>(open_) / static_cast<float>(lines_.size());
    }

    /// Position [m] relative to the eye, third axis towards the targets.
    [[nodiscard]] Vec3f seen_from_eye(const Vec3f& point) const { return to_eye_ * (point - eye_); }
    /// The same of a direction.
    [[nodiscard]] Vec3f turned(const Vec3f& direction) const { return to_eye_ * direction; }

    /// From here on nothing nearer than `level` [m] along the third axis blocks.
    void begin_at(float level) { level_ = level; }

    /// From here on only what may meet lines that are open is looked at.
    void look_at_open_ones();

    /// False when a ball (centre as seen from the eye, radius) cannot meet any line.
    [[nodiscard]] bool may_meet(const Vec3f& centre, float radius) const;

    /// Blocks the lines that cross a triangle (corners as seen from the eye; either side).
    void block_by_triangle(const Vec3f& a, const Vec3f& b, const Vec3f& c);

    /// Blocks the lines that pass a segment (ends as seen from the eye) closer than `radius` [m].
    void block_by_capsule(const Vec3f& a, const Vec3f& b, float radius);

    /// Blocks the lines that pass through a cylinder about a segment (ends as seen from the eye, apart), flat
    /// at `a`, without what the plane cuts off: p where (p - b).dot(cut) > beyond [m].
    void block_by_cut_cylinder(const Vec3f& a, const Vec3f& b, float radius, const Vec3f& cut, float beyond);

  private:
    Vec3f eye_;
    Mat3f to_eye_;
    std::vector<Vec3f> lines_;  // eye to target, seen from the eye
    std::vector<float> last_;   // share of each line beyond which nothing hides the target
    std::vector<Eigen::Vector2f> image_;
    std::vector<std::uint8_t> blocked_;
    Eigen::Vector2f low_;  // box of the image of the targets that are looked at
    Eigen::Vector2f high_;
    float level_ = 0.0f;     // along the third axis
    float farthest_ = 0.0f;  // the same
    std::size_t open_ = 0;
};

/// A skinned mesh cut into small blocks of neighbouring triangles, so that a narrow bundle of sight
/// lines has to skin and test only the few blocks that it may meet.
///
/// A vertex blended from several frames lies in the hull of where each frame alone would put it, so
/// a ball around the block's images under all its frames is a safe bound for any deformation.
class Occluder {
  public:
    Occluder(const TriangleMesh& mesh, std::span<const SkinWeights> skin);

    /// How the mesh lies now.
    struct Posture {
        std::span<const FrameMap> frames;
        std::optional<PlacedGiveWay> pressed = std::nullopt;  ///< the blade that it gives way to as drawn
        const LipRetraction* lips = nullptr;                  ///< what then holds it aside
    };
    /// The blocks that hid something when one last looked.
    using Recent = std::vector<std::uint32_t>;

    /// Blocks lines by `recent` alone, and leaves in it what still hides something.
    void block_again(SightLines& lines, const Posture& posture, Recent& recent);
    /// Blocks lines by all of the mesh, and adds to `recent` what hides something that was open.
    void block(SightLines& lines, const Posture& posture, Recent& recent);

  private:
    struct Block {
        Vec3f centre = Vec3f::Zero();  // [m], rest
        float radius = 0.0f;           // [m], rest
        std::uint32_t first_frame = 0, end_frame = 0;
        std::uint32_t first_triangle = 0, end_triangle = 0;
    };

    [[nodiscard]] bool may_hide(const Block& block, const SightLines& lines, const Posture& posture) const;
    // Blocks lines by one block. Returns whether it hid anything.
    bool block_by(const Block& block, SightLines& lines, const Posture& posture);

    std::vector<Vec3f> rest_;
    std::vector<SkinWeights> skin_;
    std::vector<Triangle> triangles_;  // block by block
    std::vector<Block> blocks_;
    std::vector<std::uint16_t> frames_;   // of all blocks
    std::vector<Vec3f> seen_;             // skinned vertices as seen from the eye
    std::vector<std::uint32_t> seen_in_;  // call in which an entry of seen_ was made
    std::uint32_t call_ = 0;
};

}  // namespace eti::metrics
