// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/mesh/adaptive_isosurface.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

namespace eti {
namespace {

constexpr std::uint32_t no_index = ~0u;
// Cells are bisected until they are at most 1.25 of the requested edge.
constexpr float coarser = 0.8f;

/// Hash map from 64-bit keys to indices, with linear probing; four times as fast as the standard map.
class IndexMap {
  public:
    IndexMap() : slots_(1u << 16, {empty, no_index}) {}

    /// The index of a key, or no_index.
    [[nodiscard]] std::uint32_t find(std::uint64_t key) const {
        for (std::size_t i = hash(key);; ++i) {
            const Slot& slot = slots_[i & (slots_.size() - 1)];
            if (slot.key == key || slot.key == empty) {
                return slot.key == key ? slot.index : no_index;
            }
        }
    }
    /// The index of a key; a new key gets `next`.
    std::uint32_t insert(std::uint64_t key, std::uint32_t next) {
        if (2 * ++count_ > slots_.size()) {
            grow();
        }
        for (std::size_t i = hash(key);; ++i) {
            Slot& slot = slots_[i & (slots_.size() - 1)];
            if (slot.key == empty) {
                slot = {key, next};
                return next;
            }
            if (slot.key == key) {
                --count_;
                return slot.index;
            }
        }
    }

  private:
    struct Slot {
        std::uint64_t key;
        std::uint32_t index;
    };
    static constexpr std::uint64_t empty = ~std::uint64_t{0};

    [[nodiscard]] static std::size_t hash(std::uint64_t key) {
        key *= 0x9e3779b97f4a7c15u;
        return static_cast<std::size_t>(key ^ key >> 32);
    }
    void grow() {
        std::vector<Slot> old(2 * slots_.size(), {empty, no_index});
        old.swap(slots_);
        for (const Slot& slot : old) {
            std::size_t i = hash(slot.key);
            while (slot.key != empty && slots_[i & (slots_.size() - 1)].key != empty) {
                ++i;
            }
            if (slot.key != empty) {
                slots_[i & (slots_.size() - 1)] = slot;
            }
        }
    }

    std::vector<Slot> slots_;
    std::size_t count_ = 0;
};

/// Position on the finest lattice.
using Place = std::array<std::uint32_t, 3>;

constexpr std::uint64_t key_of(const Place& p) {
    return static_cast<std::uint64_t>(p[2]) << 42 | static_cast<std::uint64_t>(p[1]) << 21 | p[0];
}

/// Maubach's: the edge from corner 0 to corner `tag` is bisected next.
struct Tetrahedron {
    std::array<std::uint32_t, 4> corner;
    std::uint8_t tag;    // 3, 2, 1: a cube's diagonal, a face's, an edge
    std::uint8_t level;  // bisections of the cube's edge so far
};

class Bisector {
  public:
    explicit Bisector(const AdaptiveField& field)
        : field_(field), step_(field.coarsest / static_cast<float>(1u << field.max_bisections)) {
        for (std::size_t k = 0; k < 3; ++k) {
            const auto axis = static_cast<Eigen::Index>(k);
            cubes_[k] = std::max(1u, static_cast<std::uint32_t>(
                                         std::ceil((field.high[axis] - field.low[axis]) / field.coarsest)));
        }
    }

    TriangleMesh run() {
        fill_with_cubes();
        std::vector<Tetrahedron> waiting = std::move(leaves_);
        leaves_.clear();
        while (!waiting.empty()) {
            place_middles(waiting);
            waiting = divide(waiting, [&](const Tetrahedron& t) { return wanted(t); });
        }
        // Tetrahedra with a hanging vertex are bisected as well, which may create others.
        bool hanging = true;
        const auto hung = [&](const Tetrahedron& t) {
            const bool hangs_now = hangs(t);
            hanging = hanging || hangs_now;
            return hangs_now;
        };
        for (round_ = 1; hanging; ++round_) {
            hanging = false;
            waiting = std::move(leaves_);
            leaves_.clear();
            waiting = divide(waiting, [&](const Tetrahedron& t) { return may_hang(t) && hung(t); });
            while (!waiting.empty()) {
                place_middles(waiting);
                waiting = divide(waiting, hung);
            }
        }
        return march();
    }

  private:
    [[nodiscard]] Vec3f point(const Place& p) const {
        return field_.low +
               step_ * Vec3f(static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2]));
    }

    void fill_with_cubes() {
        const std::uint32_t side = 1u << field_.max_bisections;
        // Corner k of a cube is at (k & 1, k >> 1 & 1, k >> 2).
        constexpr std::array<std::array<std::uint32_t, 2>, 6> ways = {
            {{1, 3}, {3, 2}, {2, 6}, {6, 4}, {4, 5}, {5, 1}}};
        for (std::uint32_t z = 0; z < cubes_[2]; ++z) {
            for (std::uint32_t y = 0; y < cubes_[1]; ++y) {
                for (std::uint32_t x = 0; x < cubes_[0]; ++x) {
                    const auto corner = [&](std::uint32_t k) {
                        return place_vertex(
                            {side * (x + (k & 1)), side * (y + (k >> 1 & 1)), side * (z + (k >> 2))});
                    };
                    for (const auto& [a, b] : ways) {
                        // Along edges from 0 to 7: one of two successive corners is a neighbour of 0.
                        const std::uint32_t first = (a == 1 || a == 2 || a == 4) ? a : b;
                        const std::uint32_t second = first == a ? b : a;
                        leaves_.push_back({{corner(0), corner(first), corner(second), corner(7)}, 3, 0});
                    }
                }
            }
        }
        evaluate();
        std::fill(used_.begin(), used_.end(), std::uint8_t{1});
    }

    std::uint32_t place_vertex(const Place& place) {
        const auto next = static_cast<std::uint32_t>(places_.size());
        const std::uint32_t index = vertices_.insert(key_of(place), next);
        if (index == next) {
            places_.push_back(place);
            used_.push_back(0);
            parted_.push_back(0);
        }
        return index;
    }

    [[nodiscard]] Place middle_of(std::uint32_t a, std::uint32_t b) const {
        const Place &p = places_[a], &q = places_[b];
        return {(p[0] + q[0]) / 2, (p[1] + q[1]) / 2, (p[2] + q[2]) / 2};
    }

    /// Evaluates vertices without a value.
    void evaluate() {
        const std::size_t known = values_.size();
        std::vector<Vec3f> points;
        for (std::size_t i = known; i < places_.size(); ++i) {
            points.push_back(point(places_[i]));
        }
        values_.resize(places_.size());
        field_.value(points, std::span(values_).subspan(known));
        for (std::size_t i = known; i < places_.size(); ++i) {
            bool border = false;
            for (std::size_t k = 0; k < 3; ++k) {
                border = border || places_[i][k] == 0 || places_[i][k] == cubes_[k] << field_.max_bisections;
            }
            // The box's border is outside, so that solids are capped there.
            if (border) {
                values_[i] = std::max(values_[i], 0.01f * step_);
            }
        }
    }

    [[nodiscard]] bool can_be_bisected(const Tetrahedron& t) const { return t.level < field_.max_bisections; }

    [[nodiscard]] Place middle_of(const Tetrahedron& t) const {
        return middle_of(t.corner[0], t.corner[t.tag]);
    }

    /// Evaluates the midpoints at which these can be bisected.
    void place_middles(const std::vector<Tetrahedron>& waiting) {
        for (const Tetrahedron& t : waiting) {
            if (can_be_bisected(t)) {
                place_vertex(middle_of(t));
            }
        }
        evaluate();
    }

    /// Bisects where `ask` says so, appends the rest to the leaves and returns the children. Requires
    /// place_middles().
    template <class Ask>
    std::vector<Tetrahedron> divide(const std::vector<Tetrahedron>& waiting, const Ask& ask) {
        std::vector<Tetrahedron> children;
        for (const Tetrahedron& t : waiting) {
            if (!can_be_bisected(t) || !ask(t)) {
                leaves_.push_back(t);
                continue;
            }
            const std::uint32_t m = vertices_.find(key_of(middle_of(t)));
            used_[m] = 1;
            parted_[t.corner[0]] = parted_[t.corner[t.tag]] = round_;
            const auto [a, b, c, d] = t.corner;
            const auto level = static_cast<std::uint8_t>(t.tag == 1 ? t.level + 1 : t.level);
            switch (t.tag) {
                case 3:
                    children.push_back({{a, b, c, m}, 2, level});
                    children.push_back({{b, c, d, m}, 2, level});
                    break;
                case 2:
                    children.push_back({{a, b, m, d}, 1, level});
                    children.push_back({{b, c, m, d}, 1, level});
                    break;
                default:
                    children.push_back({{a, m, c, d}, 3, level});
                    children.push_back({{b, m, c, d}, 3, level});
                    break;
            }
        }
        return children;
    }

    [[nodiscard]] bool wanted(const Tetrahedron& t) const {
        const std::uint32_t middle = vertices_.find(key_of(middle_of(t)));
        // Three bisections halve a tetrahedron's size by equal factors; the size of a cube's six is the
        // cube's edge.
        constexpr std::array<float, 4> share = {0.0f, 0.63f, 0.79f, 1.0f};
        const float size = share[t.tag] * field_.coarsest / static_cast<float>(1u << t.level);
        // Cells grow with the distance from the surface, about as fast as conformity permits.
        constexpr float growth = 0.5f;
        return growth * std::fabs(values_[middle]) < size &&
               field_.edge(point(places_[middle])) < coarser * size;
    }

    /// False only for leaves that had no hanging vertex in the last round, and none of whose edges was
    /// bisected since.
    [[nodiscard]] bool may_hang(const Tetrahedron& t) const {
        int ends = 0;
        for (const std::uint32_t c : t.corner) {
            ends += parted_[c] + 1 >= round_ ? 1 : 0;
        }
        return ends >= 2;
    }

    [[nodiscard]] bool hangs(const Tetrahedron& t) const {
        for (std::size_t i = 0; i < 4; ++i) {
            for (std::size_t j = i + 1; j < 4; ++j) {
                const Place &p = places_[t.corner[i]], &q = places_[t.corner[j]];
                if ((((p[0] + q[0]) | (p[1] + q[1]) | (p[2] + q[2])) & 1) != 0) {
                    continue;  // at maximum depth
                }
                const std::uint32_t index = vertices_.find(key_of(middle_of(t.corner[i], t.corner[j])));
                if (index != no_index && used_[index] != 0) {
                    return true;
                }
            }
        }
        return false;
    }

    /// Edge of the lattice across which the surface passes, as shares of the way from `a` to `b`.
    struct Crossing {
        std::uint32_t a, b;
        float low, high;        // the surface lies between
        float at_low, at_high;  // values there, of opposite sign
        [[nodiscard]] float share() const {
            // Away from the corners, to avoid triangles without area. This order of comparison also replaces
            // NaN.
            constexpr float clearance = 0.02f;
            const float t = low + (high - low) * at_low / (at_low - at_high);
            return std::min(std::max(clearance, t), 1.0f - clearance);
        }
    };

    [[nodiscard]] Vec3f point(const Crossing& c) const {
        return point(places_[c.a]) + c.share() * (point(places_[c.b]) - point(places_[c.a]));
    }

    /// Moves vertices along their edges onto the surface (regula falsi, Illinois variant): a field need not
    /// be linear between corners, and where it is least so the surface would ripple with the lattice.
    void refine(std::vector<Crossing>& crossings, std::vector<Vec3f>& vertices) const {
        constexpr int rounds = 3;
        std::vector<float> values(vertices.size());
        for (int round = 0; round < rounds; ++round) {
            field_.value(vertices, values);
            for (std::size_t i = 0; i < vertices.size(); ++i) {
                Crossing& c = crossings[i];
                const float t = c.share();
                if ((values[i] < 0.0f) == (c.at_low < 0.0f)) {
                    c.low = t;
                    c.at_low = values[i];
                    c.at_high *= 0.5f;
                } else {
                    c.high = t;
                    c.at_high = values[i];
                    c.at_low *= 0.5f;
                }
                vertices[i] = point(c);
            }
        }
    }

    TriangleMesh march() const {
        TriangleMesh mesh;
        std::vector<Crossing> crossings;
        IndexMap edges;
        const auto vertex = [&](std::uint32_t in, std::uint32_t out) {
            const std::uint32_t a = std::min(in, out), b = std::max(in, out);
            const auto next = static_cast<std::uint32_t>(mesh.vertices.size());
            const std::uint32_t index = edges.insert(static_cast<std::uint64_t>(a) << 32 | b, next);
            if (index == next) {
                crossings.push_back({a, b, 0.0f, 1.0f, values_[a], values_[b]});
                mesh.vertices.push_back(point(crossings.back()));
            }
            return index;
        };
        for (const Tetrahedron& t : leaves_) {
            std::array<std::uint32_t, 4> sorted{};  // inside first, oriented
            std::size_t inside = 0, outside = 0;
            for (const std::uint32_t c : t.corner) {
                (values_[c] < 0.0f ? sorted[inside++] : sorted[3 - outside++]) = c;
            }
            if (inside == 0 || outside == 0) {
                continue;
            }
            if (!positive(sorted)) {
                inside >= 2 ? std::swap(sorted[0], sorted[1]) : std::swap(sorted[2], sorted[3]);
            }
            const auto& [a, b, c, d] = sorted;
            if (inside == 1) {
                mesh.triangles.push_back({vertex(a, b), vertex(a, c), vertex(a, d)});
            } else if (inside == 3) {
                mesh.triangles.push_back({vertex(d, b), vertex(d, c), vertex(d, a)});
            } else {
                const std::uint32_t p = vertex(a, c), q = vertex(a, d), r = vertex(b, d), s = vertex(b, c);
                mesh.triangles.push_back({p, q, r});
                mesh.triangles.push_back({p, r, s});
            }
        }
        refine(crossings, mesh.vertices);
        return mesh;
    }

    [[nodiscard]] bool positive(const std::array<std::uint32_t, 4>& t) const {
        std::array<std::array<std::int64_t, 3>, 3> way{};
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t k = 0; k < 3; ++k) {
                way[i][k] = std::int64_t{places_[t[i + 1]][k]} - std::int64_t{places_[t[0]][k]};
            }
        }
        const auto& [u, v, w] = way;
        return u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) +
                   u[2] * (v[0] * w[1] - v[1] * w[0]) >
               0;
    }

    const AdaptiveField& field_;
    float step_;  // [m], spacing of the finest lattice
    std::array<std::uint32_t, 3> cubes_{};
    std::vector<Place> places_;
    std::vector<float> values_;
    std::vector<std::uint8_t> used_;     // whether it is a corner, not only an evaluated midpoint
    std::vector<std::uint32_t> parted_;  // last round in which an edge at this vertex was bisected
    std::uint32_t round_ = 0;
    IndexMap vertices_;
    std::vector<Tetrahedron> leaves_;
};

}  // namespace

TriangleMesh adaptive_isosurface(const AdaptiveField& field) {
    return Bisector(field).run();
}

}  // namespace eti
