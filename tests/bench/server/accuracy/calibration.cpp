// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "tests/bench/server/accuracy/calibration.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <cmath>

#include "tests/bench/server/accuracy/indentation.hpp"
#include "tests/bench/server/table.hpp"

namespace eti::bench {

namespace {

struct Measured {
    double modulus = 0.0;  ///< [Pa]
    double poisson = 0.0;
};

/// A bar of 40 x 10 x 10 mm under a traction that stretches it by a few per cent, measured over the middle
/// half of its length.
Measured pull(const BodySettings& setting) {
    BlockBody body(40, 10, 10, setting);
    const test::TetrahedralLattice& lattice = body.lattice();
    for (std::size_t i = 0; i < lattice.position.size(); ++i) {
        if (lattice.position[i].x() < 1e-9) {
            body.hold(i);
        }
    }
    // A pass propagates at most about half of density (cell / substep)^2.
    const double dt = setting.step / setting.substeps;
    const double most = 0.5 * particle_density * std::pow(setting.cell / dt, 2);
    const double stress = 0.03 / (1.0 / setting.youngs_modulus + 1.0 / most);
    body.force = test::end_traction(lattice, lattice.nx, {stress, 0, 0});
    body.settle(2.5);
    const auto place = [&](int x, int y, int z) {
        return Vec3d(body.particles().position[lattice.index(x, y, z)].cast<double>());
    };
    const auto section = [&](int x) {
        double sum = 0.0;
        for (int z = 0; z <= lattice.nz; ++z) {
            for (int y = 0; y <= lattice.ny; ++y) {
                sum += place(x, y, z).x();
            }
        }
        return sum / ((lattice.ny + 1) * (lattice.nz + 1));
    };
    const double length = 0.5 * lattice.nx * lattice.cell;
    const double along = (section(3 * lattice.nx / 4) - section(lattice.nx / 4)) / length - 1.0;
    double width = 0.0;
    for (int z = 0; z <= lattice.nz; ++z) {
        width += place(lattice.nx / 2, lattice.ny, z).y() - place(lattice.nx / 2, 0, z).y();
    }
    const double across = width / ((lattice.nz + 1) * lattice.ny * lattice.cell) - 1.0;
    return {stress / along, -across / along};
}

constexpr double block_depth = 1.5e-3;  // [m]

/// A block of 20 x 20 x 10 mm, pressed in by block_depth: the modulus of the material with a Poisson ratio of
/// 0.45 that would give the same force.
class Block {
  public:
    explicit Block(bool sphere, double radius = blade_radius)
        : indenter_{.sphere = sphere, .x = 10e-3, .y = 10e-3, .radius = radius},
          force_(reference_force(indenter_, block_depth)) {}
    [[nodiscard]] Measured press(const BodySettings& setting) const {
        BlockBody body(20, 20, 10, setting);
        const double force = bench::press(body, indenter_, block_depth, false);
        return {force / force_ * BodySettings{}.youngs_modulus, reference_ratio};
    }

  private:
    Indenter indenter_;
    double force_;  // [N]
};

/// A sphere of 16 spacings pressed in by one and a quarter, compared with the closed form.
Measured press_lightly(const BodySettings& setting) {
    const HertzBlock block(setting.cell);
    BlockBody body(block.side_mm, block.side_mm, block.side_mm, setting);
    const double depth = 1.25 * setting.cell;
    const double force = press(body, block.sphere, depth, true);
    return {force / block.force(depth, BodySettings{}.youngs_modulus) * BodySettings{}.youngs_modulus,
            reference_ratio};
}

}  // namespace

int calibration(const CalibrationOptions& options) {
    Table table(options.out, "calibration.csv",
                "load,radius_spacings,spacing_mm,substeps,modulus_put_in_pa,group,modulus_measured_pa,ratio,"
                "poisson_ratio");
    const auto add = [&](std::string_view load, const BodySettings& s, const Measured& m) {
        const double dt = s.step / s.substeps;
        table.row(fmt::format("{},{:g},{:g},{},{:g},{:.5g},{:.5g},{:.5g},{:.4f}", load, s.cluster_radius,
                              1e3 * s.cell, s.substeps, s.youngs_modulus,
                              s.youngs_modulus * dt * dt / (particle_density * s.cell * s.cell), m.modulus,
                              m.modulus / s.youngs_modulus, m.poisson));
    };
    const std::vector<double> moduli =
        options.quick ? std::vector{8e3} : std::vector{2e3, 8e3, 32e3, 128e3, 512e3};
    const std::vector<int> counts = options.quick ? std::vector{8} : std::vector{2, 4, 8, 16};
    const auto sweep = [&](double radius, const std::vector<double>& cells, const auto& measure) {
        for (const double cell : cells) {
            for (const int substeps : counts) {
                for (const double modulus : moduli) {
                    BodySettings setting{Method::shape_matching_xpbd, cell, substeps, 1};
                    setting.youngs_modulus = modulus;
                    setting.cluster_radius = radius;
                    measure(setting);
                }
            }
        }
    };
    for (const double radius : options.quick ? std::vector{test::patient_radius}
                                             : std::vector{test::cube_radius, test::patient_radius, 2.5}) {
        sweep(radius, options.quick ? std::vector{5e-3} : std::vector{5e-3, 2.5e-3, 1.25e-3},
              [&](const BodySettings& s) { add("traction", s, pull(s)); });
        spdlog::info("traction of clusters that reach {} spacings done", radius);
    }
    if (!options.quick) {
        for (const bool sphere : {true, false}) {
            const Block block(sphere);
            for (const double radius : {test::cube_radius, test::patient_radius}) {
                sweep(radius, {2.5e-3, 1.25e-3},
                      [&](const BodySettings& s) { add(sphere ? "sphere" : "blade", s, block.press(s)); });
            }
        }
        // Not fitted: shows how far the constants transfer to another indenter.
        const Block narrow(false, 0.6 * blade_radius);
        sweep(test::patient_radius, {2.5e-3, 1.25e-3},
              [&](const BodySettings& s) { add("narrow blade", s, narrow.press(s)); });
        for (const double radius : {test::cube_radius, test::patient_radius}) {
            sweep(radius, {2.5e-3}, [&](const BodySettings& s) { add("hertz", s, press_lightly(s)); });
        }
    }
    spdlog::info("wrote {}", table.path().string());
    return 0;
}

}  // namespace eti::bench
