// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/math/smoothstep.hpp"
#include "common/math/units.hpp"
#include "common/model/tools/blade_clearance_deformer.hpp"

namespace eti {

namespace {

// The whole laryngoscope is one section swept down the handle, round the heel and along the blade, so its
// surface is closed by construction. A section is `columns` pairs of points, upper and lower.
constexpr int columns = 12;
constexpr float pi = std::numbers::pi_v<float>;

struct Section {
    std::array<Eigen::Vector2f, columns> upper, lower;  ///< (left, towards the tongue) [m]
};

Section blended(const Section& a, const Section& b, float share) {
    Section result;
    for (int i = 0; i < columns; ++i) {
        result.upper[i] = (1 - share) * a.upper[i] + share * b.upper[i];
        result.lower[i] = (1 - share) * a.lower[i] + share * b.lower[i];
    }
    return result;
}

Section round_section(float radius) {
    Section section;
    for (int i = 0; i < columns; ++i) {
        const float angle = pi * (1.0f - (static_cast<float>(i) + 0.5f) / columns);
        section.upper[i] = radius * Eigen::Vector2f(std::cos(angle), std::sin(angle));
        section.lower[i] = radius * Eigen::Vector2f(std::cos(angle), -std::sin(angle));
    }
    return section;
}

// The plate, its crown at zero height. The flange is on the patient's left, where it holds back the swept
// tongue; the right stays open for view and tube.
Section plate_section(float width, float thickness, float crown, float flange) {
    const float half = 0.5f * width;
    const float wall = 0.12f * width;
    Section section;
    for (int i = 0; i < columns; ++i) {
        const int last = columns - 1;
        // All columns but the last two span the plate; those two are the flange.
        const float x = i == last       ? half
                        : i == last - 1 ? half - wall
                                        : -half + (width - 1.35f * wall) * static_cast<float>(i) /
                                                      static_cast<float>(last - 2);
        const float top = -crown * (x / half) * (x / half);
        section.upper[i] = {x, top};
        section.lower[i] = {x, top - thickness - (i >= last - 1 ? flange : 0.0f)};
    }
    return section;
}

class Sweep {
  public:
    // `origin` and the direction of the section's height; its width runs along +x.
    void add(const Section& section, const Vec3f& origin, const Vec3f& height) {
        const auto place = [&](const Eigen::Vector2f& p) {
            mesh_.vertices.push_back(origin + p.x() * Vec3f::UnitX() + p.y() * height);
        };
        for (int i = 0; i < columns; ++i) {
            place(section.upper[i]);
        }
        for (int i = columns - 1; i >= 0; --i) {
            place(section.lower[i]);
        }
        const auto rings = static_cast<std::uint32_t>(mesh_.vertices.size() / ring);
        if (rings < 2) {
            return;
        }
        const std::uint32_t now = (rings - 1) * ring;
        const std::uint32_t before = now - ring;
        for (std::uint32_t i = 0; i < ring; ++i) {
            const std::uint32_t next = (i + 1) % ring;
            mesh_.triangles.push_back({before + i, now + i, now + next});
            mesh_.triangles.push_back({before + i, now + next, before + next});
        }
    }

    [[nodiscard]] TriangleMesh closed() && {
        cap(0, false);
        cap(static_cast<std::uint32_t>(mesh_.vertices.size()) - ring, true);
        return std::move(mesh_);
    }

  private:
    static constexpr std::uint32_t ring = 2 * columns;

    void cap(std::uint32_t first, bool end) {
        for (std::uint32_t i = 0; i + 1 < columns; ++i) {
            const std::uint32_t upper = first + i;
            const std::uint32_t lower = first + ring - 1 - i;
            std::array<Triangle, 2> pair{Triangle{upper, upper + 1, lower - 1},
                                         Triangle{upper, lower - 1, lower}};
            for (Triangle& t : pair) {
                if (end) {
                    std::swap(t[1], t[2]);
                }
                mesh_.triangles.push_back(t);
            }
        }
    }

    TriangleMesh mesh_;
};

void add_handle(Sweep& sweep, const Capsule& handle) {
    const float top = handle.b.y() + handle.radius;
    // Edge rounded over 2 mm; below, the shaft narrows to the heel.
    const std::array<std::array<float, 2>, 7> profile = {{{top, 7.0f},
                                                          {top - 0.7f * millimetre, 8.3f},
                                                          {top - 2.0f * millimetre, 9.0f},
                                                          {0.5f * top, 9.0f},
                                                          {24.0f * millimetre, 9.0f},
                                                          {17.0f * millimetre, 7.0f},
                                                          {13.0f * millimetre, 5.2f}}};
    for (const auto& [height, radius] : profile) {
        sweep.add(round_section(radius * millimetre), Vec3f(0, height, 0), Vec3f::UnitZ());
    }
}

}  // namespace

TriangleMesh laryngoscope_mesh(const Laryngoscope& scope) {
    const BladePlate blade = plate_of(scope);
    constexpr float thickness = 1.5f * millimetre;
    constexpr float flange = 2.5f * millimetre;
    const float length = blade.length;

    Sweep sweep;
    add_handle(sweep, scope.capsules[0]);

    // Round the heel: from down the handle to along the blade.
    const Vec3f pivot(0, 12.0f * millimetre, 12.0f * millimetre - blade.high);
    const Section plate = plate_section(blade.wide, thickness, blade.crown, flange);
    for (int i = 0; i <= 8; ++i) {
        const float share = static_cast<float>(i) / 8.0f;
        const float angle = 0.5f * pi * share;
        const Vec3f height(0, std::sin(angle), std::cos(angle));
        const Section section = blended(round_section(5.0f * millimetre), plate, smoothstep(0, 1, share));
        sweep.add(section, pivot - pivot.z() * height, height);
    }

    constexpr float heel = BladeClearanceDeformer::heel;
    constexpr int stations = 40;
    for (int i = 1; i <= stations; ++i) {
        // Denser towards the tip, where the outline is rounded.
        const float share = 1.0f - std::pow(1.0f - static_cast<float>(i) / stations, 1.5f);
        const float z = heel + (length - heel) * share;
        const float to_tip = length - z;
        const float width = 2.0f * blade.outline(z);
        const float lip = smoothstep(8.0f * millimetre, 0.0f, to_tip);
        const float fade = 1.0f - smoothstep(0.75f * length, 0.93f * length, z);
        sweep.add(plate_section(width, thickness * (1.0f - 0.3f * lip), blade.crown * width / blade.wide,
                                flange * fade),
                  Vec3f(0, blade.height(z), z), Vec3f::UnitY());
    }
    return std::move(sweep).closed();
}

}  // namespace eti
