// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

namespace eti::pbd {

/// What a body of clusters is loaded by. Clusters resist every strain alike, so that a bar of them does not
/// grow thinner when it is pulled: their Poisson ratio is 0. Tissue hardly changes its volume (0.45), which
/// makes it the stiffer under an indenter. No one modulus is right for both.
enum class ClusterLoad {
    traction,     ///< pulled or bent; the modulus is that of a bar
    indentation,  ///< pressed by a blade or a sphere of two to five spacings; the modulus is that of the
                  ///< tissue with a Poisson ratio of 0.45 that would push back as hard
    tongue  ///< the patient's tongue under the blade: pushed aside as a whole, its sides being free; the
            ///< modulus is that of finite elements that push back as hard from 4 mm of depth
};

/// How a body is computed, as far as its stiffness depends on it. Clusters are those of the patient: all
/// particles within 2.01 spacings of every second lattice point, one pass per substep.
struct ClusterBody {
    float spacing = 2e-3f;           ///< [m], of the particles
    float density = 4000.0f;         ///< [kg/m^3], of the particles
    float substep = 1.0f / 1440.0f;  ///< [s]
    float thickness = 16e-3f;  ///< [m], across the bar or under the indenter; surfaces are stiffer than the
                               ///< inside, which tells below ten spacings
    ClusterLoad load = ClusterLoad::indentation;
};

/// The modulus to put in for a wanted one.
struct CalibratedModulus {
    float put_in = 0.0f;    ///< [Pa], for ShapeMatching::Description::youngs_modulus
    float measured = 0.0f;  ///< [Pa], what the body then has: the wanted one, or as much as can be had
    bool reached = true;    ///< false: more substeps or larger spacing would be needed
};

/// Young's modulus [Pa] that a body has when `put_in` [Pa] is put in:
///     1 / E = 1 / (c E_in) + substep^2 / (w density spacing^2)
/// The first part is the clusters' geometry; the second, which cannot be exceeded, is what one pass hands on
/// from cluster to cluster. c and w depend on load and thickness only, and were measured over four decades of
/// E substep^2 / (density spacing^2) (docs/charts/calibration.csv); the law departs from the bars by 1 %.
[[nodiscard]] float measured_modulus(const ClusterBody& body, float put_in);

/// The inverse, `wanted` [Pa] above 0. It grows with the wanted modulus; from 90 % of the greatest that can
/// be had it is clamped, as stiffness put in beyond that is hardly felt.
[[nodiscard]] CalibratedModulus calibrated_modulus(const ClusterBody& body, float wanted);

/// The longest substep [s] with which a modulus is reached.
[[nodiscard]] float longest_substep(const ClusterBody& body, float wanted);

}  // namespace eti::pbd
