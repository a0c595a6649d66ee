// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/mesh/isosurface.hpp"

#include <algorithm>
#include <limits>

namespace eti {
namespace {

/// Corner k of a cube lies at (k & 1, k >> 1 & 1, k >> 2). The six tetrahedra around the diagonal
/// 0-7, each written so that det(v1 - v0, v2 - v0, v3 - v0) > 0.
constexpr std::array<std::array<int, 4>, 6> tetrahedra = {
    {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7}, {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}}};

constexpr float corner_clearance = 0.02f;

/// Sweeps the field slice by slice and keeps the edge vertices of two slices. Every edge of the decomposition
/// runs from a node to one of its seven upper neighbours, so a slice stores seven indices per node. All
/// coordinates are padded by one node on each side.
class Marcher {
  public:
    Marcher(const DistanceGrid& field, float level, Border border)
        : field_(field),
          level_(level),
          border_(border),
          width_(field.size[0] + 2),
          height_(field.size[1] + 2) {
        const std::size_t area = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
        for (auto& layer : layers_) {
            layer.inside.resize(area);
            layer.value.resize(area);
            layer.vertex.resize(area);
        }
        mask_.resize(area);
    }

    TriangleMesh run() {
        const int depth = field_.size[2] + 2;
        load(0, layers_[0]);
        load(1, layers_[1]);
        classify(layers_[0], layers_[1], mask_);
        place_vertices(0, layers_[0], layers_[1], mask_);
        std::vector<std::uint8_t> next_mask(mask_.size());
        for (int z = 0; z + 1 < depth; ++z) {
            load(z + 2, layers_[2]);
            classify(layers_[1], layers_[2], next_mask);
            place_vertices(z + 1, layers_[1], layers_[2], next_mask);
            triangulate(z);
            std::swap(layers_[0], layers_[1]);
            std::swap(layers_[1], layers_[2]);
            mask_.swap(next_mask);
        }
        return std::move(mesh_);
    }

  private:
    struct Layer {
        std::vector<std::uint8_t> inside;
        std::vector<float> value;
        std::vector<std::array<std::uint32_t, 7>> vertex;  ///< on the edge to corner k + 1
    };

    void load(int z, Layer& layer) const {
        std::fill(layer.inside.begin(), layer.inside.end(), std::uint8_t{0});
        std::fill(layer.value.begin(), layer.value.end(), std::numeric_limits<float>::infinity());
        if (z < 1 || z > field_.size[2]) {
            return;
        }
        for (int y = 0; y < field_.size[1]; ++y) {
            const float* row = &field_.value[field_.index(0, y, z - 1)];
            const std::size_t at = static_cast<std::size_t>(y + 1) * static_cast<std::size_t>(width_) + 1;
            for (std::size_t x = 0; x < static_cast<std::size_t>(field_.size[0]); ++x) {
                layer.value[at + x] = row[x];
                layer.inside[at + x] = row[x] < level_ ? 1 : 0;
            }
        }
    }

    /// Bit k of a cube's mask is set when its corner k is inside.
    void classify(const Layer& lower, const Layer& upper, std::vector<std::uint8_t>& mask) const {
        const auto w = static_cast<std::size_t>(width_);
        for (std::size_t y = 0; y + 1 < static_cast<std::size_t>(height_); ++y) {
            const std::uint8_t* a = &lower.inside[y * w];
            const std::uint8_t* b = a + w;
            const std::uint8_t* c = &upper.inside[y * w];
            const std::uint8_t* d = c + w;
            std::uint8_t* out = &mask[y * w];
            for (std::size_t x = 0; x + 1 < w; ++x) {
                out[x] = static_cast<std::uint8_t>(a[x] | a[x + 1] << 1 | b[x] << 2 | b[x + 1] << 3 |
                                                   c[x] << 4 | c[x + 1] << 5 | d[x] << 6 | d[x + 1] << 7);
            }
        }
    }

    void place_vertices(int z, Layer& lower, const Layer& upper, const std::vector<std::uint8_t>& mask) {
        const auto w = static_cast<std::size_t>(width_);
        for (int y = 0; y + 1 < height_; ++y) {
            for (int x = 0; x + 1 < width_; ++x) {
                const std::size_t at = static_cast<std::size_t>(y) * w + static_cast<std::size_t>(x);
                const std::uint8_t bits = mask[at];
                if (bits == 0 || bits == 255) {
                    continue;
                }
                for (std::size_t k = 1; k < 8; ++k) {
                    if (((bits >> k ^ bits) & 1) == 0) {
                        continue;
                    }
                    const std::size_t other = at + (k & 1) + (k >> 1 & 1) * w;
                    const float from = lower.value[at];
                    const float to = (k >> 2 != 0 ? upper : lower).value[other];
                    const Vec3f step(static_cast<float>(k & 1), static_cast<float>(k >> 1 & 1),
                                     static_cast<float>(k >> 2));
                    lower.vertex[at][k - 1] = static_cast<std::uint32_t>(mesh_.vertices.size());
                    mesh_.vertices.push_back(field_.node(x - 1, y - 1, z - 1) +
                                             field_.spacing * fraction(from, to) * step);
                }
            }
        }
    }

    /// Position of the level between two values. Values beyond the border are infinite, which puts the cap
    /// next to the outermost node.
    [[nodiscard]] float fraction(float from, float to) const {
        float t = 0.5f;
        if (to == std::numeric_limits<float>::infinity()) {
            t = 0.0f;
        } else if (from == std::numeric_limits<float>::infinity()) {
            t = 1.0f;
        } else {
            t = (level_ - from) / (to - from);
        }
        // This comparison order also replaces NaN.
        return std::min(std::max(corner_clearance, t), 1.0f - corner_clearance);
    }

    void triangulate(int z) {
        const bool open = border_ == Border::open;
        if (open && (z == 0 || z == field_.size[2])) {
            return;
        }
        const auto w = static_cast<std::size_t>(width_);
        const int first = open ? 1 : 0;
        for (int y = first; y + 1 + first < height_; ++y) {
            for (int x = first; x + 1 + first < width_; ++x) {
                const std::size_t at = static_cast<std::size_t>(y) * w + static_cast<std::size_t>(x);
                if (mask_[at] == 0 || mask_[at] == 255) {
                    continue;
                }
                for (const auto& tetrahedron : tetrahedra) {
                    cut(at, mask_[at], tetrahedron);
                }
            }
        }
    }

    /// Adds the one or two triangles of a tetrahedron.
    void cut(std::size_t at, std::uint8_t bits, const std::array<int, 4>& corner) {
        // Corners reordered to (inside..., outside...) by even permutations of the tetrahedron.
        int count = 0;
        std::array<bool, 4> inside{};
        for (std::size_t i = 0; i < 4; ++i) {
            inside[i] = (bits >> corner[i] & 1) != 0;
            count += inside[i] ? 1 : 0;
        }
        if (count == 0 || count == 4) {
            return;
        }
        // Row i is an even permutation that starts with i.
        static constexpr std::array<std::array<std::size_t, 4>, 4> start_with = {
            {{0, 1, 2, 3}, {1, 0, 3, 2}, {2, 3, 0, 1}, {3, 2, 1, 0}}};
        const auto vertex = [&](std::size_t i, std::size_t j) {
            return edge_vertex(at, corner[i], corner[j]);
        };
        if (count == 2) {
            // Even permutations that start with a given pair.
            static constexpr std::array<std::array<std::size_t, 4>, 6> pairs = {
                {{0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 1, 2}, {1, 2, 0, 3}, {1, 3, 2, 0}, {2, 3, 0, 1}}};
            for (const auto& p : pairs) {
                if (inside[p[0]] && inside[p[1]]) {
                    const std::uint32_t a = vertex(p[0], p[2]);
                    const std::uint32_t b = vertex(p[0], p[3]);
                    const std::uint32_t c = vertex(p[1], p[3]);
                    const std::uint32_t d = vertex(p[1], p[2]);
                    mesh_.triangles.push_back({a, b, c});
                    mesh_.triangles.push_back({a, c, d});
                    return;
                }
            }
        }
        const bool lone_inside = count == 1;
        for (std::size_t i = 0; i < 4; ++i) {
            if (inside[i] == lone_inside) {
                const auto& p = start_with[i];
                const std::uint32_t a = vertex(p[0], p[1]);
                const std::uint32_t b = vertex(p[0], p[2]);
                const std::uint32_t c = vertex(p[0], p[3]);
                mesh_.triangles.push_back(lone_inside ? Triangle{a, b, c} : Triangle{a, c, b});
                return;
            }
        }
    }

    [[nodiscard]] std::uint32_t edge_vertex(std::size_t at, int from, int to) const {
        const int low = std::min(from, to);
        const auto direction = static_cast<std::size_t>(std::max(from, to) - low);
        const std::size_t node = at + static_cast<std::size_t>(low & 1) +
                                 static_cast<std::size_t>(low >> 1 & 1) * static_cast<std::size_t>(width_);
        return layers_[static_cast<std::size_t>(low >> 2)].vertex[node][direction - 1];
    }

    const DistanceGrid& field_;
    float level_;
    Border border_;
    int width_;
    int height_;
    std::array<Layer, 3> layers_;
    std::vector<std::uint8_t> mask_;
    TriangleMesh mesh_;
};

/// Drops vertices that no triangle uses (edges of the padding, with an open border).
void drop_unused(TriangleMesh& mesh) {
    constexpr std::uint32_t unused = std::numeric_limits<std::uint32_t>::max();
    std::vector<std::uint32_t> target(mesh.vertices.size(), unused);
    for (const Triangle& triangle : mesh.triangles) {
        for (const std::uint32_t v : triangle) {
            target[v] = 0;
        }
    }
    std::uint32_t count = 0;
    for (std::size_t v = 0; v < target.size(); ++v) {
        if (target[v] != unused) {
            target[v] = count;
            mesh.vertices[count++] = mesh.vertices[v];
        }
    }
    mesh.vertices.resize(count);
    for (Triangle& triangle : mesh.triangles) {
        for (std::uint32_t& v : triangle) {
            v = target[v];
        }
    }
}

}  // namespace

TriangleMesh isosurface(const DistanceGrid& field, float level, Border border) {
    if (std::min({field.size[0], field.size[1], field.size[2]}) < 1) {
        return {};
    }
    TriangleMesh mesh = Marcher(field, level, border).run();
    if (border == Border::open) {
        drop_unused(mesh);
    }
    return mesh;
}

}  // namespace eti
