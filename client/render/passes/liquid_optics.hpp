// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/math/transform.hpp"
#include "common/model/liquid_kind.hpp"

namespace eti::render {

/// Optical properties of a liquid. Overlapping spheres count a path through the liquid this many times.
inline constexpr float sphere_overlap = 4.2f;

struct LiquidOptics {
    Vec3f extinction;  ///< [1/mm] of spheres: attenuation of light from behind (Beer-Lambert)
    float max_depth;   ///< [mm] of spheres: maximum depth, beyond which attenuation is constant
    Vec3f albedo;      ///< of light scattered back
    Vec3f stain;       ///< factor of a film on the tissue's colour
};

[[nodiscard]] inline LiquidOptics optics_of(LiquidKind kind) {
    switch (kind) {
        case LiquidKind::blood: {
            // 150 g/l of haemoglobin, 70 % oxygenated, at 630, 540 and 460 nm: 2.303 times the molar
            // extinction of Prahl's tables (omlc.org/spectra/hemoglobin). The albedo is that of whole blood
            // (Bosschaart et al. 2014, Lasers Med Sci 29:453), which scatters red only. A film is 30 um
            // thick.
            const Vec3f absorbed(0.91f, 27.0f, 20.0f);
            return {absorbed / sphere_overlap, 60.0f, Vec3f(0.10f, 0.008f, 0.009f),
                    (-0.03f * absorbed).array().exp().matrix()};
        }
        case LiquidKind::saliva:
            break;
    }
    // Mucus and froth scatter a little: a sixth of the light per millimetre. A film darkens tissue as water
    // does: scattered light is reflected back at the film's surface.
    return {Vec3f::Constant(0.18f), 5.0f, Vec3f(0.62f, 0.66f, 0.64f), Vec3f::Constant(0.88f)};
}

}  // namespace eti::render
