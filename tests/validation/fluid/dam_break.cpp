// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "tests/validation/fluid/dam_break.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

namespace eti::test {

namespace {

constexpr float width = 57.15e-3f;  // [m], 2.25 in
constexpr float gravity = 9.81f;

}  // namespace

DistanceGrid vessel(const Vec3f& inside, float spacing) {
    constexpr int margin = 4;
    DistanceGrid grid;
    grid.spacing = spacing;
    grid.origin = Vec3f::Constant(-margin * spacing);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        grid.size[axis] =
            static_cast<int>(std::ceil(inside[static_cast<Eigen::Index>(axis)] / spacing)) + 2 * margin + 1;
    }
    for (int z = 0; z < grid.size[2]; ++z) {
        for (int y = 0; y < grid.size[1]; ++y) {
            for (int x = 0; x < grid.size[0]; ++x) {
                const Vec3f at = grid.node(x, y, z);
                grid.value.push_back(
                    std::min({at.x(), inside.x() - at.x(), at.y(), inside.y() - at.y(), at.z()}));
            }
        }
    }
    return grid;
}

float DamBreak::error() const {
    float squared = 0.0f;
    for (std::size_t k = 0; k < martin_and_moyce.size(); ++k) {
        const float off = fronts[k] / martin_and_moyce[k].front - 1.0f;
        squared += off * off;
    }
    return std::sqrt(squared / static_cast<float>(martin_and_moyce.size()));
}

DamBreak dam_break(int columns, int deep, float dt, int iterations) {
    pbd::FluidSettings settings;
    settings.iterations = iterations;
    settings.spacing = width / static_cast<float>(columns);
    settings.capacity = static_cast<std::size_t>(2 * columns * columns * deep);
    settings.lower = Vec3f::Constant(-5.0f * settings.spacing);
    const Vec3f inside(11.0f * width, static_cast<float>(deep) * settings.spacing, 3.0f * width);
    settings.upper = inside + Vec3f::Constant(5.0f * settings.spacing);
    settings.surface_tension = 0.0f;  // Bond number rho g a^2 / tension is 440
    settings.viscosity = 1e-6f;       // water
    settings.wall_viscosity = 0.0f;   // the boundary layer, 0.6 mm after 0.37 s, is thinner than a particle
    settings.sound_speed = 20.0f;     // ten times the front's speed
    settings.max_speed = 5.0f;
    pbd::Fluid fluid(settings);
    for (int z = 0; z < 2 * columns; ++z) {
        for (int y = 0; y < deep; ++y) {
            for (int x = 0; x < columns; ++x) {
                fluid.add(settings.spacing *
                          (Vec3f(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)) +
                           Vec3f::Constant(0.5f)));
            }
        }
    }
    const Vec3f down(0.0f, 0.0f, -gravity);
    pbd::FluidSurroundings surroundings;
    // Settles behind the gate, as in the experiment.
    const DistanceGrid closed = vessel(Vec3f(width, inside.y(), inside.z()), settings.spacing);
    surroundings.solid = &closed;
    int substeps = 0;
    for (; static_cast<float>(substeps) * dt < 0.3f; ++substeps) {
        fluid.step(dt, down, surroundings);
    }
    const DistanceGrid solid = vessel(inside, settings.spacing);
    surroundings.solid = &solid;

    DamBreak result;
    result.particles = fluid.count();
    std::vector<float> x;
    const auto front = [&] {
        x.resize(fluid.count());
        // The front is where as many particles as fit side by side have passed; drops ahead of it do not
        // count.
        for (std::size_t i = 0; i < x.size(); ++i) {
            x[i] = fluid.positions()[i].x();
        }
        const auto last = x.begin() + deep - 1;
        std::nth_element(x.begin(), last, x.end(), std::greater<>());
        return (*last + 0.5f * settings.spacing) / width;
    };
    float before = front();
    for (int n = 1; result.fronts.size() < martin_and_moyce.size(); ++n) {
        fluid.step(dt, down, surroundings);
        ++substeps;
        const float now = front();
        const float time = static_cast<float>(n) * dt * std::sqrt(2.0f * gravity / width);
        const float step = dt * std::sqrt(2.0f * gravity / width);
        while (result.fronts.size() < martin_and_moyce.size() &&
               martin_and_moyce[result.fronts.size()].time <= time) {
            const float part = (martin_and_moyce[result.fronts.size()].time - (time - step)) / step;
            result.fronts.push_back(before + part * (now - before));
        }
        before = now;
    }
    result.lost = result.particles - fluid.count();
    result.simulated = static_cast<double>(substeps) * static_cast<double>(dt);
    return result;
}

}  // namespace eti::test
