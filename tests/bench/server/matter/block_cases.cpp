// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "tests/bench/server/matter/block_cases.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "tests/bench/server/matter/block.hpp"
#include "tests/bench/server/matter/lift_path.hpp"

namespace eti::bench {

namespace {

using Json = nlohmann::ordered_json;

constexpr double approach = 0.05e-3;  // [m] per step
constexpr double slow = 2e-5;         // [m/s], of what has come to rest
constexpr int patience = 600;         // [steps]

/// Solutions by independent finite elements (docs/solver/references.md).
Json reference_of(const std::string& name) {
    const std::filesystem::path file = source_file("tests/validation/references/" + name + ".json");
    std::ifstream in(file);
    if (!in) {
        throw std::runtime_error("cannot read " + file.lexically_normal().string() +
                                 "; run eti-bench from the folder that it was built from");
    }
    return Json::parse(in);
}

/// Rows of one ratio.
std::vector<Json> at_ratio(const Json& reference, double nu) {
    std::vector<Json> rows;
    for (const Json& row : reference.at("results")) {
        if (std::fabs(row.at("nu").get<double>() - nu) < 1e-6) {
            rows.push_back(row);
        }
    }
    return rows;
}

Json row_of(const std::string& name, const BlockSettings& settings, double depth, double value,
            double reference, int steps) {
    return {{"case", name},
            {"element", settings.element == Element::tetrahedra ? "tetrahedra" : "hexahedra"},
            {"nu", settings.poisson_ratio},
            {"cell_mm", 1e3 * settings.cell},
            {"depth_mm", depth},
            {"value", value},
            {"reference", reference},
            {"error", value / reference - 1.0},
            {"steps_to_rest", steps}};
}

/// A capsule or, with equal ends, a sphere, pressed into the middle of the block's top to each reference
/// depth. `axis` [m]: half of the capsule's axis.
void press(const std::string& name, BlockSettings settings, const Vec3d& axis, double radius, Json& out) {
    const Json reference = reference_of(name);
    settings.youngs_modulus = reference.at("young_pa").get<double>();
    Block block(settings);
    block.hold([](const Vec3d& x) { return x.z() < 1e-9; });
    block.start();
    const Vec3d top(0.5 * settings.size[0], 0.5 * settings.size[1], settings.size[2]);
    double depth = 0.0;
    for (const Json& row : at_ratio(reference, settings.poisson_ratio)) {
        const double wanted = 1e-3 * row.at("depth_mm").get<double>();
        while (depth < wanted - 1e-9) {
            depth = std::min(depth + approach, wanted);
            const Vec3d middle = top + Vec3d(0, 0, radius - depth);
            block.place_capsule(middle - axis, middle + axis, radius);
            block.step();
        }
        const int steps = block.settle(slow, patience);
        Json result = row_of(name, settings, 1e3 * depth, -block.contact_force().z(),
                             row.at("force_n").get<double>(), steps);
        if (row.contains("displacements_mm")) {
            double squared = 0.0;
            double whole = 0.0;
            const Json& points = reference.at("points_mm");
            for (std::size_t k = 0; k < points.size(); ++k) {
                const auto vector = [](const Json& of) {
                    return Vec3d(1e-3 * Vec3d(of[0].get<double>(), of[1].get<double>(), of[2].get<double>()));
                };
                // The reference's origin is below the middle of the top.
                const Vec3d at = vector(points[k]) + Vec3d(top.x(), top.y(), 0.0);
                const Vec3d expected = vector(row.at("displacements_mm")[k]);
                squared += (block.displacement_at(at) - expected).squaredNorm();
                whole += expected.squaredNorm();
            }
            result["shape_error"] = std::sqrt(squared / whole);
        }
        out.push_back(std::move(result));
    }
}

void sag(BlockSettings settings, Json& out) {
    settings.size = {40e-3, 10e-3, 10e-3};
    settings.youngs_modulus = 15e3;
    Block block(settings);
    block.hold([](const Vec3d& x) { return x.x() < 1e-9; });
    block.start();
    block.gravity = Vec3d(0, 0, -9.81);
    const int steps = block.settle(1e-5, 4000);
    const double tip = -1e3 * block.displacement_at({40e-3, 5e-3, 5e-3}).z();
    const std::vector<Json> rows = at_ratio(reference_of("bar"), settings.poisson_ratio);
    out.push_back(row_of("bar", settings, 0.0, tip, rows.front().at("sag_mm").get<double>(), steps));
}

}  // namespace

Json reference_blocks(bool quick) {
    Json out = Json::array();
    const std::vector<Element> elements =
        quick ? std::vector{Element::hexahedra} : std::vector{Element::tetrahedra, Element::hexahedra};
    for (const Element element : elements) {
        for (const double nu : {0.45, 0.49}) {
            BlockSettings settings;
            settings.element = element;
            settings.poisson_ratio = nu;
            settings.cell = 2.5e-3;
            sag(settings, out);
            settings.size = {40e-3, 40e-3, 20e-3};
            press("sphere", settings, Vec3d::Zero(), 10e-3, out);
            settings.size = {20e-3, 20e-3, 10e-3};
            for (const double cell : {2.5e-3, 2e-3, 1.25e-3}) {
                if (!quick || cell == 2e-3) {
                    settings.cell = cell;
                    press("blade", settings, {40e-3, 0, 0}, 5e-3, out);
                }
            }
        }
    }
    return out;
}

}  // namespace eti::bench
