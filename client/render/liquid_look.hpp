// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/math/transform.hpp"
#include "common/model/liquid_kind.hpp"

namespace eti::render {

/// What a liquid does to light. Overlapping spheres count a way through the liquid this many times.
inline constexpr float spheres_overlap = 4.2f;

struct LiquidLook {
    Vec3f extinction;  ///< [1/mm] of spheres, by which light from behind fades (Beer-Lambert)
    float deepest;     ///< [mm] of spheres; more is not seen through less
    Vec3f albedo;      ///< of what is scattered back instead
    Vec3f stain;       ///< what a film of it leaves of the tissue's colour
};

[[nodiscard]] inline LiquidLook look_of(LiquidKind kind) {
    switch (kind) {
        case LiquidKind::blood: {
            // 150 g/l of haemoglobin, seven tenths of it with oxygen, at 630, 540 and 460 nm: 2.303 times the
            // molar extinction of Prahl's tables (omlc.org/spectra/hemoglobin). What comes back is that of
            // whole blood (Bosschaart et al. 2014, Lasers Med Sci 29:453), which scatters red alone. A film
            // is 30 um of it.
            const Vec3f absorbed(0.91f, 27.0f, 20.0f);
            return {absorbed / spheres_overlap, 60.0f, Vec3f(0.10f, 0.008f, 0.009f),
                    (-0.03f * absorbed).array().exp().matrix()};
        }
        case LiquidKind::saliva:
            break;
    }
    // Mucus and froth scatter a little: a sixth of the light within a millimetre. A film darkens, as water
    // does: light that tissue scatters is thrown back at the film's surface.
    return {Vec3f::Constant(0.18f), 5.0f, Vec3f(0.62f, 0.66f, 0.64f), Vec3f::Constant(0.88f)};
}

}  // namespace eti::render
