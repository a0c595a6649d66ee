// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/room/bedding.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>

#include "common/math/smoothstep.hpp"

namespace eti::render {
namespace {

constexpr float none = 1e3f;  // [m], far beyond any body

const Vec3f towel(158, 166, 168), stripe(92, 150, 176);  // sRGB

int cell_of(float at, float from) {
    return static_cast<int>(std::floor((at - from) / BodyProfile::cell));
}

std::size_t cell_index(int column, int row) {
    return static_cast<std::size_t>(row * BodyProfile::width + column);
}

bool on_map(int column, int row) {
    return column >= 0 && row >= 0 && column < BodyProfile::width && row < BodyProfile::length;
}

// Columns are dense in the middle, rows around the head: [m] from the midline, and from the head's end.
float column_place(int column) {
    const float t = 2.0f * static_cast<float>(column) / (Bedding::columns - 1) - 1.0f;
    return mattress_half_width * (0.55f * t + 0.45f * t * t * t);
}

float row_place(int row) {
    const float t = static_cast<float>(row) / (Bedding::rows - 1);
    return mattress_length * (0.72f * t + 0.28f * t * t * t);
}

std::uint8_t tinted(float value) {
    return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0f, 255.0f)));
}

// Triangles of every `step`-th row and column.
std::vector<Triangle> grid_triangles(std::uint32_t step) {
    constexpr std::uint32_t columns = Bedding::columns, rows = Bedding::rows;
    std::vector<Triangle> triangles;
    for (std::uint32_t row = 0; row + step < rows; row += step) {
        for (std::uint32_t column = 0; column + step < columns; column += step) {
            const std::uint32_t at = row * columns + column, below = at + step * columns;
            triangles.push_back({at, below, below + step});
            triangles.push_back({at, below + step, at + step});
        }
    }
    return triangles;
}

bool outlines(Tissue tissue) {
    return tissue == Tissue::soft || tissue == Tissue::cloth;
}

}  // namespace

BodyProfile::BodyProfile()
    : back(static_cast<std::size_t>(width * length), -none),
      front(static_cast<std::size_t>(width * length), none) {}

void BodyProfile::add(const Vec3f& point) {
    // The point stands for its neighbourhood, so that no gap opens between points.
    const int column = cell_of(point.x(), left), row = cell_of(point.z(), foot);
    for (int k = 0; k < 9; ++k) {
        const int x = column + k % 3 - 1, z = row + k / 3 - 1;
        if (on_map(x, z)) {
            back[cell_index(x, z)] = std::max(back[cell_index(x, z)], point.y());
            front[cell_index(x, z)] = std::min(front[cell_index(x, z)], point.y());
        }
    }
}

float BodyProfile::back_at(float x, float z) const {
    const int column = cell_of(x, left), row = cell_of(z, foot);
    return on_map(column, row) ? back[cell_index(column, row)] : -none;
}

float BodyProfile::front_at(float x, float z) const {
    const int column = cell_of(x, left), row = cell_of(z, foot);
    return on_map(column, row) ? front[cell_index(column, row)] : none;
}

void BodyOutline::build(const view::SceneView& scene) {
    // A point stands for the cells of the profile beside its own, 15 mm, which leaves no gap. Between points
    // of a head of 45 mm radius lie at most 10^2 / (8 x 45) = 0.3 mm.
    constexpr float apart = 10e-3f;  // [m]
    points_.clear();
    std::set<std::array<int, 3>> taken;
    for (const auto& [name, surface] : scene.surfaces()) {
        const bus::RestSurface& model = surface.model();
        if (!outlines(model.tissue)) {
            continue;
        }
        for (std::size_t v = 0; v < model.mesh.vertices.size(); ++v) {
            std::array<int, 3> block{};
            for (int axis = 0; axis < 3; ++axis) {
                block[static_cast<std::size_t>(axis)] =
                    static_cast<int>(std::floor(model.mesh.vertices[v][axis] / apart));
            }
            if (taken.insert(block).second) {
                points_.push_back({model.mesh.vertices[v], model.skin[v]});
            }
        }
    }
}

std::vector<Vec3f> BodyOutline::points(const view::SceneView& scene) const {
    std::vector<Vec3f> now;
    now.reserve(points_.size());
    for (const Point& point : points_) {
        now.push_back(skin_point(point.rest, point.skin, scene.frame_maps()));
    }
    return now;
}

BodyProfile profile_of(std::span<const Vec3f> points) {
    BodyProfile profile;
    for (const Vec3f& point : points) {
        profile.add(point);
    }
    return profile;
}

Rest rest_of(const BodyProfile& body) {
    Rest rest;
    rest.mattress = -none;
    float first = none, last = -none;
    std::vector<float> back_by_row(BodyProfile::length, -none);
    for (int row = 0; row < BodyProfile::length; ++row) {
        const float z = BodyProfile::foot + BodyProfile::cell * (static_cast<float>(row) + 0.5f);
        for (int column = 0; column < BodyProfile::width; ++column) {
            const float back = body.back[cell_index(column, row)];
            if (back > -none) {
                const float x = BodyProfile::left + BodyProfile::cell * (static_cast<float>(column) + 0.5f);
                rest.half_width = std::max(rest.half_width, std::abs(x));
                back_by_row[static_cast<std::size_t>(row)] =
                    std::max(back_by_row[static_cast<std::size_t>(row)], back);
                first = std::min(first, z);
                last = std::max(last, z);
            }
        }
        rest.mattress = std::max(rest.mattress, back_by_row[static_cast<std::size_t>(row)]);
    }
    rest.head_top_z = last;
    // The trunk's back is level; the neck is where it rises by a tenth of the way to the face's side of it.
    const auto row_of = [](float z) {
        return static_cast<std::size_t>(
            std::clamp(cell_of(z, BodyProfile::foot), 0, BodyProfile::length - 1));
    };
    const float upper_trunk = first + 0.3f * (-first);
    rest.trunk = back_by_row[row_of(std::max(upper_trunk, -0.16f))];
    rest.neck_z = std::max(upper_trunk, -0.16f);
    for (std::size_t row = row_of(rest.neck_z); row < row_of(0.0f); ++row) {
        if (back_by_row[row] < rest.trunk - 8e-3f) {
            break;
        }
        rest.neck_z = BodyProfile::foot + BodyProfile::cell * static_cast<float>(row);
    }
    // A head raised on a pillow: the mattress is never above the trunk.
    rest.mattress = std::max(rest.mattress, rest.trunk + 8e-3f);
    return rest;
}

float sky_beside(const BodyProfile& body, const Vec3f& point) {
    static constexpr int directions = 10;
    static constexpr std::array reaches{1.0f, 2.0f, 4.0f, 7.0f, 11.0f, 18.0f};  // [cells]
    struct Step {
        int column, row;
        float squared;  // [m^2], of its length
    };
    static const auto steps = [] {
        std::array<std::array<Step, reaches.size()>, directions> all{};
        for (int k = 0; k < directions; ++k) {
            const float turn = 2.0f * std::numbers::pi_v<float> * (static_cast<float>(k) + 0.5f) / directions;
            for (std::size_t j = 0; j < reaches.size(); ++j) {
                const auto column = static_cast<int>(std::lround(reaches[j] * std::cos(turn)));
                const auto row = static_cast<int>(std::lround(reaches[j] * std::sin(turn)));
                const auto cells = static_cast<float>(column * column + row * row);
                all[static_cast<std::size_t>(k)][j] = {column, row,
                                                       cells * BodyProfile::cell * BodyProfile::cell};
            }
        }
        return all;
    }();
    const int column = cell_of(point.x(), BodyProfile::left), row = cell_of(point.z(), BodyProfile::foot);
    const bool overhead = on_map(column, row) && body.back[cell_index(column, row)] > -none;
    float left = 0.0f;
    for (const auto& along : steps) {
        // The body hides the band of elevations between its back and its front as seen from the point; a band
        // from a to b takes sin^2 b - sin^2 a of the light of this azimuth.
        float low = 1.0f, high = overhead ? 1.0f : 0.0f;
        for (const Step& step : along) {
            const int x = column + step.column, z = row + step.row;
            if (!on_map(x, z)) {
                break;
            }
            const float back = body.back[cell_index(x, z)];
            if (back <= -none) {
                continue;
            }
            const float under = std::max(point.y() - back, 0.0f);
            const float over = std::max(point.y() - body.front[cell_index(x, z)], 0.0f);
            low = std::min(low, under * under / (under * under + step.squared));
            high = std::max(high, over * over / (over * over + step.squared));
        }
        left += 1.0f - std::max(high - low, 0.0f);
    }
    return left / directions;
}

Bedding::Bedding(const Rest& rest, const BodyProfile& body) : rest_(rest) {
    vertices_.resize(static_cast<std::size_t>(columns * rows));
    colours_.resize(vertices_.size());
    const float head_end = rest.head_top_z + mattress_margin;
    for (int row = 0; row < rows; ++row) {
        for (int column = 0; column < columns; ++column) {
            vertices_[index(column, row)].position =
                Vec3f(column_place(column), 0.0f, head_end - row_place(row));
        }
    }
    triangles_ = grid_triangles(1);
    shape(body, rows);
}

std::vector<Triangle> Bedding::coarse_triangles() const {
    return grid_triangles(2);
}

float Bedding::unloaded(float x, float z, float headrest) const {
    // Blanket: from the shoulders to the feet, with soft edges.
    const float half_blanket = rest_.half_width + 0.055f;
    const float beside = 1.0f - smoothstep(half_blanket - 0.03f, half_blanket + 0.02f, std::abs(x));
    const float caudal = 1.0f - smoothstep(rest_.neck_z + 4e-3f, rest_.neck_z + 32e-3f, z);
    float y = rest_.mattress - beside * caudal * (rest_.mattress - rest_.trunk + 2e-3f);
    // Roll beneath the neck.
    const float away = (z - rest_.neck_z - 6e-3f) / 13e-3f;
    y -= 10e-3f * std::exp(-away * away) * (1.0f - smoothstep(0.06f, 0.10f, std::abs(x)));
    // The headrest follows the head's back, within a hand's breadth of it.
    const float near_head = (1.0f - smoothstep(0.03f, 0.11f, std::abs(x))) *
                            smoothstep(rest_.neck_z + 0.02f, rest_.neck_z + 0.05f, z) *
                            (1.0f - smoothstep(rest_.head_top_z - 0.01f, rest_.head_top_z + 0.05f, z));
    y += near_head * (headrest - 2e-3f - rest_.mattress);
    // Folds of the towel.
    const float calm = smoothstep(0.05f, 0.13f, std::abs(x));
    y += calm * 1.1e-3f * std::sin(31.0f * z + 9.0f * x + 2.0f * std::sin(17.0f * x)) *
         std::sin(23.0f * x + 5.0f * z);
    // Rounded border.
    const float edge = smoothstep(mattress_half_width - 0.012f, mattress_half_width, std::abs(x));
    return y + 8e-3f * edge * edge;
}

void Bedding::shape(const BodyProfile& body, int row_count) {
    float headrest = -none;
    for (float z = rest_.neck_z + 0.04f; z < rest_.head_top_z; z += BodyProfile::cell) {
        for (float x = -0.06f; x < 0.06f; x += BodyProfile::cell) {
            headrest = std::max(headrest, body.back_at(x, z));
        }
    }
    headrest = headrest > -none ? headrest : rest_.mattress;
    for (int row = 0; row < row_count; ++row) {
        for (int column = 0; column < columns; ++column) {
            Vec3f& p = vertices_[index(column, row)].position;
            p.y() = std::max(unloaded(p.x(), p.z(), headrest), body.back_at(p.x(), p.z()));
        }
    }
    // The towel bridges the rims of a dent: it relaxes, but never into the body.
    for (int round = 0; round < 3; ++round) {
        for (int row = 1; row < std::min(row_count, rows - 1); ++row) {
            for (int column = 1; column + 1 < columns; ++column) {
                Vec3f& p = vertices_[index(column, row)].position;
                const float mean = 0.25f * (height(column - 1, row) + height(column + 1, row) +
                                            height(column, row - 1) + height(column, row + 1));
                p.y() = std::max(0.5f * (p.y() + mean), body.back_at(p.x(), p.z()));
            }
        }
    }
    const auto place = [&](int column, int row) -> const Vec3f& {
        return vertices_[index(std::clamp(column, 0, columns - 1), std::clamp(row, 0, rows - 1))].position;
    };
    for (int row = 0; row < std::min(row_count + 1, rows); ++row) {
        for (int column = 0; column < columns; ++column) {
            view::LitVertex& vertex = vertices_[index(column, row)];
            vertex.normal = (place(column, row + 1) - place(column, row - 1))
                                .cross(place(column + 1, row) - place(column - 1, row))
                                .normalized();
            const float sky = sky_beside(body, vertex.position);
            const float z = vertex.position.z() - rest_.head_top_z;
            const bool in_stripe = std::abs(z + 0.47f) < 0.012f || std::abs(z + 0.505f) < 0.006f;
            const Vec3f colour = in_stripe ? stripe : towel;
            // sRGB of a share of the light, nearly.
            const float share = std::sqrt(0.06f + 0.94f * sky);
            colours_[index(column, row)] = {tinted(share * colour.x()), tinted(share * colour.y()),
                                            tinted(share * colour.z()), 0};
        }
    }
}

int Bedding::follow(const BodyProfile& body, float from_z) {
    // A dent reaches a little beyond the body that makes it.
    constexpr float beyond = 0.02f;  // [m]
    int row_count = 0;
    while (row_count < rows && vertices_[index(0, row_count)].position.z() > from_z - beyond) {
        ++row_count;
    }
    shape(body, row_count);
    return std::min(row_count + 1, rows);
}

}  // namespace eti::render
