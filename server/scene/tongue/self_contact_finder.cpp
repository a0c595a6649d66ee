// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/scene/tongue/self_contact_finder.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "common/mesh/closest_point.hpp"
#include "server/parallel/loops.hpp"

namespace eti::scene {

namespace {

// [m]; a contact in force rests this deep, so that it does not leave its element.
constexpr float resting_depth = 0.3e-3f;
// [m] at rest; nearer points are neighbours that deform together.
constexpr float own_neighbourhood = 4e-3f;
// [m], correction in one step.
constexpr float max_correction = 1e-3f;
// A multiplier's share that is kept per step. With all of it, points of crushed cells, whose normals are
// noise, are driven to and fro; the rest acts as a penalty of ten times the contact's stiffness.
constexpr float memory = 0.9f;
// The same for a point that has lost its element, which is crushed or between two folds.
constexpr float lost_memory = 0.8f;
// The last normal's weight over the new one's: single cells turn their normals by more than a right angle.
constexpr float normal_inertia = 4.0f;
// Damping of the normal displacement, in contact stiffnesses.
constexpr float normal_damping = 4.0f;
constexpr float grid_spacing = 1e-3f;       // [m]
constexpr float pair_margin = 0.75e-3f;     // [m], by which pairs may approach before they are collected anew
constexpr std::size_t expected_pairs = 32;  // per point
constexpr float cell_width = 3e-3f;         // [m], of the broad phase
constexpr int most_cells = 64;              // along an axis; farther points share the last cell
constexpr float least_volume = 0.05f;       // of an element's volume; below it has no inverse worth using

constexpr std::array<std::array<std::size_t, 3>, 4> faces = {{{1, 2, 3}, {0, 2, 3}, {0, 1, 3}, {0, 1, 2}}};

Eigen::Matrix3f edges_of(const std::array<std::uint32_t, 4>& corner, const std::vector<Vec3f>& at) {
    Eigen::Matrix3f edges;
    edges << at[corner[1]] - at[corner[0]], at[corner[2]] - at[corner[0]], at[corner[3]] - at[corner[0]];
    return edges;
}

}  // namespace

void SelfContactFinder::configure(const Description& description) {
    elements_.clear();
    points_.clear();
    std::vector<bool> used(description.rest.size(), false);
    for (const auto& corner : description.solid) {
        const Eigen::Matrix3f edges = edges_of(corner, description.rest);
        const float determinant = edges.determinant();
        const float size = edges.colwise().norm().maxCoeff();
        if (std::fabs(determinant) < 1e-6f * size * size * size) {
            continue;  // flat
        }
        Vec3f centre = Vec3f::Zero();
        for (const std::uint32_t i : corner) {
            centre += 0.25f * description.rest[i];
            used[i] = true;
        }
        float radius = 0.0f;
        for (const std::uint32_t i : corner) {
            radius = std::max(radius, (description.rest[i] - centre).norm());
        }
        elements_.push_back({corner, description.rest[corner[0]], centre, edges, 1.0f / determinant, radius});
    }
    for (std::uint32_t i = 0; i < description.rest.size(); ++i) {
        if (used[i] && description.free[i]) {
            points_.push_back({i, description.rest[i], true});
        }
    }
    for (const std::uint32_t i : description.neighbours) {
        points_.push_back({i, description.rest[i], false});
        used[i] = true;
    }
    used_.clear();
    for (std::uint32_t i = 0; i < used.size(); ++i) {
        if (used[i]) {
            used_.push_back(i);
        }
    }
    first_element_.assign(description.rest.size() + 1, 0);
    for (const Element& e : elements_) {
        for (const std::uint32_t i : e.corner) {
            ++first_element_[i + 1];
        }
    }
    for (std::size_t i = 1; i < first_element_.size(); ++i) {
        first_element_[i] += first_element_[i - 1];
    }
    elements_of_.resize(4 * elements_.size());
    std::vector<std::uint32_t> next = first_element_;
    for (std::uint32_t t = 0; t < elements_.size(); ++t) {
        for (const std::uint32_t i : elements_[t].corner) {
            elements_of_[next[i]++] = t;
        }
    }
    cofactor_.assign(description.rest.size(), Eigen::Matrix3f::Zero());
    cofactor_call_.assign(description.rest.size(), 0);
    build_distance(description);
    // So that a step does not allocate.
    seen_.reserve(used_.size());
    cell_.reserve(points_.size());
    in_cell_.reserve(points_.size());
    at_in_cell_.reserve(points_.size());
    point_of_contact_.reserve(points_.size());
    cell_start_.reserve(std::size_t{most_cells} * most_cells * most_cells + 2);
    pairs_.reserve(expected_pairs * points_.size());
    reset();
}

void SelfContactFinder::reset() {
    seen_.clear();
    pairs_.clear();
    point_of_contact_.clear();
    memory_.assign(points_.size(), {});
    hits_.assign(points_.size(), {});
}

void SelfContactFinder::build_distance(const Description& description) {
    struct Triangle {
        std::array<Vec3f, 3> corner;
        Vec3f normal, centre;
        float radius = 0.0f;
        bool free = false;
    };
    // Boundary faces, outward by the element's fourth corner.
    std::map<std::array<std::uint32_t, 3>, std::array<std::uint32_t, 2>> owners;  // element, times seen
    for (std::uint32_t t = 0; t < elements_.size(); ++t) {
        for (const auto& face : faces) {
            std::array<std::uint32_t, 3> key{};
            for (std::size_t k = 0; k < 3; ++k) {
                key[k] = elements_[t].corner[face[k]];
            }
            std::ranges::sort(key);
            auto& owner = owners[key];
            owner = {t, owner[1] + 1};
        }
    }
    std::vector<Triangle> triangles;
    for (const auto& [key, owner] : owners) {
        if (owner[1] > 1) {
            continue;
        }
        Triangle t;
        for (std::size_t k = 0; k < 3; ++k) {
            t.corner[k] = description.rest[key[k]];
            t.free = t.free || description.free[key[k]];
        }
        t.centre = (t.corner[0] + t.corner[1] + t.corner[2]) / 3.0f;
        t.normal = (t.corner[1] - t.corner[0]).cross(t.corner[2] - t.corner[0]).normalized();
        if (t.normal.dot(elements_[owner[0]].centre - t.centre) > 0.0f) {
            t.normal = -t.normal;
        }
        for (const Vec3f& x : t.corner) {
            t.radius = std::max(t.radius, (x - t.centre).norm());
        }
        triangles.push_back(t);
    }
    if (std::ranges::none_of(triangles, &Triangle::free)) {
        points_.clear();  // nothing can get in, and there is no way out
        return;
    }
    Eigen::AlignedBox3f box;
    for (const Element& e : elements_) {
        for (const std::uint32_t i : e.corner) {
            box.extend(description.rest[i]);
        }
    }
    distance_.spacing = grid_spacing;
    distance_.origin = box.min() - Vec3f::Constant(3.0f * grid_spacing);
    for (int axis = 0; axis < 3; ++axis) {
        distance_.size[static_cast<std::size_t>(axis)] =
            static_cast<int>(std::ceil(box.sizes()[axis] / grid_spacing)) + 7;
    }
    const auto [nx, ny, nz] = distance_.size;
    distance_.value.assign(
        static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny) * static_cast<std::size_t>(nz), 0.0f);
    parallel::for_each(nz, 1, [&, nx = nx, ny = ny](int z) {
        constexpr float same = 1e-6f;  // [m]
        constexpr float far = 1.0f;    // [m]
        for (int y = 0; y < ny; ++y) {
            // No farther than from the node before, and the way from there; with room for all that are the
            // same.
            float reach = far, reach_free = far;
            for (int x = 0; x < nx; ++x) {
                const Vec3f at = distance_.node(x, y, z);
                float nearest = far;
                float nearest_free = far;
                float alignment = 0.0f;  // among triangles at one edge or corner, the one that faces the node
                bool outside = false;
                for (const Triangle& t : triangles) {
                    const float most = (t.free ? std::max(reach, reach_free) : reach) + t.radius;
                    if ((at - t.centre).squaredNorm() > most * most) {
                        continue;
                    }
                    const Vec3f away =
                        at - closest_on_triangle(at, t.corner[0], t.corner[1], t.corner[2]).point;
                    const float distance = away.norm();
                    if (t.free) {
                        nearest_free = std::min(nearest_free, distance);
                        reach_free = std::min(reach_free, distance + 10.0f * same);
                    }
                    reach = std::min(reach, distance + 10.0f * same);
                    const float facing = std::fabs(t.normal.dot(away)) / std::max(distance, 1e-9f);
                    if (distance < nearest - same || (distance < nearest + same && facing > alignment)) {
                        nearest = distance;
                        alignment = facing;
                        outside = t.free && t.normal.dot(away) > 0.0f;
                    }
                }
                distance_.value[distance_.index(x, y, z)] = outside ? nearest_free : -nearest_free;
                reach += grid_spacing;
                reach_free += grid_spacing;
            }
        }
    });
}

bool SelfContactFinder::stale(const pbd::Particles& particles) const {
    if (seen_.size() != used_.size()) {
        return true;
    }
    for (std::size_t k = 0; k < used_.size(); ++k) {
        if ((particles.predicted[used_[k]] - seen_[k]).squaredNorm() > 0.25f * pair_margin * pair_margin) {
            return true;
        }
    }
    return false;
}

void SelfContactFinder::collect_pairs(const pbd::Particles& particles) {
    seen_.resize(used_.size());
    for (std::size_t k = 0; k < used_.size(); ++k) {
        seen_[k] = particles.predicted[used_[k]];
    }
    pairs_.clear();
    Eigen::AlignedBox3f box;
    for (const Point& point : points_) {
        if (particles.predicted[point.particle].allFinite()) {
            box.extend(particles.predicted[point.particle]);
        }
    }
    if (box.isEmpty()) {
        return;
    }
    const Eigen::Vector3i size =
        (box.sizes() / cell_width).cwiseMin(most_cells - 1.0f).cast<int>() + Eigen::Vector3i::Ones();
    const auto index_of = [&](const Eigen::Vector3i& c) {
        return static_cast<std::uint32_t>(c.x() + size.x() * (c.y() + size.y() * c.z()));
    };
    const auto cell_of = [&](const Vec3f& x) -> Eigen::Vector3i {
        Eigen::Vector3i cell;
        for (int axis = 0; axis < 3; ++axis) {
            // In this order a NaN becomes zero.
            const float at = std::max(0.0f, (x[axis] - box.min()[axis]) / cell_width);
            cell[axis] = static_cast<int>(std::min(at, static_cast<float>(size[axis] - 1)));
        }
        return cell;
    };
    cell_.resize(points_.size());
    in_cell_.resize(points_.size());
    at_in_cell_.resize(points_.size());
    cell_start_.assign(static_cast<std::size_t>(size.prod()) + 1, 0);
    for (std::size_t k = 0; k < points_.size(); ++k) {
        cell_[k] = index_of(cell_of(particles.predicted[points_[k].particle]));
        ++cell_start_[cell_[k] + 1];
    }
    for (std::size_t c = 1; c < cell_start_.size(); ++c) {
        cell_start_[c] += cell_start_[c - 1];
    }
    for (std::size_t k = points_.size(); k-- > 0;) {
        // Fills each cell from its end, after which the entry of the next cell holds this one's start.
        const std::uint32_t n = --cell_start_[cell_[k] + 1];
        in_cell_[n] = static_cast<std::uint32_t>(k);
        at_in_cell_[n] = particles.predicted[points_[k].particle];
    }
    cell_start_.erase(cell_start_.begin());
    cell_start_.push_back(static_cast<std::uint32_t>(points_.size()));
    for (std::uint32_t t = 0; t < elements_.size(); ++t) {
        Eigen::AlignedBox3f around;
        for (const std::uint32_t i : elements_[t].corner) {
            around.extend(particles.predicted[i]);
        }
        around.min() -= Vec3f::Constant(pair_margin);
        around.max() += Vec3f::Constant(pair_margin);
        const Eigen::AlignedBox3f common = around.intersection(box);
        if (common.isEmpty()) {
            continue;
        }
        const Eigen::Vector3i low = cell_of(common.min());
        const Eigen::Vector3i high = cell_of(common.max());
        for (int z = low.z(); z <= high.z(); ++z) {
            for (int y = low.y(); y <= high.y(); ++y) {
                const std::uint32_t first = cell_start_[index_of({low.x(), y, z})];
                const std::uint32_t end = cell_start_[index_of({high.x(), y, z}) + 1];
                for (std::uint32_t n = first; n < end; ++n) {
                    if (!around.contains(at_in_cell_[n])) {
                        continue;
                    }
                    const Point& point = points_[in_cell_[n]];
                    if (!point.own || (point.rest - elements_[t].centre).norm() + elements_[t].radius >=
                                          own_neighbourhood) {
                        pairs_.push_back({t, in_cell_[n]});
                    }
                }
            }
        }
    }
}

const Eigen::Matrix3f& SelfContactFinder::cofactor_at(std::uint32_t particle,
                                                      const pbd::Particles& particles) {
    Eigen::Matrix3f& mean = cofactor_[particle];
    if (cofactor_call_[particle] == call_) {
        return mean;
    }
    cofactor_call_[particle] = call_;
    mean.setZero();
    float weight = 0.0f;
    for (std::uint32_t k = first_element_[particle]; k < first_element_[particle + 1]; ++k) {
        const Element& e = elements_[elements_of_[k]];
        const Eigen::Matrix3f now = edges_of(e.corner, particles.predicted);
        const float ratio = now.determinant() * e.inverse_determinant;
        if (ratio > least_volume) {
            const float volume = 1.0f / std::fabs(e.inverse_determinant);
            mean += volume * ratio * now.inverse().transpose() * e.edges.transpose();
            weight += volume;
        }
    }
    if (weight > 0.0f) {
        mean /= weight;
    }
    return mean;
}

void SelfContactFinder::test_pairs(const pbd::Particles& particles) {
    ++call_;
    std::ranges::fill(hits_, Hit{});
    for (std::size_t n = 0; n < pairs_.size();) {
        const std::uint32_t t = pairs_[n][0];
        const Element& e = elements_[t];
        std::size_t end = n;
        Eigen::AlignedBox3f around;
        for (const std::uint32_t i : e.corner) {
            around.extend(particles.predicted[i]);
        }
        bool any = false;
        for (; end < pairs_.size() && pairs_[end][0] == t; ++end) {
            any = any || around.contains(particles.predicted[points_[pairs_[end][1]].particle]);
        }
        const Eigen::Matrix3f now = edges_of(e.corner, particles.predicted);
        if (!any || now.determinant() * e.inverse_determinant < least_volume) {
            n = end;
            continue;
        }
        const Eigen::Matrix3f inverse = now.inverse();
        for (; n < end; ++n) {
            const std::uint32_t k = pairs_[n][1];
            const Point& point = points_[k];
            const Vec3f share =
                inverse * (particles.predicted[point.particle] - particles.predicted[e.corner[0]]);
            if (share.minCoeff() < 0.0f || share.sum() > 1.0f) {
                continue;
            }
            const Vec3f place = e.origin + e.edges * share;
            if (point.own && (place - point.rest).squaredNorm() < own_neighbourhood * own_neighbourhood) {
                continue;
            }
            const SplineDistance at = distance_.spline_sample(place);
            if (!(at.distance < 0.0f)) {
                continue;
            }
            // Of several elements, the one where the point was; a new contact takes the shallowest.
            const float score = memory_[k].known ? (place - memory_[k].place).norm() : 1.0f - at.distance;
            Hit& hit = hits_[k];
            if (hit.found && score >= hit.score) {
                continue;
            }
            Eigen::Matrix3f carry = (1.0f - share.sum()) * cofactor_at(e.corner[0], particles);
            for (int c = 0; c < 3; ++c) {
                carry += share[c] * cofactor_at(e.corner[static_cast<std::size_t>(c) + 1], particles);
            }
            hit = {score, t, share, place, carry * at.gradient, -at.distance, true};
        }
    }
}

void SelfContactFinder::find(const pbd::Particles& particles, std::vector<pbd::MeshContact>& contacts) {
    if (points_.empty()) {
        contacts.clear();
        return;
    }
    for (std::size_t n = 0; n < contacts.size(); ++n) {
        memory_[point_of_contact_[n]].contact.force = contacts[n].force;
    }
    if (stale(particles)) {
        collect_pairs(particles);
    }
    test_pairs(particles);
    contacts.clear();
    point_of_contact_.clear();
    for (std::uint32_t k = 0; k < points_.size(); ++k) {
        const Hit& hit = hits_[k];
        Memory& last = memory_[k];
        const float steepness = hit.way_out.norm();
        if (!hit.found || steepness < 1e-3f) {
            const float force = last.known ? lost_memory * last.contact.force.dot(last.contact.normal) : 0.0f;
            if (force < 1e-5f) {
                last.known = false;
                continue;
            }
            last.contact.gap = 0.0f;
            last.contact.force = force * last.contact.normal;
        } else {
            const Element& e = elements_[hit.element];
            pbd::MeshContact contact;
            contact.particle = {points_[k].particle, e.corner[0], e.corner[1], e.corner[2], e.corner[3]};
            contact.share = {1.0f, hit.share.sum() - 1.0f, -hit.share[0], -hit.share[1], -hit.share[2]};
            contact.corners = 5;
            contact.within_mesh = true;
            contact.damping = normal_damping;
            contact.friction = 0.0f;
            contact.normal = hit.way_out / steepness;
            if (last.known) {
                contact.normal = (contact.normal + normal_inertia * last.contact.normal).normalized();
                contact.force =
                    memory * std::max(0.0f, last.contact.force.dot(last.contact.normal)) * contact.normal;
            }
            contact.gap =
                std::max(-max_correction, resting_depth - hit.depth / std::clamp(steepness, 0.5f, 3.0f));
            last = {hit.place, contact, true};
        }
        contacts.push_back(last.contact);
        point_of_contact_.push_back(k);
    }
}

}  // namespace eti::scene
