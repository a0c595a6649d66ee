// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/newborn/body/body_shape.hpp"

#include <algorithm>
#include <cmath>

#include "common/mesh/distance.hpp"
#include "server/patient/newborn/body/body_data.hpp"

namespace eti::patient {

namespace {

// Spacings [mm]: of head, hands and feet, where lids, lips and gaps between fingers are a millimetre wide; of
// all else; and of what surrounds it. Distances up to `band` spacings are kept.
constexpr float fine_spacing = 1.0f, body_spacing = 2.0f, far_spacing = 6.0f;
constexpr float band = 3.5f, far_band = 10.0f;
// The lower end of the head's grid lies below the chin. Hands lie farther out than all else of the upper
// half, feet lowest.
constexpr float head_from = -48.0f, head_half_width = 70.0f;
constexpr float hand_length = 75.0f, foot_length = 75.0f;

// Drawn edges relative to those of the data. Along all three axes at once the growth is a quarter.
constexpr float detail_share = 0.54f, coarsest_detail = 6.0f, finest_detail = 0.55f;
constexpr float detail_spacing = 4.0f, detail_growth = 0.14f;

DistanceGrid distances(const TriangleMesh& mesh, const Vec3f& low, const Vec3f& high, float spacing,
                       float reach) {
    return mesh_distance(mesh, low, spacing, grid_nodes(low, high, spacing), reach * spacing);
}

}  // namespace

bool BodyShape::is_available() {
    return !body_data().triangles.empty();
}

BodyShape::BodyShape(float gestational_age) {
    constexpr float preterm_weeks = 28.0f, term_weeks = 40.0f;
    const float preterm =
        std::clamp((term_weeks - gestational_age) / (term_weeks - preterm_weeks), 0.0f, 1.3f);
    const BodyData data = body_data();
    const auto coordinate = [&](std::size_t i) {
        return body_unit_mm *
               (static_cast<float>(data.term[i]) + preterm * static_cast<float>(data.preterm_change[i]));
    };
    for (std::size_t i = 0; i < data.term.size(); i += 3) {
        mesh_.vertices.emplace_back(coordinate(i), coordinate(i + 1), coordinate(i + 2));
    }
    for (std::size_t t = 0; t < data.triangles.size(); t += 3) {
        mesh_.triangles.push_back({data.triangles[t], data.triangles[t + 1], data.triangles[t + 2]});
    }
    bounds_ = {mesh_.vertices.front(), mesh_.vertices.front()};
    for (const Vec3f& p : mesh_.vertices) {
        bounds_[0] = bounds_[0].cwiseMin(p);
        bounds_[1] = bounds_[1].cwiseMax(p);
    }
}

void BodyShape::build_grids() const {
    const auto [low, high] = bounds_;
    const auto margin = [](float spacing, float reach) { return Vec3f::Constant(spacing * reach); };
    // A grid over those vertices that are within a box.
    const auto add = [&](const Vec3f& from, const Vec3f& to, float spacing) {
        Vec3f first = to, last = from;
        for (const Vec3f& p : mesh_.vertices) {
            if ((p.array() >= from.array()).all() && (p.array() <= to.array()).all()) {
                first = first.cwiseMin(p);
                last = last.cwiseMax(p);
            }
        }
        grids_.push_back(
            distances(mesh_, first - margin(spacing, band), last + margin(spacing, band), spacing, band));
    };
    const float middle = 0.5f * low.z();
    add({-head_half_width, low.y(), head_from}, {head_half_width, high.y(), high.z()}, fine_spacing);
    add({high.x() - hand_length, low.y(), middle}, high, fine_spacing);
    add({low.x(), low.y(), middle}, {low.x() + hand_length, high.y(), high.z()}, fine_spacing);
    add({0.0f, low.y(), low.z()}, {high.x(), high.y(), low.z() + foot_length}, fine_spacing);
    add({low.x(), low.y(), low.z()}, {0.0f, high.y(), low.z() + foot_length}, fine_spacing);
    add(low, high, body_spacing);
    surroundings_ = distances(mesh_, low - margin(far_spacing, far_band),
                              high + margin(far_spacing, far_band), far_spacing, far_band);
    build_detail();
    // Lids closed over a hollow socket are as thin as a sheet: the eye fills it.
    for (const BodyEye& eye : body_data().eyes) {
        const Vec3f centre(eye.centre[0], eye.centre[1], eye.centre[2]);
        const auto fill = [&](DistanceGrid& grid) {
            for (int z = 0; z < grid.size[2]; ++z) {
                for (int y = 0; y < grid.size[1]; ++y) {
                    for (int x = 0; x < grid.size[0]; ++x) {
                        float& value = grid.value[grid.index(x, y, z)];
                        value = std::min(value, (grid.node(x, y, z) - centre).norm() - eye.radius);
                    }
                }
            }
        };
        std::ranges::for_each(grids_, fill);
        fill(surroundings_);
    }
}

/// Shortest edge at the data's vertices, spread with `detail_growth`.
void BodyShape::build_detail() const {
    const Vec3f margin = Vec3f::Constant(detail_spacing);
    detail_.origin = bounds_[0] - margin;
    detail_.spacing = detail_spacing;
    detail_.size = grid_nodes(detail_.origin, bounds_[1] + margin, detail_spacing);
    const auto [width, height, depth] = detail_.size;
    detail_.value.assign(detail_.index(0, 0, depth), coarsest_detail);
    for (const Triangle& t : mesh_.triangles) {
        const Vec3f &a = mesh_.vertices[t[0]], &b = mesh_.vertices[t[1]], &c = mesh_.vertices[t[2]];
        const float mean = ((b - a).norm() + (c - b).norm() + (a - c).norm()) / 3.0f;
        const Vec3f place = ((a + b + c) / 3.0f - detail_.origin) / detail_spacing;
        float& at = detail_.value[detail_.index(static_cast<int>(std::lround(place.x())),
                                                static_cast<int>(std::lround(place.y())),
                                                static_cast<int>(std::lround(place.z())))];
        at = std::min(at, std::max(detail_share * mean, finest_detail));
    }
    // Two sweeps through all neighbours on one side of a node and on the other (chamfer distance).
    const auto sweep = [&](int from, int end, int step) {
        for (int i = from; i != end; i += step) {
            const int x = i % width, y = i / width % height, z = i / (width * height);
            float& here = detail_.value[static_cast<std::size_t>(i)];
            for (int k = 0; k < 13; ++k) {
                const int dx = step * (k % 3 - 1), dy = step * (k / 3 % 3 - 1), dz = step * (k / 9 - 1);
                const int nx = x + dx, ny = y + dy, nz = z + dz;
                if (nx >= 0 && ny >= 0 && nz >= 0 && nx < width && ny < height && nz < depth) {
                    const float away = std::sqrt(static_cast<float>(dx * dx + dy * dy + dz * dz));
                    here = std::min(here, detail_.value[detail_.index(nx, ny, nz)] +
                                              detail_growth * detail_spacing * away);
                }
            }
        }
    };
    const int count = width * height * depth;
    sweep(0, count, 1);
    sweep(count - 1, -1, -1);
}

float BodyShape::detail(const Vec3f& point) const {
    std::call_once(built_, [&] { build_grids(); });
    return detail_.distance(point);
}

float BodyShape::distance(const Vec3f& point) const {
    // Grids are built by one thread: a parallel loop within could take up work that waits for them.
    std::call_once(built_, [&] { build_grids(); });
    const auto within = [&](const DistanceGrid& grid) {
        const Vec3f place = (point - grid.origin) / grid.spacing;
        for (int axis = 0; axis < 3; ++axis) {
            const auto last = static_cast<float>(grid.size[static_cast<std::size_t>(axis)] - 2);
            if (place[axis] < 1.0f || place[axis] > last) {
                return false;
            }
        }
        return true;
    };
    for (const DistanceGrid& grid : grids_) {
        if (within(grid)) {
            const float distance = grid.spline_sample(point).distance;
            if (std::fabs(distance) < (band - 1.5f) * grid.spacing) {
                return distance;
            }
        }
    }
    return surroundings_.distance(point);
}

}  // namespace eti::patient
