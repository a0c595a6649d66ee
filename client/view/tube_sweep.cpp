// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/view/tube_sweep.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "common/model/tools/tube_end.hpp"

namespace eti::view {
namespace {

struct CurvePoint {
    Vec3f position;
    Vec3f tangent;
    Vec3f across;  // unit, normal to the tangent; transported without twist
    float arc;     // [m] from the connector
};

Vec3f catmull_rom(const Vec3f& a, const Vec3f& b, const Vec3f& c, const Vec3f& d, float t) {
    return 0.5f * (2.0f * b + t * (c - a) + t * t * (2.0f * a - 5.0f * b + 4.0f * c - d) +
                   t * t * t * (3.0f * (b - c) + d - a));
}

std::vector<CurvePoint> smooth_curve(std::span<const Vec3f> nodes) {
    constexpr int pieces = 4;
    std::vector<CurvePoint> curve;
    curve.reserve(pieces * nodes.size());
    const auto node = [&](std::ptrdiff_t i) -> Vec3f {
        const auto last = static_cast<std::ptrdiff_t>(nodes.size()) - 1;
        if (i < 0) {
            return 2.0f * nodes[0] - nodes[1];
        }
        return i > last ? Vec3f(2.0f * nodes.back() - nodes[nodes.size() - 2])
                        : nodes[static_cast<std::size_t>(i)];
    };
    const auto add = [&](const Vec3f& position) {
        const float step = curve.empty() ? 0.0f : (position - curve.back().position).norm();
        if (curve.empty() || step > 1e-6f) {
            curve.push_back(
                {position, Vec3f::UnitZ(), Vec3f::UnitX(), curve.empty() ? 0.0f : curve.back().arc + step});
        }
    };
    for (std::ptrdiff_t i = 0; i + 1 < static_cast<std::ptrdiff_t>(nodes.size()); ++i) {
        for (int piece = 0; piece < pieces; ++piece) {
            const float t = static_cast<float>(piece) / pieces;
            add(catmull_rom(node(i - 1), node(i), node(i + 1), node(i + 2), t));
        }
    }
    add(nodes.back());
    for (std::size_t i = 0; curve.size() > 1 && i < curve.size(); ++i) {
        const std::size_t before = i > 0 ? i - 1 : i;
        const std::size_t after = std::min(i + 1, curve.size() - 1);
        const Vec3f chord = curve[after].position - curve[before].position;
        curve[i].tangent = chord.norm() > 1e-9f ? chord.normalized() : curve[before].tangent;
        const Vec3f carried = i > 0 ? curve[i - 1].across : concave_side(nodes, curve[0].tangent);
        const Vec3f across = carried - carried.dot(curve[i].tangent) * curve[i].tangent;
        curve[i].across = across.norm() > 1e-6f ? across.normalized() : curve[i].tangent.unitOrthogonal();
    }
    return curve;
}

// The curve at `arc`; extrapolated linearly beyond the connector and the tip.
CurvePoint at_arc(const std::vector<CurvePoint>& curve, float arc) {
    const auto above =
        std::upper_bound(curve.begin(), curve.end(), arc,
                         [](float value, const CurvePoint& point) { return value < point.arc; });
    if (above == curve.begin() || above == curve.end()) {
        CurvePoint end = above == curve.begin() ? curve.front() : curve.back();
        end.position += (arc - end.arc) * end.tangent;
        return end;
    }
    const CurvePoint& low = *(above - 1);
    const float t = (arc - low.arc) / (above->arc - low.arc);
    CurvePoint between;
    between.position = low.position + t * (above->position - low.position);
    between.tangent = (low.tangent + t * (above->tangent - low.tangent)).normalized();
    const Vec3f across = low.across + t * (above->across - low.across);
    between.across = (across - across.dot(between.tangent) * between.tangent).normalized();
    between.arc = arc;
    return between;
}

// Arc length [m] of each ring from the connector's end of the tube: twice as dense at the tip, where the
// bevel is.
std::array<float, TubeSweep::rings> arcs_of_rings(float length) {
    std::array<float, TubeSweep::rings> result{};
    for (std::size_t i = 0; i < result.size(); ++i) {
        const float share = static_cast<float>(i) / static_cast<float>(result.size() - 1);
        result[i] = length * share * (4.0f - share) / 3.0f;
    }
    return result;
}

/// Direction of a side of a ring.
struct Direction {
    float around;  // turns
    float cosine, sine;
};

std::array<Direction, TubeSweep::sides> directions() {
    std::array<Direction, TubeSweep::sides> out{};
    for (int side = 0; side < TubeSweep::sides; ++side) {
        const float around = static_cast<float>(side) / TubeSweep::sides;
        const float angle = 2.0f * std::numbers::pi_v<float> * around;
        out[static_cast<std::size_t>(side)] = {around, std::cos(angle), std::sin(angle)};
    }
    return out;
}

std::vector<Triangle> wall_triangles() {
    constexpr std::uint32_t sides = TubeSweep::sides;
    constexpr std::uint32_t rings = TubeSweep::rings;
    // Once around a longitudinal section: outer wall to the tip, over the rim, inner wall back, rim.
    constexpr std::uint32_t loop = 2 * rings;
    std::vector<Triangle> triangles;
    triangles.reserve(std::size_t{2} * loop * sides);
    for (std::uint32_t ring = 0; ring < loop; ++ring) {
        const std::uint32_t next = (ring + 1) % loop;
        for (std::uint32_t side = 0; side < sides; ++side) {
            const std::uint32_t turn = (side + 1) % sides;
            const std::uint32_t a = ring * sides + side, b = ring * sides + turn;
            const std::uint32_t c = next * sides + side, d = next * sides + turn;
            triangles.push_back({a, c, b});
            triangles.push_back({b, c, d});
        }
    }
    return triangles;
}

}  // namespace

TubeSweep::TubeSweep(const Tube& tube)
    : tube_(tube), vertices_(std::size_t{2} * rings * sides), triangles_(wall_triangles()) {}

bool TubeSweep::update(std::span<const Vec3f> nodes) {
    if (nodes.size() < 2) {
        return false;
    }
    const std::vector<CurvePoint> curve = smooth_curve(nodes);
    if (curve.size() < 2) {
        return false;
    }
    const float length = curve.back().arc;
    const auto arcs = arcs_of_rings(length);
    static const auto around_ring = directions();
    const float setback_zone = std::min(4.0f * tube_.outer_radius(), length);
    std::size_t index = 0;
    const auto sweep_ring = [&](float ring, float radius, float outward) {
        const float near_tip = std::max(0.0f, 1.0f - (length - ring) / setback_zone);
        CurvePoint centre = at_arc(curve, ring);
        Vec3f left = centre.across.cross(centre.tangent);
        for (int side = 0; side < sides; ++side, ++index) {
            const Direction& direction = around_ring[static_cast<std::size_t>(side)];
            float arc = ring;
            // The bevel sets back the left side; elsewhere a ring has a single centre.
            if (near_tip > 0.0f) {
                const float leftness = 0.5f * (1.0f + direction.sine);
                arc -= near_tip * leftness * 2.0f * bevel_slope * radius;
                centre = at_arc(curve, arc);
                left = centre.across.cross(centre.tangent);
            }
            const Vec3f radial = direction.cosine * centre.across + direction.sine * left;
            vertices_[index] = {centre.position + radius * radial, outward * radial, length - arc,
                                direction.around};
        }
    };
    for (const float ring : arcs) {
        sweep_ring(ring, tube_.outer_radius(), 1.0f);
    }
    for (auto ring = arcs.rbegin(); ring != arcs.rend(); ++ring) {
        sweep_ring(*ring, tube_.inner_radius(), -1.0f);
    }
    const CurvePoint& start = curve.front();
    Mat3f axes;
    axes << start.across, start.tangent.cross(start.across), start.tangent;
    connector_pose_ = RigidTransform::from(Quatf(axes), start.position);
    revision_ = next_revision();
    return true;
}

}  // namespace eti::view
