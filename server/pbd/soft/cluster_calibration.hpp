// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

namespace eti::pbd {

/// Load case of a body of clusters. Clusters resist all strains equally, so that a stretched bar does not
/// contract laterally: their Poisson ratio is 0. Tissue is nearly incompressible (0.45), hence stiffer under
/// an indenter. No single modulus fits both.
enum class ClusterLoad {
    traction,     ///< stretched or bent; the modulus is that of a bar
    indentation,  ///< pressed by a blade or a sphere of two to five spacings; the modulus is that of
                  ///< tissue with a Poisson ratio of 0.45 and the same reaction force
    tongue        ///< the patient's tongue under the blade: displaced as a whole, with free sides; the
                  ///< modulus is that of finite elements with the same reaction from 4 mm of depth
};

/// Discretisation of a body, as far as its stiffness depends on it. Clusters are the patient's: all particles
/// within 2.01 spacings of every second lattice point, one pass per substep.
struct ClusterBody {
    float spacing = 2e-3f;           ///< [m], of the particles
    float density = 4000.0f;         ///< [kg/m^3], of the particles
    float substep = 1.0f / 1440.0f;  ///< [s]
    float thickness = 16e-3f;  ///< [m], across the bar or under the indenter. Surfaces are stiffer than the
                               ///< interior, which is noticeable below ten spacings
    ClusterLoad load = ClusterLoad::indentation;
};

/// Input modulus for a desired one.
struct CalibratedModulus {
    float input_modulus = 0.0f;  ///< [Pa], for ShapeMatching::Description::youngs_modulus
    float measured = 0.0f;       ///< [Pa], resulting modulus: the desired one, or the largest attainable
    bool reached = true;         ///< false: needs more substeps or larger spacing
};

/// Input modulus E_in [Pa] for which a body has the Young's modulus `wanted` [Pa], above 0; monotonic:
///     1 / E = 1 / (c E_in) + substep^2 / (w density spacing^2)
/// The first term is the clusters' geometry. The second is what one pass transmits from cluster to cluster;
/// it bounds E. c and w depend on load and thickness only, and were measured over four decades of E substep^2
/// / (density spacing^2) (docs/charts/calibration.csv). The bars deviate from the law by 1 %. Clamped from 90
/// % of the largest attainable modulus, beyond which more input stiffness has little effect.
[[nodiscard]] CalibratedModulus calibrated_modulus(const ClusterBody& body, float wanted);

}  // namespace eti::pbd
