// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/imaging/filter.hpp"

#include <algorithm>
#include <cmath>
#include <queue>

#include "server/parallel/loops.hpp"
#include "server/patient/mesh/components.hpp"

namespace eti::imaging {

namespace {

std::size_t count(const Size& size) {
    return static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) *
           static_cast<std::size_t>(size[2]);
}

/// Calls visit(first index, stride, length) for every line of voxels along an axis, in parallel.
template <class Visit>
void for_each_line(const Size& size, std::size_t axis, const Visit& visit) {
    const std::array<std::size_t, 3> stride = {
        1, static_cast<std::size_t>(size[0]),
        static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1])};
    const std::size_t outer = axis == 2 ? 1 : 2;
    const std::size_t inner = axis == 0 ? 1 : 0;
    parallel::for_each(size[outer], 1, [&](int o) {
        for (int i = 0; i < size[inner]; ++i) {
            visit(static_cast<std::size_t>(o) * stride[outer] + static_cast<std::size_t>(i) * stride[inner],
                  stride[axis], static_cast<std::size_t>(size[axis]));
        }
    });
}

constexpr float far = 1e19f;

/// Lower envelope of parabolas of one line, in place.
void squared_distances(std::vector<float>& value, std::size_t first, std::size_t stride, std::size_t n) {
    thread_local std::vector<float> line;
    thread_local std::vector<std::size_t> vertex;
    thread_local std::vector<float> border;
    line.resize(n);
    vertex.resize(n);
    border.resize(n + 1);
    for (std::size_t i = 0; i < n; ++i) {
        line[i] = value[first + i * stride];
    }
    std::size_t k = 0;
    bool any = false;
    for (std::size_t q = 0; q < n; ++q) {
        if (line[q] >= far) {
            continue;
        }
        const auto x = static_cast<float>(q);
        if (!any) {
            any = true;
            vertex[0] = q;
            border[0] = -far;
            border[1] = far;
            continue;
        }
        float s = 0.0f;
        for (;;) {
            const auto v = static_cast<float>(vertex[k]);
            s = (line[q] + x * x - (line[vertex[k]] + v * v)) / (2.0f * (x - v));
            if (s > border[k] || k == 0) {
                break;
            }
            --k;
        }
        if (s <= border[k]) {
            vertex[k] = q;
        } else {
            vertex[++k] = q;
            border[k] = s;
        }
        border[k + 1] = far;
    }
    if (!any) {
        return;
    }
    k = 0;
    for (std::size_t q = 0; q < n; ++q) {
        const auto x = static_cast<float>(q);
        while (border[k + 1] < x) {
            ++k;
        }
        const float d = x - static_cast<float>(vertex[k]);
        value[first + q * stride] = d * d + line[vertex[k]];
    }
}

std::vector<float> kernel(float sigma) {
    const int reach = std::max(1, static_cast<int>(std::ceil(3.0f * sigma)));
    std::vector<float> weight;
    for (int i = -reach; i <= reach; ++i) {
        weight.push_back(std::exp(-0.5f * static_cast<float>(i * i) / (sigma * sigma)));
    }
    return weight;
}

void convolve(const Size& size, std::vector<float>& value, const std::vector<float>& weight) {
    const auto reach = static_cast<std::ptrdiff_t>(weight.size() / 2);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        for_each_line(size, axis, [&](std::size_t first, std::size_t stride, std::size_t n) {
            thread_local std::vector<float> line;
            line.resize(n);
            for (std::size_t i = 0; i < n; ++i) {
                line[i] = value[first + i * stride];
            }
            const auto last = static_cast<std::ptrdiff_t>(n) - 1;
            for (std::ptrdiff_t i = 0; i <= last; ++i) {
                float sum = 0.0f;
                for (std::ptrdiff_t j = std::max<std::ptrdiff_t>(0, i - reach);
                     j <= std::min(last, i + reach); ++j) {
                    sum +=
                        weight[static_cast<std::size_t>(j - i + reach)] * line[static_cast<std::size_t>(j)];
                }
                value[first + static_cast<std::size_t>(i) * stride] = sum;
            }
        });
    }
}

}  // namespace

std::vector<float> distance_to(const Size& size, std::span<const std::uint8_t> mask) {
    std::vector<float> squared(mask.size());
    for (std::size_t i = 0; i < mask.size(); ++i) {
        squared[i] = mask[i] != 0 ? 0.0f : far;
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
        for_each_line(size, axis, [&](std::size_t first, std::size_t stride, std::size_t n) {
            squared_distances(squared, first, stride, n);
        });
    }
    for (float& v : squared) {
        v = std::sqrt(v);
    }
    return squared;
}

Bits morphological_close(const Size& size, std::span<const std::uint8_t> mask, float radius) {
    const int pad = static_cast<int>(std::ceil(radius)) + 1;
    const Size wide = {size[0] + 2 * pad, size[1] + 2 * pad, size[2] + 2 * pad};
    const auto at = [&](int x, int y, int z) {
        return (static_cast<std::size_t>(z + pad) * static_cast<std::size_t>(wide[1]) +
                static_cast<std::size_t>(y + pad)) *
                   static_cast<std::size_t>(wide[0]) +
               static_cast<std::size_t>(x + pad);
    };
    Bits padded(count(wide), 0);
    std::size_t i = 0;
    for (int z = 0; z < size[2]; ++z) {
        for (int y = 0; y < size[1]; ++y) {
            for (int x = 0; x < size[0]; ++x) {
                padded[at(x, y, z)] = mask[i++];
            }
        }
    }
    const std::vector<float> grown = distance_to(wide, padded);
    for (std::size_t k = 0; k < padded.size(); ++k) {
        padded[k] = grown[k] > radius ? 1 : 0;
    }
    const std::vector<float> shrunk = distance_to(wide, padded);
    Bits closed(mask.size());
    i = 0;
    for (int z = 0; z < size[2]; ++z) {
        for (int y = 0; y < size[1]; ++y) {
            for (int x = 0; x < size[0]; ++x) {
                closed[i] = mask[i] != 0 || shrunk[at(x, y, z)] > radius ? 1 : 0;
                ++i;
            }
        }
    }
    return closed;
}

std::vector<float> smooth_within(const Size& size, std::span<const float> value,
                                 std::span<const std::uint8_t> mask, float sigma) {
    std::vector<float> sum(value.size());
    std::vector<float> weight(value.size());
    for (std::size_t i = 0; i < value.size(); ++i) {
        sum[i] = mask[i] != 0 ? value[i] : 0.0f;
        weight[i] = mask[i] != 0 ? 1.0f : 0.0f;
    }
    const std::vector<float> bell = kernel(sigma);
    convolve(size, sum, bell);
    convolve(size, weight, bell);
    for (std::size_t i = 0; i < value.size(); ++i) {
        sum[i] = weight[i] > 1e-6f ? sum[i] / weight[i] : 0.0f;
    }
    return sum;
}

Watershed watershed(const Size& size, std::span<const std::uint8_t> mask, std::span<const float> height,
                    std::span<const std::uint8_t> markers) {
    struct Entry {
        float height;
        std::uint64_t order;  // insertion order breaks ties
        std::size_t voxel;
        bool operator<(const Entry& other) const {
            return height != other.height ? height < other.height : order > other.order;
        }
    };
    Watershed result;
    result.owner.assign(mask.size(), 0);
    std::priority_queue<Entry> open;
    std::uint64_t order = 0;
    for (std::size_t i = 0; i < mask.size(); ++i) {
        if (mask[i] != 0 && markers[i] != 0) {
            result.owner[i] = markers[i];
            open.push({height[i], order++, i});
        }
    }
    while (!open.empty()) {
        const Entry entry = open.top();
        open.pop();
        const std::size_t i = entry.voxel;
        const auto visit = [&](std::size_t other) {
            if (mask[other] == 0) {
                return;
            }
            const float pass = std::min(entry.height, height[other]);
            if (result.owner[other] == 0) {
                result.owner[other] = result.owner[i];
                open.push({pass, order++, other});
            } else if (result.owner[other] != result.owner[i]) {
                result.neck = std::max(result.neck, pass);
            }
        };
        for_each_neighbour(size, i, visit);
    }
    return result;
}

}  // namespace eti::imaging
