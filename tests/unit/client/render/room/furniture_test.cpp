// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/room/furniture.hpp"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "client/render/room/hand.hpp"

namespace eti::render {
namespace {

// Edges that are not shared by exactly two triangles which traverse them in opposite directions, with
// vertices at the same place counted as one.
int open_edges(const Solid& solid) {
    std::map<std::array<int, 3>, int> places;
    const auto place = [&](std::uint32_t vertex) {
        std::array<int, 3> at{};
        for (int axis = 0; axis < 3; ++axis) {
            at[static_cast<std::size_t>(axis)] =
                static_cast<int>(std::lround(1e6f * solid.vertices[vertex].position[axis]));
        }
        return places.try_emplace(at, static_cast<int>(places.size())).first->second;
    };
    std::map<std::pair<int, int>, int> balance;
    for (const Triangle& t : solid.triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
            const int a = place(t[k]), b = place(t[(k + 1) % 3]);
            a < b ? ++balance[{a, b}] : --balance[{b, a}];
        }
    }
    return static_cast<int>(
        std::ranges::count_if(balance, [](const auto& edge) { return edge.second != 0; }));
}

double volume(const Solid& solid) {
    double sum = 0.0;
    for (const Triangle& t : solid.triangles) {
        const Vec3f &a = solid.vertices[t[0]].position, &b = solid.vertices[t[1]].position;
        sum += a.dot(b.cross(solid.vertices[t[2]].position)) / 6.0f;
    }
    return sum;
}

TEST(Solid, BoxIsClosedAndFilled) {
    const Solid box = rounded_box({0.1f, -0.2f, 0.3f}, {0.03f, 0.02f, 0.01f}, 0.002f, {});
    EXPECT_EQ(open_edges(box), 0);
    // Of 8 a b c, the bevels of twelve edges take r^2 / 2 of their length each.
    const double whole = 8.0 * 0.03 * 0.02 * 0.01, bevels = 0.5 * 0.002 * 0.002 * 8.0 * 0.06;
    EXPECT_NEAR(volume(box), whole - bevels, 0.01 * whole);
}

TEST(Solid, HoseIsClosedAndFilled) {
    const std::array through{Vec3f(0, 0, 0), Vec3f(0.1f, 0, 0), Vec3f(0.1f, 0.1f, 0)};
    const Solid solid = hose(through, 0.004f, {});
    EXPECT_EQ(open_edges(solid), 0);
    const std::vector<Vec3f> path = spline(through, 6);
    double length = 0.0;
    for (std::size_t k = 1; k < path.size(); ++k) {
        length += (path[k] - path[k - 1]).norm();
    }
    // A polygon of n sides in a circle: n sin(2 pi / n) / 2 of the squared radius; bends overlap by some per
    // cent.
    const double section = 0.5 * 10 * std::sin(0.2 * 3.14159265) * 0.004 * 0.004;
    EXPECT_NEAR(volume(solid), section * length, 0.03 * section * length);
}

TEST(Furniture, PartsAreClosed) {
    const Furniture room = make_furniture({});
    ASSERT_GT(room.dull.size(), 3u);
    for (std::size_t part = 0; part < room.dull.size(); ++part) {
        EXPECT_EQ(open_edges(room.dull[part]), 0) << "part " << part;
        // The walls enclose the room, and are seen from inside.
        const bool walls = part + 1 == room.dull.size();
        EXPECT_EQ(volume(room.dull[part]) < 0.0, walls) << "part " << part;
    }
    EXPECT_EQ(open_edges(room.glowing), 0);
}

TEST(Furniture, LeavesTheMattressToTheNewborn) {
    // Only hose and mask lie on it, at its right; a term newborn's arms reach 12 cm from its midline.
    for (const Solid& part : make_furniture({}).dull) {
        for (const view::LitVertex& vertex : part.vertices) {
            const Vec3f& p = vertex.position;
            const bool above = p.y() < -2e-3f && p.y() > -0.25f && p.z() < 0.0f && p.z() > -0.55f;
            EXPECT_FALSE(above && std::abs(p.x()) < 0.12f) << p.transpose();
        }
    }
}

TEST(Furniture, MonitorFacesOperatorAndRoom) {
    const Furniture room = make_furniture({});
    const Vec3f outward = room.screen_down.cross(room.screen_right).normalized();
    const Vec3f operator_head(0.0f, -0.45f, 0.15f);
    EXPECT_GT(outward.dot((operator_head - room.screen_centre).normalized()), 0.5f);
    EXPECT_LT(room.screen_down.dot(-Vec3f::UnitY()), 0.0f) << "its lower side is down";
}

TEST(Hand, IsClosedAndFollowsItsDistance) {
    for (const Grip grip : {Grip::handle, Grip::tube}) {
        const Solid hand = gloved_hand(grip, 1500);
        EXPECT_EQ(open_edges(hand), 0);
        std::size_t glove = 0;
        for (const view::LitVertex& vertex : hand.vertices) {
            glove += std::abs(hand_distance(grip, vertex.position)) < 2e-3f ? 1 : 0;
        }
        // The rest is the sleeve.
        EXPECT_GT(glove, hand.vertices.size() / 2);
    }
}

// The handle has a radius of 9 mm. Pads of fingers press against it from several sides, none enters it
// deeply.
TEST(Hand, WrapsTheHandle) {
    const Capsule handle = make_laryngoscope(Blade::miller_1).capsules[0];
    std::set<int> sides;
    float deepest = 0.0f;
    for (float y = 0.024f; y < handle.b.y(); y += 2e-3f) {
        for (int k = 0; k < 72; ++k) {
            const float turn = 5.0f * degree * static_cast<float>(k);
            const float away = hand_distance(
                Grip::handle, {handle.radius * std::cos(turn), y, handle.radius * std::sin(turn)});
            deepest = std::max(deepest, -away);
            if (away < 0.5e-3f) {
                sides.insert(k / 18);
            }
        }
    }
    EXPECT_GE(sides.size(), 3u) << "quarters of the handle that are touched";
    EXPECT_LT(deepest, 2.5e-3f);
    EXPECT_GT(hand_distance(Grip::handle, {0, 0, 0}), 8e-3f) << "the blade's heel is free";
}

TEST(Hand, PinchesTheTube) {
    constexpr float radius = 2.1e-3f;
    const float thumb = hand_distance(Grip::tube, {-radius, 0, 0});
    const float index = hand_distance(Grip::tube, {radius, 0, 0});
    EXPECT_NEAR(thumb, 0.0f, 0.8e-3f);
    EXPECT_NEAR(index, 0.0f, 0.8e-3f);
    EXPECT_GT(hand_distance(Grip::tube, {0, 0, 0.06f}), 15e-3f) << "the tube's tip is free";
}

TEST(Hand, TubeGripLiesOnTheTube) {
    // A quarter circle of 100 mm radius, from the connector at the angle 0 to the tip.
    std::vector<Vec3f> nodes;
    constexpr int count = 50;
    for (int k = 0; k <= count; ++k) {
        const float turn = 90.0f * degree * static_cast<float>(k) / count;
        nodes.emplace_back(0.0f, 0.1f * std::sin(turn), 0.1f * std::cos(turn));
    }
    const float from_tip = 0.05f;
    const auto pose = tube_grip(nodes, from_tip);
    ASSERT_TRUE(pose);
    const float turn = 90.0f * degree - from_tip / 0.1f;
    // Chords of 3.1 mm leave the circle by 0.012 mm, and are shorter by 4e-5 of it.
    EXPECT_NEAR((pose->translation - Vec3f(0, 0.1f * std::sin(turn), 0.1f * std::cos(turn))).norm(), 0.0f,
                5e-5f);
    const Vec3f tangent(0, std::cos(turn), -std::sin(turn));
    EXPECT_GT((pose->rotation * Vec3f::UnitZ()).dot(tangent), std::cos(1.0f * degree));
    EXPECT_LT((pose->rotation * Vec3f::UnitY()).x(), 0.0f) << "the wrist is on the operator's right";
    // Held beyond its end, the hand is at the connector.
    EXPECT_NEAR((tube_grip(nodes, 1.0f)->translation - nodes.front()).norm(), 0.0f, 1e-6f);
    EXPECT_FALSE(tube_grip({}, 0.1f));
}

}  // namespace
}  // namespace eti::render
