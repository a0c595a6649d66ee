// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <chrono>
#include <cmath>
#include <vector>

#include "common/model/pace.hpp"
#include "tests/bench/server/accuracy/accuracy_table.hpp"
#include "tests/support/elastica.hpp"
#include "tests/support/rod_fixture.hpp"

namespace eti::bench {

namespace {

constexpr std::string_view rod_method = "rod";

double since(std::chrono::steady_clock::time_point before) {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - before).count();
}

/// 0.05 N across the tip; compared by the tip's position.
AccuracyRow cantilever(int segments, int substeps) {
    static const Tube tube = test::cantilever();
    constexpr double across = 0.05;  // [N]
    static const test::Elastica elastica = {.length = double{tube.length},
                                            .stiffness = double{tube.bending_stiffness()},
                                            .rest_curvature = 0.0,
                                            .tip_force = {0.0, across},
                                            .weight = {0.0, 0.0}};
    static const test::ElasticaEnd expected = test::solve(elastica);
    pbd::Rod rod(tube, test::damped(segments), {});
    const auto before = std::chrono::steady_clock::now();
    test::run(rod, test::settled, static_cast<float>(1.0 / (steps_per_second * substeps)), Vec3f::Zero(), {},
              Vec3f(0.0f, static_cast<float>(across), 0.0f));
    const double wall = since(before);
    const Eigen::Vector2d tip(static_cast<double>(rod.tip().z()), static_cast<double>(rod.tip().y()));
    const double moved = (expected.tip - Eigen::Vector2d(elastica.length, 0.0)).norm();
    return {.name = "tube",
            .method = rod_method,
            .error = (tip - expected.tip).norm() / moved,
            .frame_ms = wall / (test::settled * 90.0)};
}

struct Site {
    std::uint32_t segment = 0;
    float along = 0.0f;
};

/// The point of a rod at this arc length [m] from its rear end.
Site site_at(const pbd::Rod& rod, double arc) {
    Site site;
    while (arc > static_cast<double>(rod.length(site.segment)) && site.segment + 1 < rod.size()) {
        arc -= static_cast<double>(rod.length(site.segment++));
    }
    site.along = static_cast<float>(arc) / rod.length(site.segment);
    return site;
}

/// A straight free tube on two supports at an eighth of its length from either end, pressed down midway; the
/// force over the resulting deflection is compared with 48 E I / span^3. Slopes of a fortieth are small
/// enough: they change that by less than a thousandth.
AccuracyRow three_point_bending(int segments, int substeps) {
    const Tube tube = test::cantilever();
    constexpr double force = 0.01;  // [N]
    const double span = 0.75 * double{tube.length};
    pbd::RodSettings settings = test::damped(segments);
    settings.held = false;
    settings.connector_mass = 0.0f;
    pbd::Rod rod(tube, settings, {});
    const Site left = site_at(rod, 0.5 * (double{tube.length} - span));
    const Site middle = site_at(rod, 0.5 * double{tube.length});
    const Site right = site_at(rod, 0.5 * (double{tube.length} + span));
    std::vector<pbd::RodContact> supports(2);
    supports[0].segment = left.segment;
    supports[0].along = left.along;
    supports[1].segment = right.segment;
    supports[1].along = right.along;
    const auto height = [&](const Site& site) {
        return static_cast<double>(rod.point(site.segment, site.along).y());
    };
    const auto dt = static_cast<float>(1.0 / (steps_per_second * substeps));
    const auto before = std::chrono::steady_clock::now();
    for (double time = 0.0; time < test::settled; time += double{dt}) {
        rod.predict(dt, Vec3f::Zero(), {});
        rod.load(middle.segment, middle.along, Vec3f(0.0f, static_cast<float>(-force), 0.0f));
        for (int pass = 0; pass < 2; ++pass) {
            for (pbd::RodContact& support : supports) {
                support.gap = rod.point(support.segment, support.along).y();
            }
            rod.solve(supports);
        }
        rod.finish();
    }
    const double deflection = 0.5 * (height(left) + height(right)) - height(middle);
    const double stiffness = 48.0 * double{tube.bending_stiffness()} / std::pow(span, 3);
    return {.name = "tube-bending",
            .method = rod_method,
            .error = std::fabs(force / deflection / stiffness - 1.0),
            .frame_ms = since(before) / (test::settled * 90.0)};
}

}  // namespace

void bend_tubes(AccuracyTable& table, bool quick) {
    for (const auto& bend : {cantilever, three_point_bending}) {
        for (const int segments : quick ? std::vector{8} : std::vector{8, 16, 32, 64}) {
            for (const int substeps : quick ? std::vector{8} : std::vector{1, 2, 4, 8, 16}) {
                if (!table.shard().claim_next()) {
                    continue;
                }
                AccuracyRow row = bend(segments, substeps);
                row.spacing = double{Tube{}.length} / segments;
                row.substeps = substeps;
                row.particles = static_cast<std::size_t>(segments);
                table.add(row);
            }
        }
    }
}

}  // namespace eti::bench
