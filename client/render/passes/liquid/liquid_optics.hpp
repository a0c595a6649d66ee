// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/math/transform.hpp"
#include "common/model/liquid_kind.hpp"

namespace eti::render {

/// Optical properties of a liquid.
struct LiquidOptics {
    Vec3f extinction;    ///< [1/mm], attenuation of light from behind (Beer-Lambert)
    float max_depth;     ///< [mm], beyond which attenuation is constant
    Vec3f albedo;        ///< of a deep layer: light scattered back
    Vec3f froth;         ///< albedo of foam, whose many films scatter more
    Vec3f stain;         ///< factor of a film on the tissue's colour
    bool casts_shadows;  ///< whether a drop absorbs enough light
};

[[nodiscard]] inline LiquidOptics optics_of(LiquidKind kind) {
    switch (kind) {
        case LiquidKind::blood: {
            // 150 g/l of haemoglobin, 70 % oxygenated, at 630, 540 and 460 nm: 2.303 times the molar
            // extinction of Prahl's tables (omlc.org/spectra/hemoglobin). In a layer, scattering lengthens
            // the path: the attenuation is that of diffusion, sqrt(3 a (a + s)), with a reduced scattering of
            // 1.5/mm (whole blood; Bosschaart et al. 2014, Lasers Med Sci 29:453). The albedo, of red only,
            // is from the same source. A film is 30 um thick, and light passes it twice.
            const Vec3f absorbed(0.91f, 27.0f, 20.0f);
            const Vec3f attenuated = (3.0f * absorbed.array() * (absorbed.array() + 1.5f)).sqrt().matrix();
            return {attenuated,
                    14.0f,
                    Vec3f(0.10f, 0.008f, 0.009f),
                    Vec3f(0.36f, 0.05f, 0.05f),
                    (-2.0f * 0.03f * absorbed).array().exp().matrix(),
                    true};
        }
        case LiquidKind::saliva:
            break;
    }
    // Mucus scatters a little: a third of the light per millimetre. A film darkens tissue as water does:
    // scattered light is reflected back at the film's surface.
    return {Vec3f::Constant(0.36f), 1.2f, Vec3f(0.25f, 0.265f, 0.258f), Vec3f(0.80f, 0.85f, 0.83f),
            Vec3f::Constant(0.88f), false};
}

}  // namespace eti::render
