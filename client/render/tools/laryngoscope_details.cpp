// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/tools/laryngoscope_details.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>

#include "client/render/lighting.hpp"
#include "common/math/smoothstep.hpp"
#include "common/math/units.hpp"
#include "common/model/tools/blade_clearance_deformer.hpp"

namespace eti::render {
namespace {

// As in laryngoscope_mesh.cpp: plate and flange at the heel, and the share of the width that is flange.
constexpr float plate_thickness = 1.5e-3f, flange_height = 2.5e-3f, flange_share = 0.12f;  // [m]

constexpr VertexColour knurled_steel{176, 178, 184, knurled_gloss}, dark_steel{120, 122, 128, 255},
    fibre_light{30, 120, 58, 200};

// A turned part about the handle: height along it and radius, both in mm.
Solid turned(std::initializer_list<std::array<float, 2>> profile, VertexColour colour) {
    std::vector<Ring> path;
    for (const auto& [height, radius] : profile) {
        path.push_back({Vec3f(0.0f, millimetre * height, 0.0f), millimetre * radius});
    }
    return sweep(path, 24, colour);
}

Solid handle_parts(const Capsule& handle) {
    const float top = (handle.b.y() + handle.radius) / millimetre;
    const float grip = top - 13.0f;
    Solid parts = turned({{34.0f, 8.9f}, {34.6f, 9.2f}, {grip - 0.6f, 9.2f}, {grip, 8.9f}}, knurled_steel);
    // A groove above the grip, then the screwed cap with its dome.
    parts.append(
        turned({{grip + 0.6f, 9.02f}, {grip + 0.8f, 9.06f}, {grip + 1.4f, 9.06f}, {grip + 1.6f, 9.02f}},
               dark_steel));
    parts.append(turned({{grip + 2.2f, 9.0f},
                         {grip + 2.5f, 9.25f},
                         {top - 2.2f, 9.25f},
                         {top - 1.0f, 9.0f},
                         {top + 0.2f, 8.2f},
                         {top + 1.2f, 6.7f},
                         {top + 1.9f, 4.6f},
                         {top + 2.3f, 2.2f},
                         {top + 2.4f, 0.4f}},
                        steel_colour));
    parts.append(turned({{29.0f, 9.02f}, {29.3f, 9.2f}, {31.7f, 9.2f}, {32.0f, 9.02f}}, steel_colour));
    parts.append(turned({{25.8f, 9.02f}, {26.0f, 9.15f}, {27.8f, 9.15f}, {28.0f, 9.02f}}, fibre_light));
    return parts;
}

// Block of the hook-on fitting around the neck, with the pin on which the blade hooks and the ball that locks
// it.
Solid fitting() {
    Solid parts =
        rounded_box(Vec3f(0.0f, 12.6e-3f, 0.0f), Vec3f(6.1e-3f, 2.4e-3f, 6.1e-3f), 1.2e-3f, steel_colour);
    const auto across = [&](float y, float z, float half, float radius) {
        const std::array<Ring, 2> ends{{{Vec3f(-half, y, z), radius}, {Vec3f(half, y, z), radius}}};
        parts.append(sweep(ends, 14, dark_steel));
    };
    across(13.4e-3f, 2.4e-3f, 6.4e-3f, 1.0e-3f);
    across(12.0e-3f, -2.6e-3f, 6.25e-3f, 0.7e-3f);
    return parts;
}

// Places along the blade between two shares of its length.
template <class Place>
std::vector<Ring> along_blade(float from, float to, int count, const Place& place) {
    std::vector<Ring> path;
    for (int k = 0; k < count; ++k) {
        path.push_back(place(from + (to - from) * static_cast<float>(k) / static_cast<float>(count - 1)));
    }
    return path;
}

Solid blade_parts(const Laryngoscope& scope) {
    const BladePlate plate = plate_of(scope);
    const float length = plate.length;
    const auto flange_at = [&](float z) {
        return flange_height * (1.0f - smoothstep(0.75f * length, 0.93f * length, z));
    };
    // The rolled edge of the flange.
    Solid parts =
        sweep(along_blade(BladeClearanceDeformer::heel, 0.90f * length, 26,
                          [&](float z) {
                              const float width = 2.0f * plate.outline(z), wall = flange_share * width;
                              const float crown = plate.crown * width / plate.wide;
                              const float radius = 0.5f * wall + 0.1e-3f;
                              const float down = plate_thickness + flange_at(z) + crown - radius + 0.1e-3f;
                              return Ring{Vec3f(0.5f * (width - wall), plate.height(z) - down, z), radius};
                          }),
              10, steel_colour);
    // The bead around the tip, from edge to edge.
    std::vector<Ring> bead;
    constexpr int points = 25;
    for (int k = 0; k < points; ++k) {
        const float across = -1.0f + 2.0f * static_cast<float>(k) / (points - 1);
        // Dense where the outline turns.
        const float back = across * across * across * across;
        const float z = length - 0.45e-3f - 6.0e-3f * back;
        const float half = plate.outline(z) - 0.42e-3f;
        const float x = std::clamp(1.6f * across, -1.0f, 1.0f) * half;
        const float crown = plate.crown * 2.0f * plate.outline(z) / plate.wide;
        const float fall = crown * (x / half) * (x / half);
        bead.push_back({Vec3f(x, plate.height(z) - fall - 0.55e-3f, z), 0.6e-3f});
    }
    parts.append(sweep(bead, 10, steel_colour));
    // The light's tube runs in the corner of plate and flange to the ferrule of the bulb.
    const Vec3f bulb = bulb_centre(length);
    const float start = BladeClearanceDeformer::heel - 2e-3f, end = bulb.z() - 1.6e-3f;
    const auto corner = [&](float z) {
        const float share = smoothstep(0.45f * length, end, z);
        const float width = 2.0f * plate.outline(z);
        const Vec3f in_corner((0.5f - 1.35f * flange_share) * width - 0.7e-3f,
                              plate.height(z) - plate_thickness - 1.35e-3f, z);
        const Vec3f at = (1.0f - share) * in_corner + share * Vec3f(bulb.x(), bulb.y(), z);
        return Ring{at, 0.8e-3f};
    };
    parts.append(sweep(along_blade(start, end, 22, corner), 12, dark_steel));
    parts.append(sweep(along_blade(end - 1.2e-3f, end + 0.9e-3f, 4,
                                   [&](float z) {
                                       return Ring{Vec3f(bulb.x(), bulb.y(), z), 1.12e-3f};
                                   }),
                       14, steel_colour));
    return parts;
}

}  // namespace

Solid laryngoscope_details(const Laryngoscope& scope) {
    Solid details = handle_parts(scope.capsules[0]);
    details.append(fitting());
    details.append(blade_parts(scope));
    return details;
}

}  // namespace eti::render
