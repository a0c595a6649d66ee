// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/math/transform.hpp"

// Larynx and trachea in the newborn's model coordinates: x left, y anterior, z superior; millimetres of the
// 3.5 kg term newborn.
namespace eti::patient {

// The glottis lies at z = -37.5, the carina 50 mm below it (vocal cord to carina 5.04 cm under three months,
// Ann Otol Rhinol Laryngol 2001;110:268).
constexpr float glottis_z = -37.5f;
constexpr float glottis_y = 5.6f;
constexpr float glottis_half_length = 2.75f;  // 5.5 mm long (Sato 2015)
inline const Vec3f carina(0.0f, -3.6f, -87.0f);

[[nodiscard]] float epiglottis_field(const Vec3f& p);

/// Arytenoids, aryepiglottic folds and the body below them, without lumen.
[[nodiscard]] float laryngeal_solid(const Vec3f& p);

struct LaryngealFields {
    float lumen;    ///< from the inlet to both main bronchi
    float wall;     ///< of larynx and trachea, lumen included
    float cricoid;  ///< the ring within the wall
};

/// `solid`: laryngeal_solid() at the point.
[[nodiscard]] LaryngealFields laryngeal_fields(const Vec3f& p, float solid);

}  // namespace eti::patient
