// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "server/pbd/contact/contact.hpp"
#include "server/pbd/fluid/fluid.hpp"
#include "server/pbd/rod/rod.hpp"
#include "server/pbd/soft/links.hpp"
#include "tests/bench/server/accuracy/block_body.hpp"
#include "tests/bench/server/speed/speed_meter.hpp"

namespace eti::bench {

namespace {

// Read per membership: offset and weight (16), index (4), position (16), then index (4) and frame (64).
constexpr double cluster_bytes = 104.0;

struct ClusterPass {
    double ns = 0.0, memberships = 0.0;
};

ClusterPass cluster_pass(SpeedMeter& meter, const test::TetrahedralLattice& lattice) {
    pbd::Particles particles = sheared_particles(lattice);
    const pbd::ShapeMatching::Description description =
        test::lattice_clusters(lattice, std::vector<double>(particles.size(), 3.2e-5),
                               std::vector<double>(particles.size(), 8e-9), BodySettings{}.youngs_modulus);
    pbd::ShapeMatching shapes;
    shapes.configure(description, particles);
    return {meter.fastest([&] { shapes.project(particles, speed_substep); }),
            static_cast<double>(description.member.size())};
}

void constraints(SpeedMeter& meter) {
    // 31 x 31 x 15 particles: as many as in the shipped patient.
    const test::TetrahedralLattice lattice = test::tetrahedral_lattice(30, 30, 14, 2e-3);
    const auto [ns, memberships] = cluster_pass(meter, lattice);
    const double set = memberships * 24.0 + static_cast<double>(lattice.position.size()) * 64.0;
    meter.add("shape matching, per membership", ns / memberships, "ns", cluster_bytes / meter.bandwidth(set));
}

/// A vessel of 14 mm width.
DistanceGrid floor_and_walls() {
    DistanceGrid floor;
    floor.origin = Vec3f::Constant(-0.03f);
    floor.size = {61, 61, 61};
    for (int z = 0; z < 61; ++z) {
        for (int y = 0; y < 61; ++y) {
            for (int x = 0; x < 61; ++x) {
                const Vec3f p = floor.node(x, y, z);
                floor.value.push_back(
                    std::min({p.z() + 0.01f, 0.007f - std::fabs(p.x()), 0.007f - std::fabs(p.y())}));
            }
        }
    }
    return floor;
}

void fluid(SpeedMeter& meter) {
    const DistanceGrid floor = floor_and_walls();
    pbd::FluidSettings settings;
    settings.rest_time = 0.0f;  // all of it awake
    settings.lower = Vec3f::Constant(-0.025f);
    settings.upper = Vec3f::Constant(0.025f);
    pbd::Fluid liquid(settings);
    for (int i = 0; i < 3000; ++i) {
        liquid.add(Vec3f(1e-3f * static_cast<float>(i % 13 - 6), 1e-3f * static_cast<float>(i / 13 % 13 - 6),
                         -9e-3f + 1e-3f * static_cast<float>(i / 169)));
    }
    const pbd::FluidSurroundings surroundings{&floor, {}, {}};
    const auto step = [&] { liquid.step(speed_substep, Vec3f(0, 0, -9.81f), surroundings); };
    for (int i = 0; i < 50; ++i) {
        step();
    }
    const double ns = meter.fastest(step);
    // The kernel's radius is two spacings.
    double pairs = 0.0;
    for (const Vec3f& a : liquid.positions()) {
        for (const Vec3f& b : liquid.positions()) {
            pairs += (a - b).norm() < 2.0f * settings.spacing ? 1.0 : 0.0;
        }
    }
    pairs -= static_cast<double>(liquid.count());
    const double count = static_cast<double>(liquid.count());
    meter.add("fluid, per particle and substep of 5 passes", ns / count, "ns");
    // Slope and index (8) written once, then read with four numbers of the neighbour (16) twice in each pass,
    // and once before them.
    const double bytes = 8.0 + (2 * settings.iterations + 1) * 24.0;
    meter.add("fluid, per neighbour of a particle and substep of 5 passes", ns / pairs, "ns",
              bytes / meter.bandwidth(8.0 * pairs + 200.0 * count));
}

/// Every second of these particles penetrates the obstacle, by up to 2 mm.
void contacts(SpeedMeter& meter) {
    constexpr std::size_t count = 4096;
    std::vector<Vec3f> before(count), predicted(count);
    std::vector<float> sink(count);
    for (std::size_t i = 0; i < count; ++i) {
        const float along = 0.06f * static_cast<float>(i) / count;
        before[i] = Vec3f(0.0f, 3e-3f + 1e-6f * static_cast<float>(i * 7919 % 4000), along);
        predicted[i] = before[i] + Vec3f(1e-5f, 0.0f, 0.0f);
    }
    const pbd::MovingCapsule capsule{Vec3f::Zero(), Vec3f(0, 0, 0.06f), Vec3f::Zero(), Vec3f(0, 0, 0.06f),
                                     4e-3f};
    const double capsule_ns = meter.fastest([&] {
        for (std::size_t i = 0; i < count; ++i) {
            sink[i] = pbd::push_out_of(capsule, before[i], predicted[i], 1e-3f, 0.1f).y();
        }
    });
    meter.add("contact of a capsule with a particle", capsule_ns / count, "ns");

    const DistanceGrid grid = floor_and_walls();
    for (std::size_t i = 0; i < count; ++i) {
        before[i] = Vec3f(1e-6f * static_cast<float>(i), -1e-6f * static_cast<float>(i),
                          -12e-3f + 1e-6f * static_cast<float>(i * 7919 % 4000));
        predicted[i] = before[i] + Vec3f(1e-5f, 0.0f, 0.0f);
    }
    const double grid_ns = meter.fastest([&] {
        for (std::size_t i = 0; i < count; ++i) {
            sink[i] = pbd::push_out_of(grid, before[i], predicted[i], 0.0f, 0.2f).z();
        }
    });
    meter.add("contact of a distance grid with a particle", grid_ns / count, "ns");
}

void rod(SpeedMeter& meter) {
    pbd::Rod tube(Tube{}, pbd::RodSettings{}, {});
    const auto substep = [&](std::span<pbd::RodContact> touching) {
        tube.predict(speed_substep, Vec3f(0, 9.81f, 0), {});
        tube.solve(touching);
        tube.finish();
    };
    const double free = meter.fastest([&] { substep({}); });
    meter.add(fmt::format("tube of {} segments, per substep", tube.size()), 1e-3 * free, "us");
    // Four per segment, all pressed by 0.1 mm.
    std::vector<pbd::RodContact> touching(4 * tube.size());
    for (std::size_t k = 0; k < touching.size(); ++k) {
        touching[k].segment = static_cast<std::uint32_t>(k / 4);
        touching[k].along = 0.125f + 0.25f * static_cast<float>(k % 4);
        touching[k].gap = -1e-4f;
        touching[k].friction = 0.05f;
    }
    const double touched = meter.fastest([&] {
        for (pbd::RodContact& contact : touching) {
            contact.normal = -contact.normal;  // back and forth, so that the tube stays
            contact.force.setZero();
        }
        substep(touching);
    });
    meter.add("contact of the tube, per pass",
              std::max(touched - free, 0.0) / static_cast<double>(touching.size()), "ns");
}

}  // namespace

void measure_parts(SpeedMeter& meter) {
    constraints(meter);
    fluid(meter);
    contacts(meter);
    rod(meter);
}

void measure_scaling(SpeedMeter& meter) {
    for (const int cells : meter.quick() ? std::vector{20} : std::vector{20, 28, 36, 46, 62, 78}) {
        const test::TetrahedralLattice lattice = test::tetrahedral_lattice(cells, cells, cells, 2e-3);
        const double count = static_cast<double>(lattice.position.size());
        const auto [ns, memberships] = cluster_pass(meter, lattice);
        meter.add(fmt::format("clusters of {:.0f} particles, per particle", count), ns / count, "ns",
                  cluster_bytes * memberships / count / meter.bandwidth(24.0 * memberships + 64.0 * count));
    }
}

}  // namespace eti::bench
