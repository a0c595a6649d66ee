// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <vector>

#include "server/patient/newborn/anatomy.hpp"

namespace eti::patient {

/// Local edge length of drawn surfaces: finest at larynx and epiglottis, coarse at trunk and scalp.
class SizingField {
  public:
    /// `spacing` [m]: edge length in the mouth; all others scale with it. Keeps a reference to `anatomy`.
    SizingField(const Anatomy& anatomy, float spacing);

    /// Edge length [m] of triangles at a point. Its gradient is at most a quarter.
    [[nodiscard]] float edge(const Vec3f& point) const;
    /// The same for the body, which is finer at the uvula and the free edge of the velum.
    [[nodiscard]] float body_edge(const Vec3f& point) const;
    /// The same for the cloth: finest at its hem and around its far end, whose outlines are visible.
    [[nodiscard]] float cloth_edge(const Vec3f& point) const;

    [[nodiscard]] bool whole_body() const { return whole_body_; }

  private:
    /// Distance [m] along the trunk, downwards from the middle of the hem.
    [[nodiscard]] float below_hem(const Vec3f& point) const { return (point - hem_).dot(down_); }

    /// Edge length within `reach` of a segment.
    struct Part {
        Vec3f from, to;  // [m]
        float reach;     // [m]
        float edge;      // [m]
    };
    [[nodiscard]] static float edge_at(const Part& part, const Vec3f& point);

    const Anatomy& anatomy_;
    std::vector<Part> parts_;
    Part uvula_{};
    float coarsest_;
    float size_;     // relative to the term newborn
    float spacing_;  // relative to 1 mm
    Vec3f hem_, down_;
    bool whole_body_;  // the anatomy itself says how finely skin is to be resolved
};

}  // namespace eti::patient
