// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/mesh/intersect.hpp"

#include <algorithm>
#include <cmath>

namespace eti {
namespace {

double volume(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
    return (b - a).dot((c - a).cross(d - a));
}

struct Box {
    Vec3f low;
    Vec3f high;
};

using CellIndex = std::array<int, 3>;

/// A triangle listed in a cell. The list is sorted by cell and serves as the spatial hash.
struct Entry {
    std::uint64_t cell;
    std::uint32_t triangle;
};

struct Boxed {
    Box box;
    std::uint32_t triangle;
};

class Search {
  public:
    explicit Search(const TriangleMesh& mesh) : mesh_(mesh) {
        boxes_.reserve(mesh.triangles.size());
        double extent = 0.0;
        low_ = mesh.vertices.empty() ? Vec3f(Vec3f::Zero()) : mesh.vertices.front();
        for (const Triangle& t : mesh.triangles) {
            const Vec3f &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
            boxes_.push_back({a.cwiseMin(b).cwiseMin(c), a.cwiseMax(b).cwiseMax(c)});
            extent += static_cast<double>((boxes_.back().high - boxes_.back().low).maxCoeff());
            low_ = low_.cwiseMin(boxes_.back().low);
        }
        // About twice the mean triangle: few cells per triangle, few triangles per cell.
        const double mean = extent / static_cast<double>(std::max<std::size_t>(1, boxes_.size()));
        spacing_ = std::max(2.0f * static_cast<float>(mean), 1e-9f);
    }

    /// Pairs of which at least one triangle is flagged in `asked`; all pairs if `asked` is empty.
    std::vector<std::array<std::uint32_t, 2>> run(std::span<const std::uint8_t> asked) const {
        const auto is_asked = [&](std::uint32_t t) { return asked.empty() || asked[t] != 0; };
        std::vector<Entry> entries;
        std::vector<std::uint64_t> cells;  // cells of the flagged triangles, unless all are
        for (std::uint32_t i = 0; i < boxes_.size(); ++i) {
            if (is_asked(i)) {
                for_each_cell(boxes_[i], [&](std::uint64_t cell) { entries.push_back({cell, i}); });
            }
        }
        if (!asked.empty()) {
            for (const Entry& entry : entries) {
                cells.push_back(entry.cell);
            }
            std::sort(cells.begin(), cells.end());
            cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
            for (std::uint32_t i = 0; i < boxes_.size(); ++i) {
                if (!is_asked(i)) {
                    for_each_cell(boxes_[i], [&](std::uint64_t cell) {
                        if (std::binary_search(cells.begin(), cells.end(), cell)) {
                            entries.push_back({cell, i});
                        }
                    });
                }
            }
        }
        std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
            return a.cell != b.cell ? a.cell < b.cell : a.triangle < b.triangle;
        });
        std::vector<std::array<std::uint32_t, 2>> found;
        std::vector<Boxed> here;
        for (std::size_t begin = 0; begin < entries.size();) {
            const std::uint64_t cell = entries[begin].cell;
            here.clear();
            for (; begin < entries.size() && entries[begin].cell == cell; ++begin) {
                here.push_back({boxes_[entries[begin].triangle], entries[begin].triangle});
            }
            // Where triangles are far smaller than the mean, a cell holds many; a sweep along x leaves few
            // pairs to test.
            std::sort(here.begin(), here.end(), [](const Boxed& a, const Boxed& b) {
                return a.box.low.x() != b.box.low.x() ? a.box.low.x() < b.box.low.x()
                                                      : a.triangle < b.triangle;
            });
            for (std::size_t i = 0; i < here.size(); ++i) {
                for (std::size_t j = i + 1; j < here.size() && here[j].box.low.x() <= here[i].box.high.x();
                     ++j) {
                    if ((is_asked(here[i].triangle) || is_asked(here[j].triangle)) &&
                        intersect(here[i], here[j], cell)) {
                        const auto [one, other] = std::minmax(here[i].triangle, here[j].triangle);
                        found.push_back({one, other});
                    }
                }
            }
        }
        std::sort(found.begin(), found.end());
        return found;
    }

  private:
    /// Calls visit(key) for the cells that a box overlaps.
    template <class Visit>
    void for_each_cell(const Box& box, const Visit& visit) const {
        const CellIndex first = cell_of(box.low);
        const CellIndex last = cell_of(box.high);
        for (int z = first[2]; z <= last[2]; ++z) {
            for (int y = first[1]; y <= last[1]; ++y) {
                for (int x = first[0]; x <= last[0]; ++x) {
                    visit(key({x, y, z}));
                }
            }
        }
    }

    [[nodiscard]] CellIndex cell_of(const Vec3f& p) const {
        const Vec3f scaled = (p - low_) / spacing_;
        return {static_cast<int>(scaled.x()), static_cast<int>(scaled.y()), static_cast<int>(scaled.z())};
    }

    [[nodiscard]] static std::uint64_t key(const CellIndex& c) {
        return static_cast<std::uint64_t>(c[2]) << 42 | static_cast<std::uint64_t>(c[1]) << 21 |
               static_cast<std::uint64_t>(c[0]);
    }

    [[nodiscard]] bool intersect(const Boxed& a, const Boxed& b, std::uint64_t cell) const {
        const Vec3f low = a.box.low.cwiseMax(b.box.low);
        const Vec3f high = a.box.high.cwiseMin(b.box.high);
        // A pair that shares several cells is tested only in the cell that contains the lower corner of the
        // common box.
        if ((low.array() > high.array()).any() || key(cell_of(low)) != cell) {
            return false;
        }
        return pierces(mesh_.triangles[a.triangle], mesh_.triangles[b.triangle]) ||
               pierces(mesh_.triangles[b.triangle], mesh_.triangles[a.triangle]);
    }

    /// Whether an edge of `edges` that shares no vertex with `face` passes through it.
    [[nodiscard]] bool pierces(const Triangle& edges, const Triangle& face) const {
        const auto shared = [&](std::uint32_t v) { return v == face[0] || v == face[1] || v == face[2]; };
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t p = edges[k];
            const std::uint32_t q = edges[(k + 1) % 3];
            if (!shared(p) && !shared(q) &&
                crosses(mesh_.vertices[p], mesh_.vertices[q], mesh_.vertices[face[0]],
                        mesh_.vertices[face[1]], mesh_.vertices[face[2]])) {
                return true;
            }
        }
        return false;
    }

    const TriangleMesh& mesh_;
    std::vector<Box> boxes_;
    Vec3f low_ = Vec3f::Zero();
    float spacing_ = 1.0f;
};

}  // namespace

bool crosses(const Vec3f& p, const Vec3f& q, const Vec3f& a, const Vec3f& b, const Vec3f& c) {
    const Vec3d pd = p.cast<double>();
    const Vec3d qd = q.cast<double>();
    const Vec3d ad = a.cast<double>();
    const Vec3d bd = b.cast<double>();
    const Vec3d cd = c.cast<double>();
    if (volume(pd, ad, bd, cd) * volume(qd, ad, bd, cd) >= 0.0) {
        return false;
    }
    const double ab = volume(pd, qd, ad, bd);
    const double bc = volume(pd, qd, bd, cd);
    const double ca = volume(pd, qd, cd, ad);
    return (ab > 0.0 && bc > 0.0 && ca > 0.0) || (ab < 0.0 && bc < 0.0 && ca < 0.0);
}

std::vector<std::array<std::uint32_t, 2>> self_intersections(const TriangleMesh& mesh,
                                                             std::span<const std::uint8_t> asked) {
    return Search(mesh).run(asked);
}

}  // namespace eti
