// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/mesh/simplify.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "common/mesh/quadric.hpp"

namespace eti {
namespace {

constexpr std::uint32_t no_element = std::numeric_limits<std::uint32_t>::max();

struct Candidate {
    float cost;
    std::uint32_t a, b;
    std::uint32_t stamp;  ///< sum of both vertices' stamps when the cost was computed

    /// Orders the heap: cheapest first, ties by index, so the result does not depend on the heap
    /// implementation.
    bool operator<(const Candidate& o) const {
        return cost != o.cost ? cost > o.cost : a != o.a ? a > o.a : b > o.b;
    }
};

/// Priority queue of candidates, cheapest first. Only the cheapest are in a heap and the others are unsorted:
/// a heap of all candidates would miss the processor's caches at each of its levels.
class Queue {
  public:
    void clear() {
        near_.clear();
        far_.clear();
        costliest_ = {-std::numeric_limits<float>::infinity(), 0, 0, 0};
    }
    void push(const Candidate& candidate) {
        if (candidate < costliest_) {
            far_.push_back(candidate);
        } else {
            near_.push_back(candidate);
            std::push_heap(near_.begin(), near_.end());
        }
    }
    /// The next candidate that is not `stale`.
    template <class Stale>
    std::optional<Candidate> pop(const Stale& stale) {
        for (;;) {
            if (near_.empty() && !fetch(stale)) {
                return std::nullopt;
            }
            std::pop_heap(near_.begin(), near_.end());
            const Candidate candidate = near_.back();
            near_.pop_back();
            if (!stale(candidate)) {
                return candidate;
            }
        }
    }

  private:
    /// Builds a heap from the cheapest unsorted candidates; false if there are none.
    template <class Stale>
    bool fetch(const Stale& stale) {
        constexpr std::size_t least = 16384;  // 256 KiB
        std::erase_if(far_, stale);
        if (far_.empty()) {
            return false;
        }
        const auto first =
            far_.end() - static_cast<std::ptrdiff_t>(std::min(far_.size(), std::max(least, far_.size() / 8)));
        std::nth_element(far_.begin(), first, far_.end());
        costliest_ = *first;
        near_.assign(first, far_.end());
        far_.erase(first, far_.end());
        std::make_heap(near_.begin(), near_.end());
        return true;
    }

    std::vector<Candidate> near_;  ///< a heap
    std::vector<Candidate> far_;   ///< none is cheaper than `costliest_`
    Candidate costliest_{};        ///< costliest candidate moved into `near_`
};

/// The mesh during collapse. Corner 3 t + k is vertex k of triangle t; the corners of a vertex form a singly
/// linked list.
class Collapser {
  public:
    Collapser(const TriangleMesh& mesh, const SimplifySettings& settings)
        : settings_(settings), triangles_(mesh.triangles), alive_(mesh.triangles.size()) {
        position_.reserve(mesh.vertices.size());
        for (const Vec3f& v : mesh.vertices) {
            position_.push_back(v.cast<double>());
        }
        head_.assign(position_.size(), no_element);
        next_.assign(3 * triangles_.size(), no_element);
        stamp_.assign(position_.size(), 0);
        locked_.assign(position_.size(), 0);
        quadric_.resize(position_.size());
        for (std::uint32_t corner = 0; corner < next_.size(); ++corner) {
            const std::uint32_t v = triangles_[corner / 3][corner % 3];
            next_[corner] = head_[v];
            head_[v] = corner;
        }
        accumulate();
        lock_borders();
    }

    TriangleMesh run() {
        // A rejected collapse may become valid once its neighbours have moved. Sweep over all edges again
        // until the budget is met or a sweep makes little progress.
        std::size_t before = 0;
        do {
            before = alive_;
            sweep();
        } while (alive_ > settings_.triangles && alive_ + before / 50 < before);
        return compact();
    }

  private:
    void sweep() {
        queue_.clear();
        for (std::uint32_t a = 0; a < head_.size(); ++a) {
            if (head_[a] == no_element || locked_[a]) {
                continue;
            }
            neighbours(a, around_);
            for (const std::uint32_t b : around_) {
                if (a < b && !locked_[b]) {
                    queue_.push(evaluate(a, b));
                }
            }
        }
        const auto stale = [this](const Candidate& c) {
            return stamp_[c.a] + stamp_[c.b] != c.stamp || head_[c.a] == no_element ||
                   head_[c.b] == no_element;
        };
        while (alive_ > settings_.triangles) {
            const std::optional<Candidate> cheapest = queue_.pop(stale);
            if (!cheapest) {
                break;
            }
            try_collapse(cheapest->a, cheapest->b);
        }
    }

    [[nodiscard]] Vec3d normal_of(const Triangle& t) const {
        return (position_[t[1]] - position_[t[0]]).cross(position_[t[2]] - position_[t[0]]);
    }

    void accumulate() {
        for (const Triangle& t : triangles_) {
            const Vec3d twice_area = normal_of(t);
            const double length = twice_area.norm();
            if (length == 0.0) {
                continue;
            }
            const Vec3d normal = twice_area / length;
            for (const std::uint32_t v : t) {
                const double factor = settings_.importance.empty() ? 1.0 : double{settings_.importance[v]};
                quadric_[v].add_plane(normal, -normal.dot(position_[t[0]]), factor * length / 6.0);
            }
        }
    }

    /// Locks the vertices of edges that do not have exactly two triangles.
    void lock_borders() {
        for (std::uint32_t v = 0; v < head_.size(); ++v) {
            around_.clear();
            for (std::uint32_t corner = head_[v]; corner != no_element; corner = next_[corner]) {
                around_.push_back(follower(corner, 1));
                around_.push_back(follower(corner, 2));
            }
            std::sort(around_.begin(), around_.end());
            for (std::size_t i = 0; i < around_.size();) {
                std::size_t end = i;
                while (end < around_.size() && around_[end] == around_[i]) {
                    ++end;
                }
                if (end - i != 2) {
                    locked_[v] = 1;
                }
                i = end;
            }
        }
    }

    [[nodiscard]] std::uint32_t follower(std::uint32_t corner, std::uint32_t steps) const {
        return triangles_[corner / 3][(corner % 3 + steps) % 3];
    }

    [[nodiscard]] Vec3d target(std::uint32_t a, std::uint32_t b, const Quadric& sum) const {
        return sum.minimum(0.5 * (position_[a] + position_[b]));
    }

    [[nodiscard]] Candidate evaluate(std::uint32_t a, std::uint32_t b) const {
        Quadric sum = quadric_[a];
        sum += quadric_[b];
        // On flat regions short edges collapse first: 1 % of an edge's length counts as error.
        const double bias = 1e-4 * sum.trace() * (position_[a] - position_[b]).squaredNorm();
        return {static_cast<float>(sum.at(target(a, b, sum)) + bias), a, b, stamp_[a] + stamp_[b]};
    }

    void neighbours(std::uint32_t v, std::vector<std::uint32_t>& out) const {
        out.clear();
        for (std::uint32_t corner = head_[v]; corner != no_element; corner = next_[corner]) {
            // On a closed fan every neighbour follows v in exactly one triangle.
            out.push_back(follower(corner, 1));
        }
    }

    /// Link condition: only the two opposite vertices may neighbour both ends, and the result may not be
    /// flat.
    [[nodiscard]] bool keeps_manifold(std::uint32_t a, std::uint32_t b) {
        neighbours(a, around_);
        neighbours(b, around_other_);
        int common = 0;
        for (const std::uint32_t v : around_) {
            common += std::find(around_other_.begin(), around_other_.end(), v) != around_other_.end() ? 1 : 0;
        }
        return common == 2 && around_.size() + around_other_.size() > 6;
    }

    /// Whether the triangles around edge ab keep their orientation when both ends move to `to`, and the worst
    /// of them is no thinner than the worst before.
    [[nodiscard]] bool keeps_shape(std::uint32_t a, std::uint32_t b, const Vec3d& to) const {
        constexpr double well_shaped = 0.1;
        double worst_before = well_shaped;
        double worst_after = well_shaped;
        for (const auto& [v, other] : {std::array{a, b}, std::array{b, a}}) {
            for (std::uint32_t corner = head_[v]; corner != no_element; corner = next_[corner]) {
                const std::uint32_t p = follower(corner, 1);
                const std::uint32_t q = follower(corner, 2);
                const Vec3d side = position_[q] - position_[p];
                const Vec3d before = side.cross(position_[v] - position_[p]);
                worst_before = std::min(worst_before, slimness(before, side, position_[v] - position_[p],
                                                               position_[v] - position_[q]));
                if (p == other || q == other) {
                    continue;
                }
                const Vec3d after = side.cross(to - position_[p]);
                const double turn = before.dot(after);
                // cos 70 deg = 0.34
                if (turn <= 0.0 || turn * turn < 0.1156 * before.squaredNorm() * after.squaredNorm()) {
                    return false;
                }
                worst_after =
                    std::min(worst_after, slimness(after, side, to - position_[p], to - position_[q]));
            }
        }
        return worst_after >= worst_before;
    }

    /// Twice the area over the longest side squared: 0.87 for an equilateral triangle.
    [[nodiscard]] static double slimness(const Vec3d& twice_area, const Vec3d& a, const Vec3d& b,
                                         const Vec3d& c) {
        return twice_area.norm() / std::max({a.squaredNorm(), b.squaredNorm(), c.squaredNorm()});
    }

    void try_collapse(std::uint32_t a, std::uint32_t b) {
        Quadric sum = quadric_[a];
        sum += quadric_[b];
        if (!keeps_manifold(a, b)) {
            return;
        }
        // Where the optimal position would spoil the shape, fall back to one of the ends.
        const double limit = static_cast<double>(settings_.max_error);
        const double allowed = limit * limit * sum.trace();
        const std::array<Vec3d, 3> places = {target(a, b, sum), position_[a], position_[b]};
        const auto place = std::find_if(places.begin(), places.end(), [&](const Vec3d& to) {
            return sum.at(to) <= allowed && keeps_shape(a, b, to);
        });
        if (place == places.end()) {
            return;
        }
        merge(a, b);
        position_[a] = *place;
        quadric_[a] = sum;
        ++stamp_[a];
        ++stamp_[b];
        neighbours(a, around_);
        for (const std::uint32_t v : around_) {
            if (!locked_[v]) {
                queue_.push(evaluate(std::min(a, v), std::max(a, v)));
            }
        }
    }

    /// Removes b and the two triangles at edge ab; a inherits the rest.
    void merge(std::uint32_t a, std::uint32_t b) {
        std::uint32_t kept = no_element;
        const auto keep = [&](std::uint32_t corner) {
            next_[corner] = kept;
            kept = corner;
        };
        std::uint32_t following = no_element;
        for (std::uint32_t corner = head_[a]; corner != no_element; corner = following) {
            following = next_[corner];
            const std::uint32_t p = follower(corner, 1);
            const std::uint32_t q = follower(corner, 2);
            if (p == b || q == b) {
                unlink(p == b ? q : p, corner / 3);
            } else {
                keep(corner);
            }
        }
        for (std::uint32_t corner = head_[b]; corner != no_element; corner = following) {
            following = next_[corner];
            if (follower(corner, 1) == a || follower(corner, 2) == a) {
                triangles_[corner / 3][0] = no_element;
                --alive_;
            } else {
                triangles_[corner / 3][corner % 3] = a;
                keep(corner);
            }
        }
        head_[a] = kept;
        head_[b] = no_element;
    }

    void unlink(std::uint32_t v, std::uint32_t triangle) {
        std::uint32_t* link = &head_[v];
        while (*link / 3 != triangle) {
            link = &next_[*link];
        }
        *link = next_[*link];
    }

    [[nodiscard]] TriangleMesh compact() const {
        TriangleMesh mesh;
        mesh.triangles.reserve(alive_);
        std::vector<std::uint32_t> renamed(position_.size(), no_element);
        for (const Triangle& t : triangles_) {
            if (t[0] == no_element) {
                continue;
            }
            Triangle out{};
            for (std::size_t k = 0; k < 3; ++k) {
                if (renamed[t[k]] == no_element) {
                    renamed[t[k]] = static_cast<std::uint32_t>(mesh.vertices.size());
                    mesh.vertices.push_back(position_[t[k]].cast<float>());
                }
                out[k] = renamed[t[k]];
            }
            mesh.triangles.push_back(out);
        }
        return mesh;
    }

    const SimplifySettings& settings_;
    std::vector<Triangle> triangles_;
    std::size_t alive_;
    std::vector<Vec3d> position_;
    std::vector<std::uint32_t> head_;
    std::vector<std::uint32_t> next_;
    std::vector<std::uint32_t> stamp_;
    std::vector<std::uint8_t> locked_;
    std::vector<Quadric> quadric_;
    Queue queue_;
    std::vector<std::uint32_t> around_;
    std::vector<std::uint32_t> around_other_;
};

}  // namespace

TriangleMesh simplify(const TriangleMesh& mesh, const SimplifySettings& settings) {
    return Collapser(mesh, settings).run();
}

}  // namespace eti
