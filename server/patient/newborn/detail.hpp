// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <vector>

#include "server/patient/newborn/anatomy.hpp"

namespace eti::anatomy {

/// How finely what is drawn is cut at a place: finest at larynx and epiglottis, coarse at trunk and scalp.
class Detail {
  public:
    /// `spacing` [m]: edges in the mouth; all others are finer or coarser in proportion.
    Detail(const Anatomy& anatomy, float spacing);

    /// [m], edges of triangles at a point. Changes by a quarter of the way at most.
    [[nodiscard]] float edge(const Vec3f& point) const;
    /// The same of the cloth: finest at its hem and about its far end, whose outlines one sees.
    [[nodiscard]] float cloth_edge(const Vec3f& point) const;

  private:
    /// Along the trunk [m], from the hem's middle downwards.
    [[nodiscard]] float below_hem(const Vec3f& point) const { return (point - hem_).dot(down_); }

    /// Within `reach` of the line between two points edges are this long.
    struct Part {
        Vec3f from, to;  // [m]
        float reach;     // [m]
        float edge;      // [m]
    };
    std::vector<Part> parts_;
    float coarsest_;
    float size_;     // over the term newborn's
    float spacing_;  // over 1 mm
    Vec3f hem_, down_;
};

}  // namespace eti::anatomy
