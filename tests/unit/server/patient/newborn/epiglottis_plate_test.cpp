// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/newborn/build/epiglottis_plate.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <vector>

#include "server/pbd/implicit/implicit_mesh.hpp"

namespace eti::patient {
namespace {

constexpr float plate_length = 20e-3f, plate_width = 10e-3f, plate_thickness = 2e-3f;  // [m]
constexpr float plate_modulus = 40e3f;                                                 // [Pa]

/// A plate in a space without anything else.
class PlateAnatomy final : public Anatomy {
  public:
    [[nodiscard]] Fields fields(const Vec3f& p) const override {
        Fields out;
        out.epiglottis =
            std::max({std::fabs(p.x()) - 0.5f * plate_width, std::fabs(p.z()) - 0.5f * plate_length,
                      std::fabs(p.y()) - 0.5f * plate_thickness});
        return out;
    }
    [[nodiscard]] std::array<Vec3f, landmark_count> landmarks() const override {
        std::array<Vec3f, landmark_count> out{};
        out[static_cast<std::size_t>(Landmark::epiglottis_base)] = {0.0f, 0.0f, -0.5f * plate_length};
        out[static_cast<std::size_t>(Landmark::epiglottis_tip)] = {0.0f, 0.0f, 0.5f * plate_length};
        return out;
    }
    [[nodiscard]] Skeleton skeleton() const override { return {}; }
    [[nodiscard]] BoneWeights bone_weights(const Vec3f&, Tissue) const override { return {}; }
    [[nodiscard]] Vec3f head_growth(const Vec3f&) const override { return Vec3f::Zero(); }
    [[nodiscard]] float shell_field(const Vec3f&, const Fields&) const override { return 1.0f; }
    [[nodiscard]] std::array<Vec3f, 2> bounds() const override { return {}; }
    [[nodiscard]] std::array<Vec3f, 2> airway_bounds() const override { return {}; }
    [[nodiscard]] Vec3f to_model(const Vec3f& point) const override { return point; }
    [[nodiscard]] float scale() const override { return 1e-3f; }
    [[nodiscard]] float weight() const override { return 3.5f; }
};

/// Stiffness [N/m] of the plate's end when its other end is held: force on the end row over its displacement.
double end_stiffness(float spacing) {
    const std::vector<PlateNode> nodes = epiglottis_plate(PlateAnatomy(), spacing);
    std::map<std::array<int, 3>, std::uint32_t> number;
    int last = 0;
    pbd::Particles particles;
    particles.resize(nodes.size());
    for (std::uint32_t n = 0; n < nodes.size(); ++n) {
        number[nodes[n].index] = n;
        last = std::max(last, nodes[n].index[1]);
        particles.rest[n] = particles.position[n] = particles.predicted[n] = nodes[n].position;
        particles.inverse_mass[n] = nodes[n].index[1] == 0 ? 0.0f : 1e9f;  // next to no mass
    }
    pbd::ImplicitMesh::Description mesh;
    for (const auto& [index, n] : number) {
        pbd::Hexahedra::Corners corners{};
        bool whole = true;
        for (int v = 0; v < 8; ++v) {
            const auto found =
                number.find({index[0] + (v & 1), index[1] + (v >> 1 & 1), index[2] + (v >> 2 & 1)});
            whole = whole && found != number.end();
            corners[static_cast<std::size_t>(v)] = whole ? found->second : 0;
        }
        if (whole) {
            mesh.hexahedra.hexahedra.push_back(corners);
        }
    }
    mesh.hexahedra.youngs_modulus.assign(mesh.hexahedra.hexahedra.size(), plate_stiffening * plate_modulus);
    mesh.hexahedra.poisson_ratio = 0.49f;
    pbd::ImplicitMesh solver;
    solver.configure(mesh, particles, particles.inverse_mass);
    solver.settings.iterations = 60;
    // Weak enough to leave the end free to rotate.
    constexpr float aside = 1e-3f;   // [m]
    constexpr float spring = 0.02f;  // [N/m]
    for (std::uint32_t n = 0; n < nodes.size(); ++n) {
        if (nodes[n].index[1] == last) {
            solver.springs.push_back({n, nodes[n].position + aside * Vec3f::UnitY(), spring});
        }
    }
    for (int k = 0; k < 300; ++k) {
        particles.predicted = particles.position;
        solver.solve(particles, 1.0f / 180.0f);
        particles.position = particles.predicted;
    }
    double force = 0.0;
    double moved = 0.0;
    for (const auto& s : solver.springs) {
        const double by = double{particles.position[s.particle].y()} - double{nodes[s.particle].position.y()};
        force += double{spring} * (double{aside} - by);
        moved += by / static_cast<double>(solver.springs.size());
    }
    return force / moved;
}

// Reference: 3 E I / L^3 of a beam, times what independent finite elements of a plate of this length, width
// and thickness add to it at a ratio of 0.49 (docs/solver/references.md). The mesh ends a quarter of the
// thickness within the rim, so that a tenth of the width is missing.
TEST(EpiglottisPlate, BendsLikePlateOfFullThickness) {
    constexpr double plate_over_beam = 1.0925;
    constexpr double held_to_end = plate_length - 0.5 * plate_thickness;
    constexpr double inertia = plate_width * plate_thickness * plate_thickness * plate_thickness / 12.0;
    constexpr double beam = 3.0 * plate_modulus * inertia / (held_to_end * held_to_end * held_to_end);
    EXPECT_NEAR(end_stiffness(1e-3f) / (plate_over_beam * beam), 1.0, 0.12);
}

TEST(EpiglottisPlate, NodesReachSurfacesAtAnySpacing) {
    for (const float spacing : {2e-3f, 1e-3f, 0.5e-3f}) {
        float volume = 0.0f;
        Eigen::AlignedBox3f balls;
        for (const PlateNode& node : epiglottis_plate(PlateAnatomy(), spacing)) {
            volume += node.volume;
            balls.extend(Vec3f(node.position + Vec3f::Constant(node.radius)));
            balls.extend(Vec3f(node.position - Vec3f::Constant(node.radius)));
        }
        const Vec3f size = balls.sizes();
        EXPECT_NEAR(size.x(), plate_width, 0.1e-3f) << spacing;
        EXPECT_NEAR(size.y(), plate_thickness, 0.1e-3f) << spacing;
        EXPECT_NEAR(size.z(), plate_length, 0.1e-3f) << spacing;
        EXPECT_GT(volume, 0.8f * plate_width * plate_thickness * plate_length) << spacing;
    }
}

}  // namespace
}  // namespace eti::patient
