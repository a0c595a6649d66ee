// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <fmt/format.h>

#include <cmath>
#include <iostream>

#include "tests/bench/server/matter/block.hpp"
#include "tests/bench/server/matter/matter.hpp"
#include "tests/bench/server/matter/tissue_volume.hpp"

namespace eti::bench {

namespace {

const char* name_of(Element element) {
    return element == Element::tetrahedra ? "tetrahedra" : "hexahedra";
}

/// References: tests/validation/references/blade.json.
void press_blade(const BlockSettings& base, double nu, double cell, const std::vector<double>& reference) {
    BlockSettings settings = base;
    settings.poisson_ratio = nu;
    settings.cell = cell;
    Block block(settings);
    block.hold([](const Vec3d& x) { return x.z() < 1e-9; });
    block.start();
    const std::vector<double> depths = {0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0};
    std::cout << fmt::format("blade {} nu {} cell {:.2f}:", name_of(settings.element), nu, 1e3 * cell);
    double at = 0.0;
    for (std::size_t k = 0; k < depths.size(); ++k) {
        while (at < depths[k] - 1e-9) {
            at = std::min(at + 0.05, depths[k]);
            const double z = 10e-3 + 5e-3 - 1e-3 * at;
            block.place_capsule({-40e-3, 10e-3, z}, {60e-3, 10e-3, z}, 5e-3);
            block.step();
        }
        const int steps = block.settle(2e-5, 600);
        const double force = -block.contact_force().z();
        const TissueVolume v =
            volume_of(block.tetrahedra(), block.particles().rest, block.particles().position, 1.0);
        std::cout << fmt::format(" {:.3f}({:+.1f}%,inv{},n{})", force, 100.0 * (force / reference[k] - 1.0),
                                 v.inverted, steps)
                  << std::flush;
    }
    std::cout << std::endl;
}

void press_sphere(const BlockSettings& base, double nu, double cell, const std::vector<double>& reference) {
    BlockSettings settings = base;
    settings.size = {40e-3, 40e-3, 20e-3};
    settings.youngs_modulus = 15e3;
    settings.poisson_ratio = nu;
    settings.cell = cell;
    Block block(settings);
    block.hold([](const Vec3d& x) { return x.z() < 1e-9; });
    block.start();
    std::cout << fmt::format("sphere {} nu {} cell {:.2f}:", name_of(settings.element), nu, 1e3 * cell);
    double at = 0.0;
    for (std::size_t k = 0; k < reference.size(); ++k) {
        const double depth = static_cast<double>(k + 1);
        while (at < depth - 1e-9) {
            at = std::min(at + 0.05, depth);
            const Vec3d middle(20e-3, 20e-3, 20e-3 + 10e-3 - 1e-3 * at);
            block.place_capsule(middle, middle, 10e-3);
            block.step();
        }
        const int steps = block.settle(2e-5, 600);
        const double force = -block.contact_force().z();
        std::cout << fmt::format(" {:.4f}({:+.1f}%,n{})", force, 100.0 * (force / reference[k] - 1.0), steps)
                  << std::flush;
    }
    std::cout << std::endl;
}

void sag_bar(const BlockSettings& base, double nu, double cell, double reference) {
    BlockSettings settings = base;
    settings.size = {40e-3, 10e-3, 10e-3};
    settings.youngs_modulus = 15e3;
    settings.poisson_ratio = nu;
    settings.cell = cell;
    Block block(settings);
    block.hold([](const Vec3d& x) { return x.x() < 1e-9; });
    block.start();
    block.gravity = Vec3d(0, 0, -9.81);
    const int steps = block.settle(1e-5, 4000);
    double tip = 0.0;
    int count = 0;
    for (std::size_t i = 0; i < block.rest().size(); ++i) {
        if (block.rest()[i].x() > 40e-3 - 1e-9) {
            tip += block.rest()[i].z() - static_cast<double>(block.particles().position[i].z());
            ++count;
        }
    }
    tip *= 1e3 / count;
    std::cout << fmt::format("bar {} nu {} cell {:.2f}: {:.3f} ({:+.1f}%, n {})", name_of(settings.element),
                             nu, 1e3 * cell, tip, 100.0 * (tip / reference - 1.0), steps)
              << std::endl;
}

}  // namespace

int matter_blocks(const std::string& only) {
    const std::vector<double> blade45 = {0.0541831, 0.130149, 0.220432, 0.327572, 0.58069, 0.887782, 1.24587};
    const std::vector<double> blade49 = {0.0566812, 0.135436, 0.232534, 0.344566,
                                         0.615157,  0.951231, 1.37008};
    const std::vector<double> sphere45 = {0.0901058, 0.26864, 0.511437, 0.807677, 1.14995};
    const std::vector<double> sphere49 = {0.0944252, 0.280683, 0.532824, 0.841011, 1.19539};
    for (const Element element : {Element::hexahedra, Element::tetrahedra}) {
        BlockSettings base;
        base.element = element;
        if (only.empty() || only == "blade") {
            for (const double cell : {2.5e-3, 2e-3, 1.25e-3}) {
                press_blade(base, 0.45, cell, blade45);
                press_blade(base, 0.49, cell, blade49);
            }
        }
        if (only.empty() || only == "bar") {
            for (const double cell : {5e-3, 2.5e-3}) {
                sag_bar(base, 0.45, cell, 21.12);
                sag_bar(base, 0.49, cell, 20.99);
            }
        }
        if (only.empty() || only == "sphere") {
            for (const double cell : {5e-3, 2.5e-3}) {
                press_sphere(base, 0.45, cell, sphere45);
                press_sphere(base, 0.49, cell, sphere49);
            }
        }
    }
    return 0;
}

}  // namespace eti::bench
