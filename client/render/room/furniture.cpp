// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/room/furniture.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include "client/render/room/bedding.hpp"
#include "common/math/smoothstep.hpp"

namespace eti::render {
namespace {

constexpr float middle_z = -0.5f * mattress_length;
constexpr float floor_y = 0.93f, ceiling_y = -1.75f, wall = 2.3f;  // [m]

const VertexColour enamel{188, 194, 194, 90}, vinyl{74, 124, 150, 70}, housing{60, 66, 72, 80},
    steel{186, 190, 196, 255}, drape{74, 112, 112, 0}, silicone{196, 208, 214, 170},
    hose_blue{118, 160, 200, 120}, clear_hose{206, 216, 220, 190}, green{60, 160, 90, 120},
    gauze{200, 202, 200, 0}, hub{46, 96, 178, 130};

// The stand with mattress, rails, column and warmer.
void add_resuscitaire(Furniture& room) {
    Solid& to = room.dull.emplace_back();
    const auto box = [&](const Vec3f& centre, const Vec3f& half, float radius, VertexColour colour) {
        to.append(rounded_box(centre, half, radius, colour));
    };
    box({0.0f, 0.029f, middle_z}, {mattress_half_width + 0.006f, 0.020f, 0.5f * mattress_length + 0.006f},
        0.010f, vinyl);
    box({0.0f, 0.064f, middle_z}, {0.275f, 0.014f, 0.345f}, 0.012f, enamel);
    for (const float side : {-1.0f, 1.0f}) {
        box({side * 0.262f, 0.015f, middle_z}, {0.006f, 0.045f, 0.30f}, 0.005f, enamel);
    }
    box({0.0f, 0.005f, -mattress_length - 0.030f}, {0.262f, 0.055f, 0.006f}, 0.005f, enamel);
    box({0.0f, 0.5f, middle_z - 0.12f}, {0.055f, 0.42f, 0.055f}, 0.015f, enamel);
    box({0.0f, floor_y - 0.04f, middle_z - 0.05f}, {0.27f, 0.03f, 0.36f}, 0.02f, housing);
    // Column at the feet, its panel, and the warmer on its arm.
    const float column_z = -mattress_length - 0.11f;
    box({0.0f, -0.10f, column_z}, {0.05f, 0.80f, 0.03f}, 0.012f, enamel);
    box({0.0f, -0.27f, column_z + 0.05f}, {0.17f, 0.10f, 0.03f}, 0.012f, enamel);
    for (const float x : {-0.10f, -0.03f}) {  // the T-piece's manometer and the suction's
        const std::array<Ring, 2> dial{Ring{{x, -0.29f, column_z + 0.075f}, 0.026f},
                                       Ring{{x, -0.29f, column_z + 0.090f}, 0.024f}};
        to.append(sweep(dial, 20, gauze));
    }
    box({0.0f, -0.86f, 0.5f * (column_z + middle_z)}, {0.03f, 0.02f, 0.5f * (middle_z - column_z)}, 0.01f,
        enamel);
    box({0.0f, -0.83f, middle_z + 0.06f}, {0.22f, 0.04f, 0.10f}, 0.02f, enamel);
    room.glowing.append(
        rounded_box({0.0f, -0.787f, middle_z + 0.06f}, {0.17f, 0.006f, 0.03f}, 0.004f, {255, 126, 60, 255}));
}

// A mask on a T-piece, its hose, and a suction catheter, beside the head.
void add_airway_aids(Solid& to) {
    const Vec3f mask(-0.150f, 0.0f, -0.105f);
    const auto ring = [&](float up, float radius) { return Ring{mask - Vec3f(0.0f, up, 0.0f), radius}; };
    const std::array cup{ring(-0.001f, 0.022f), ring(0.001f, 0.026f), ring(0.005f, 0.026f),
                         ring(0.013f, 0.021f),  ring(0.024f, 0.011f), ring(0.030f, 0.009f)};
    to.append(sweep(cup, 24, silicone));
    const std::array stem{ring(0.030f, 0.0085f), ring(0.062f, 0.0085f)};
    to.append(sweep(stem, 16, hub));
    const std::array branch{Ring{mask + Vec3f(0.0f, -0.048f, 0.0f), 0.006f},
                            Ring{mask + Vec3f(-0.030f, -0.046f, -0.022f), 0.006f}};
    to.append(sweep(branch, 14, hub));
    const std::array supply{Vec3f(mask + Vec3f(-0.028f, -0.046f, -0.020f)),
                            Vec3f(-0.206f, -0.026f, -0.180f),
                            Vec3f(-0.214f, -0.004f, -0.30f),
                            Vec3f(-0.196f, -0.004f, -0.46f),
                            Vec3f(-0.150f, -0.02f, -0.58f),
                            Vec3f(-0.10f, -0.20f, -0.64f)};
    to.append(hose(supply, 5.5e-3f, hose_blue));
    const std::array suction{Vec3f(0.150f, -0.001f, -0.060f), Vec3f(0.178f, -0.003f, -0.120f),
                             Vec3f(0.160f, -0.003f, -0.200f), Vec3f(0.190f, -0.003f, -0.260f),
                             Vec3f(0.205f, -0.004f, -0.42f),  Vec3f(0.120f, -0.02f, -0.59f),
                             Vec3f(-0.03f, -0.20f, -0.64f)};
    to.append(hose(suction, 2.8e-3f, clear_hose));
    const std::array valve{Ring{{0.170f, -0.004f, -0.100f}, 4.5e-3f},
                           Ring{{0.178f, -0.004f, -0.122f}, 4.5e-3f}};
    to.append(sweep(valve, 12, green));
}

// A trolley to the patient's right with a steel tray: a spare laryngoscope, tubes, gauze.
void add_trolley(Solid& to, const Solid& blade) {
    const Vec3f top(-0.405f, 0.030f, -0.085f);
    to.append(rounded_box(top + Vec3f(0.0f, 0.012f, 0.0f), {0.115f, 0.014f, 0.25f}, 0.010f, drape));
    to.append(rounded_box(top + Vec3f(0.0f, 0.45f, 0.0f), {0.02f, 0.42f, 0.02f}, 0.005f, steel));
    to.append(rounded_box({top.x(), floor_y - 0.03f, top.z()}, {0.11f, 0.02f, 0.22f}, 0.01f, housing));
    const Vec3f tray = top + Vec3f(0.0f, -0.004f, 0.065f);
    constexpr float half_x = 0.080f, half_z = 0.125f, rim = 0.009f;
    to.append(rounded_box(tray, {half_x, 0.0015f, half_z}, 0.001f, steel));
    for (const float side : {-1.0f, 1.0f}) {
        to.append(
            rounded_box(tray + Vec3f(side * half_x, -rim, 0.0f), {0.0015f, rim, half_z}, 0.001f, steel));
        to.append(
            rounded_box(tray + Vec3f(0.0f, -rim, side * half_z), {half_x, rim, 0.0015f}, 0.001f, steel));
    }
    const float on_tray = tray.y() - 0.0015f;
    if (!blade.vertices.empty()) {
        // On its side, the handle along the tray.
        Mat3f lying;
        lying << Vec3f::UnitY(), Vec3f::UnitZ(), Vec3f::UnitX();
        to.append(blade, RigidTransform::from(Quatf(lying),
                                              {tray.x() - 0.055f, on_tray - 0.0092f, tray.z() - 0.050f}));
    }
    for (int k = 0; k < 2; ++k) {
        const float aside = tray.x() + 0.025f + 0.020f * static_cast<float>(k);
        const float y = on_tray - 2.2e-3f;
        const std::array arc{Vec3f(aside, y, tray.z() + 0.095f), Vec3f(aside + 0.006f, y, tray.z() + 0.035f),
                             Vec3f(aside, y, tray.z() - 0.025f), Vec3f(aside - 0.022f, y, tray.z() - 0.075f)};
        to.append(hose(arc, 2.1e-3f, clear_hose));
        const std::array end{Ring{arc[0] - Vec3f(0.0f, 2e-3f, 0.012f), 3.2e-3f},
                             Ring{arc[0] - Vec3f(0.0f, 2e-3f, 0.0f), 4.2e-3f},
                             Ring{arc[0] - Vec3f(0.0f, 2e-3f, -0.012f), 4.2e-3f}};
        to.append(sweep(end, 14, hub));
    }
    for (int k = 0; k < 3; ++k) {
        const float z = top.z() - 0.130f - 0.045f * static_cast<float>(k);
        to.append(
            rounded_box({top.x() + 0.03f, top.y() - 0.006f, z}, {0.035f, 0.005f, 0.018f}, 0.003f, gauze));
    }
}

// The monitor on the right rail, turned to the operator and to the room.
void add_monitor(Furniture& room) {
    constexpr float half_width = 0.098f, half_height = 0.060f;
    const Vec3f centre(-0.338f, -0.082f, -0.275f);
    Mat3f axes;  // to the right as seen, down, back
    axes.col(2) = -Vec3f(0.80f, -0.22f, 0.56f).normalized();
    axes.col(0) = Vec3f::UnitY().cross(axes.col(2)).normalized();
    axes.col(1) = axes.col(2).cross(axes.col(0));
    Solid& to = room.dull.emplace_back();
    const RigidTransform pose = RigidTransform::from(Quatf(axes), centre);
    to.append(rounded_box({0.0f, 0.0f, 0.020f}, {half_width + 0.012f, half_height + 0.012f, 0.020f}, 0.008f,
                          housing),
              pose);
    const std::array arm{Ring{pose * Vec3f(0.0f, 0.03f, 0.036f), 0.011f},
                         Ring{pose * Vec3f(0.0f, 0.03f, 0.060f), 0.011f}};
    to.append(sweep(arm, 12, enamel));
    const Vec3f back = pose * Vec3f(0.0f, 0.03f, 0.056f);
    to.append(sweep(std::array{Ring{back, 0.011f}, Ring{{back.x(), 0.07f, back.z()}, 0.011f}}, 12, enamel));
    to.append(rounded_box({0.5f * (back.x() - 0.26f), 0.066f, back.z()},
                          {0.5f * std::abs(back.x() + 0.26f) + 0.02f, 0.010f, 0.014f}, 0.004f, enamel));
    room.screen_centre = pose * Vec3f(0.0f, 0.0f, -0.8e-3f);
    room.screen_right = half_width * axes.col(0);
    room.screen_down = half_height * axes.col(1);
}

// Floor, walls and ceiling, seen from inside; the floor lies in the table's shade.
void add_walls(Furniture& room) {
    constexpr int steps = 8;
    const Vec3f low(-wall, ceiling_y, -wall + middle_z), high(wall, floor_y, wall + middle_z);
    Solid& to = room.dull.emplace_back();
    for (int axis = 0; axis < 3; ++axis) {
        for (const bool far : {false, true}) {
            const Vec3f inward = (far ? -1.0f : 1.0f) * Vec3f::Unit(axis);
            const int one = (axis + 1) % 3, other = (axis + 2) % 3;
            const auto first = static_cast<std::uint32_t>(to.vertices.size());
            for (int j = 0; j <= steps; ++j) {
                for (int i = 0; i <= steps; ++i) {
                    Vec3f at;
                    at[axis] = far ? high[axis] : low[axis];
                    at[one] = low[one] + (high[one] - low[one]) * static_cast<float>(i) / steps;
                    at[other] = low[other] + (high[other] - low[other]) * static_cast<float>(j) / steps;
                    to.vertices.push_back({at, inward});
                    const bool floor = axis == 1 && far, ceiling = axis == 1 && !far;
                    const float away = std::hypot(at.x(), at.z() - middle_z);
                    const float open = floor ? 0.45f + 0.55f * smoothstep(0.2f, 1.2f, away) : 1.0f;
                    const Vec3f colour = floor     ? Vec3f(98, 108, 112)
                                         : ceiling ? Vec3f(214, 216, 214)
                                                   : Vec3f(204, 202, 192);
                    const auto byte = [&](float value) { return static_cast<std::uint8_t>(open * value); };
                    to.colours.push_back({byte(colour.x()), byte(colour.y()), byte(colour.z()),
                                          static_cast<std::uint8_t>(floor ? 60 : 0)});
                }
            }
            for (std::uint32_t j = 0; j < steps; ++j) {
                for (std::uint32_t i = 0; i < steps; ++i) {
                    const std::uint32_t a = first + j * (steps + 1) + i, b = a + 1, c = a + steps + 1,
                                        d = c + 1;
                    // i runs along `one`, j along `other`: counter-clockwise seen along -axis.
                    if (far) {
                        to.triangles.insert(to.triangles.end(), {Triangle{a, c, b}, Triangle{b, c, d}});
                    } else {
                        to.triangles.insert(to.triangles.end(), {Triangle{a, b, c}, Triangle{b, d, c}});
                    }
                }
            }
        }
    }
    for (const float x : {-0.95f, 1.3f}) {
        room.glowing.append(rounded_box({x, ceiling_y + 0.01f, middle_z + 0.2f}, {0.15f, 0.008f, 0.65f},
                                        0.004f, {236, 242, 248, 255}));
    }
}

}  // namespace

Furniture make_furniture(const Solid& blade) {
    Furniture room;
    add_resuscitaire(room);
    add_airway_aids(room.dull.emplace_back());
    add_trolley(room.dull.emplace_back(), blade);
    add_monitor(room);
    add_walls(room);
    return room;
}

}  // namespace eti::render
