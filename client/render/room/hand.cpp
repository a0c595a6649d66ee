// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/room/hand.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/math/implicit.hpp"
#include "common/mesh/isosurface.hpp"
#include "common/mesh/simplify.hpp"

namespace eti::render {
namespace {

constexpr float spacing = 3e-3f;                                   // [m] of the grid that is meshed
constexpr float webs = 1.5e-3f, knuckles = 7e-3f, flesh = 12e-3f;  // [m], radii of blends

const VertexColour nitrile{112, 126, 184, 110}, cuff{122, 136, 192, 90}, sleeve{92, 130, 134, 0};

// Joints in mm, from the knuckle (or the thumb's base) to the tip, with the radius there.
struct Finger {
    std::array<Vec3f, 4> joint;
    std::array<float, 4> radius;
};

struct Hand {
    std::array<Finger, 5> finger;  // the thumb first
    Vec3f wrist, forearm;          // forearm: unit vector from the wrist
};

// Fingers around a handle along y whose radius is 9 mm, the tips' pads against it.
Hand around_the_handle() {
    Hand hand;
    const auto finger = [](float y, float reach, float radius) {
        const Vec3f knuckle(21.0f, y, 20.0f);
        const Vec3f middle(21.0f - 35.0f * reach, y - 1.0f, 19.0f + 9.0f * reach);
        return Finger{{knuckle, middle, Vec3f(-25.5f, y - 3.0f, 6.0f), Vec3f(-12.0f, y - 5.0f, -10.5f)},
                      {radius + 1.5f, radius, radius - 0.6f, radius - 1.2f}};
    };
    hand.finger = {Finger{{Vec3f(27, 52, -46), Vec3f(11, 76, -33), Vec3f(-3, 95, -20), Vec3f(-7, 116, -16)},
                          {14.0f, 11.5f, 10.0f, 9.0f}},
                   finger(79.0f, 1.0f, 8.8f), finger(61.5f, 1.08f, 9.0f), finger(44.0f, 1.0f, 8.6f),
                   finger(27.5f, 0.9f, 7.6f)};
    hand.wrist = Vec3f(44, 40, -66);
    hand.forearm = Vec3f(0.50f, -0.50f, -0.70f).normalized();
    return hand;
}

// Thumb and index meet at the tube, the others support from below; x across, y to the wrist, z along the
// tube.
Hand around_the_tube() {
    Hand hand;
    hand.finger = {Finger{{Vec3f(-6, 96, 16), Vec3f(-21, 58, 3), Vec3f(-17, 28, -3), Vec3f(-10.2f, -1, 0)},
                          {15.0f, 11.5f, 10.0f, 8.2f}},
                   Finger{{Vec3f(18, 84, -2), Vec3f(22, 43, -13), Vec3f(17, 20, -8), Vec3f(9.6f, -1, 0)},
                          {10.3f, 8.8f, 8.2f, 7.6f}},
                   Finger{{Vec3f(21, 89, 16), Vec3f(27, 47, 8), Vec3f(20, 23, 14), Vec3f(9.4f, 4, 17)},
                          {10.5f, 9.0f, 8.4f, 7.6f}},
                   Finger{{Vec3f(20, 91, 34), Vec3f(28, 54, 29), Vec3f(18, 36, 35), Vec3f(4, 30, 36)},
                          {10.1f, 8.6f, 8.0f, 7.3f}},
                   Finger{{Vec3f(16, 92, 50), Vec3f(24, 64, 48), Vec3f(14, 50, 52), Vec3f(2, 48, 51)},
                          {9.1f, 7.6f, 7.0f, 6.4f}}};
    hand.wrist = Vec3f(0, 168, 27);
    hand.forearm = Vec3f(-0.15f, 0.97f, 0.12f).normalized();
    return hand;
}

// The pinch of a tube, opened to a newborn's larynx of some 13 mm. The pads rest on the skin, which falls off
// beside the larynx; z is caudal, where the other fingers lie over the chest.
Hand beside_the_larynx() {
    Hand hand = around_the_tube();
    hand.finger[0].joint[2] += Vec3f(-4, -2, 0);
    hand.finger[0].joint[3] = Vec3f(-12.5f, -6.5f, 0);
    hand.finger[1].joint[2] += Vec3f(3, -2, 0);
    hand.finger[1].joint[3] = Vec3f(12.0f, -7.0f, -1);
    hand.finger[2].joint[2] += Vec3f(2, -2, -1);
    hand.finger[2].joint[3] = Vec3f(11.5f, -5.0f, 14);
    return hand;
}

const Hand& hand_of(Grip grip) {
    static const std::array<Hand, grip_count> hands{around_the_handle(), around_the_tube(),
                                                    beside_the_larynx()};
    return hands[static_cast<std::size_t>(grip)];
}

constexpr float glove_end = 46.0f;  // [mm] along the forearm from the wrist

// The glove's rolled rim, and a gown's sleeve that comes out of it and ends near the elbow.
Solid dressed_forearm(const Hand& hand) {
    const auto rings = [&](std::initializer_list<std::array<float, 2>> profile) {
        std::vector<Ring> path;
        for (const auto& [along, radius] : profile) {
            path.push_back({1e-3f * (hand.wrist + along * hand.forearm), 1e-3f * radius});
        }
        return path;
    };
    Solid solid = sweep(rings({{glove_end - 5, 24},
                               {glove_end - 4, 26.2f},
                               {glove_end - 2, 27},
                               {glove_end, 26.2f},
                               {glove_end + 1, 24}}),
                        22, cuff);
    solid.append(sweep(rings({{glove_end - 8, 22},
                              {glove_end - 1, 24},
                              {glove_end + 6, 28},
                              {glove_end + 14, 31},
                              {glove_end + 26, 31.5f},
                              {glove_end + 38, 34},
                              {glove_end + 56, 34.5f},
                              {glove_end + 80, 38},
                              {glove_end + 130, 42},
                              {glove_end + 250, 50}}),
                       22, sleeve));
    return solid;
}

}  // namespace

float hand_distance(Grip grip, const Vec3f& point) {
    const Hand& hand = hand_of(grip);
    const Vec3f p = 1e3f * point;
    const float web = 1e3f * webs, knuckle = 1e3f * knuckles, muscle = 1e3f * flesh;
    float fingers = 1e6f, palm = 1e6f;
    for (const Finger& finger : hand.finger) {
        float one = 1e6f;
        for (std::size_t k = 0; k < 3; ++k) {
            one = smooth_union(
                one,
                round_cone(p, finger.joint[k], finger.joint[k + 1], finger.radius[k], finger.radius[k + 1]),
                2.0f * web);
        }
        fingers = smooth_union(fingers, one, web);
        palm =
            smooth_union(palm, round_cone(p, finger.joint[0], hand.wrist, finger.radius[0], 17.0f), muscle);
    }
    // The web between thumb and index.
    const Vec3f& thumb = hand.finger[0].joint[1];
    palm = smooth_union(palm, round_cone(p, thumb, hand.finger[1].joint[0], 8.0f, 8.0f), muscle);
    float all = smooth_union(fingers, palm, knuckle);
    const Vec3f end = hand.wrist + (glove_end - 18.0f) * hand.forearm;
    all = smooth_union(all, round_cone(p, hand.wrist, end, 23.0f, 24.0f), muscle);
    return 1e-3f * all;
}

Solid gloved_hand(Grip grip, std::size_t triangles) {
    const Hand& hand = hand_of(grip);
    Eigen::AlignedBox3f box;
    for (const Finger& finger : hand.finger) {
        for (const Vec3f& joint : finger.joint) {
            box.extend(joint);
        }
    }
    box.extend(hand.wrist);
    box.extend(hand.wrist + glove_end * hand.forearm);
    DistanceGrid field;
    field.spacing = spacing;
    const Vec3f margin = Vec3f::Constant(40e-3f);
    field.origin = 1e-3f * box.min() - margin;
    field.size = grid_nodes(field.origin, 1e-3f * box.max() + margin, spacing);
    for (int z = 0; z < field.size[2]; ++z) {
        for (int y = 0; y < field.size[1]; ++y) {
            for (int x = 0; x < field.size[0]; ++x) {
                field.value.push_back(hand_distance(grip, field.node(x, y, z)));
            }
        }
    }
    const TriangleMesh mesh = simplify(isosurface(field, 0.0f), {.triangles = triangles});
    Solid solid;
    solid.triangles = mesh.triangles;
    for (const Vec3f& vertex : mesh.vertices) {
        constexpr float step = 1e-3f;  // [m]
        Vec3f normal;
        for (int axis = 0; axis < 3; ++axis) {
            const Vec3f aside = step * Vec3f::Unit(axis);
            normal[axis] = hand_distance(grip, vertex + aside) - hand_distance(grip, vertex - aside);
        }
        solid.vertices.push_back({vertex, normal.normalized()});
        solid.colours.push_back(nitrile);
    }
    solid.append(dressed_forearm(hand));
    return solid;
}

std::optional<RigidTransform> tube_grip(std::span<const Vec3f> nodes, float from_tip) {
    float left = from_tip;
    for (std::size_t k = nodes.size(); k > 1; --k) {
        const Vec3f way = nodes[k - 1] - nodes[k - 2];
        const float length = way.norm();
        if (length <= 0.0f || (left > length && k > 2)) {
            left -= length;
            continue;
        }
        const Vec3f z = way / length;
        // The operator stands at the head: the right hand comes from the patient's right, above and cranial.
        const Vec3f from_operator(-0.75f, -0.25f, 0.6f);
        const Vec3f y = (from_operator - from_operator.dot(z) * z).normalized();
        Mat3f axes;
        axes << y.cross(z), y, z;
        return RigidTransform::from(Quatf(axes), nodes[k - 1] - std::min(left, length) * z);
    }
    return std::nullopt;
}

RigidTransform larynx_grip(const Vec3f& skin) {
    const Vec3f y = Vec3f(0.72f, -0.60f, -0.35f).normalized(), caudal(0.0f, 0.0f, -1.0f);
    const Vec3f z = (caudal - caudal.dot(y) * y).normalized();
    Mat3f axes;
    axes << y.cross(z), y, z;
    constexpr float pad = 7e-3f;  // [m], from a fingertip's joint to its skin, less what it dents
    return RigidTransform::from(Quatf(axes), skin + pad * y);
}

}  // namespace eti::render
