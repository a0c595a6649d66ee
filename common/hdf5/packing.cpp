// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/hdf5/packing.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

namespace eti::hdf5 {

static_assert(sizeof(Vec3f) == 3 * sizeof(float));
static_assert(sizeof(Triangle) == 3 * sizeof(std::uint32_t));

void write_mesh(const Group& group, const TriangleMesh& mesh) {
    write_rows(group, "vertices", mesh.vertices, {"m", "x y z of each vertex, rest posture"});
    write_rows(group, "triangles", mesh.triangles,
               {"1", "vertex indices, counter-clockwise seen from outside"});
}

TriangleMesh read_mesh(const Group& group) {
    TriangleMesh mesh{read_rows<Vec3f>(group, "vertices"), read_rows<Triangle>(group, "triangles")};
    require_finite(group, "vertices", numbers_of(mesh.vertices));
    require_indices(group, "triangles", numbers_of(mesh.triangles), mesh.vertices.size(), "vertices");
    return mesh;
}

void write_skin(const Group& group, const std::vector<SkinWeights>& skin) {
    std::vector<decltype(SkinWeights::frame)> frames;
    std::vector<decltype(SkinWeights::weight)> weights;
    for (const SkinWeights& point : skin) {
        frames.push_back(point.frame);
        weights.push_back(point.weight);
    }
    write_rows(group, "skin_frame", frames, {"1", "the frames that carry each point"});
    write_rows(group, "skin_weight", weights,
               {"1", "their weights, which sum to one; unused entries are zero"});
}

std::vector<SkinWeights> read_skin(const Group& group, std::size_t count) {
    // Files of older versions have four frames per point.
    const auto frames = group.read<std::uint16_t>("skin_frame", {count, any_extent});
    const std::size_t width = frames.shape[1];
    if (width > frames_per_point) {
        throw Error(fmt::format("{}: {} frames per point; this program reads at most {}",
                                group.at("skin_frame"), width, frames_per_point));
    }
    const auto weights = group.read<float>("skin_weight", frames.shape);
    std::vector<SkinWeights> skin(frames.shape[0]);
    for (std::size_t i = 0; i < skin.size(); ++i) {
        std::copy_n(frames.values.begin() + static_cast<std::ptrdiff_t>(i * width), width,
                    skin[i].frame.begin());
        std::copy_n(weights.values.begin() + static_cast<std::ptrdiff_t>(i * width), width,
                    skin[i].weight.begin());
    }
    return skin;
}

void write_tissues(const Group& group, const std::string& name, const std::vector<Tissue>& tissues) {
    std::string description = "tissue:";
    for (std::size_t i = 0; i < tissue_count; ++i) {
        description += fmt::format(" {} {}{}", i, tissue_names[i], i + 1 < tissue_count ? "," : "");
    }
    std::vector<std::uint8_t> numbers;
    numbers.reserve(tissues.size());
    for (const Tissue tissue : tissues) {
        numbers.push_back(static_cast<std::uint8_t>(tissue));
    }
    group.write<std::uint8_t>(name, numbers, {numbers.size()}, {"1", description});
}

std::vector<Tissue> read_tissues(const Group& group, const std::string& name, std::size_t count) {
    const auto array = group.read<std::uint8_t>(name, {count});
    std::vector<Tissue> tissues;
    tissues.reserve(array.values.size());
    for (const std::uint8_t number : array.values) {
        if (number >= tissue_count) {
            throw Error(fmt::format("{}: {} is not a tissue; expected 0 to {}", group.at(name), number,
                                    tissue_count - 1));
        }
        tissues.push_back(static_cast<Tissue>(number));
    }
    return tissues;
}

void write_surface(const Group& group, const Surface& surface) {
    group.set_text("name", surface.name);
    group.set_integer("tissue", static_cast<std::uint64_t>(surface.tissue));
    write_mesh(group, surface.mesh);
    write_tissues(group, "triangle_tissue", surface.triangle_tissue);
    write_skin(group, surface.skin);
}

Surface read_surface(const Group& group, std::size_t frames) {
    Surface surface;
    surface.name = group.text("name");
    const std::uint64_t tissue = group.integer("tissue");
    if (tissue >= tissue_count) {
        throw Error(fmt::format("{}: attribute tissue: {} is not a tissue", group.place(), tissue));
    }
    surface.tissue = static_cast<Tissue>(tissue);
    surface.mesh = read_mesh(group);
    surface.triangle_tissue = read_tissues(group, "triangle_tissue", surface.mesh.triangles.size());
    surface.skin = read_skin(group, surface.mesh.vertices.size());
    require_skin(group, surface.skin, frames);
    return surface;
}

void require_finite(const Group& group, const std::string& name, std::span<const float> values) {
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (!std::isfinite(values[i])) {
            throw Error(fmt::format("{}: value {} is not finite", group.at(name), i));
        }
    }
}

void require_indices(const Group& group, const std::string& name, std::span<const std::uint32_t> indices,
                     std::size_t count, std::string_view of_what) {
    for (std::size_t i = 0; i < indices.size(); ++i) {
        if (indices[i] >= count) {
            throw Error(fmt::format("{}: value {} is {}, but there are only {} {}", group.at(name), i,
                                    indices[i], count, of_what));
        }
    }
}

void require_skin(const Group& group, std::span<const SkinWeights> skin, std::size_t frames) {
    // The sum of eight float32 weights, each rounded once, is within 8 * 6e-8 of one. The tolerance also
    // accepts weights that a tool rounded to three decimals, but no missing weight.
    constexpr float tolerance = 1e-3f;
    for (std::size_t i = 0; i < skin.size(); ++i) {
        float sum = 0.0f;
        for (std::size_t k = 0; k < frames_per_point; ++k) {
            const float weight = skin[i].weight[k];
            if (!(weight >= 0.0f && weight <= 1.0f + tolerance)) {
                throw Error(fmt::format("{}: point {} has the weight {}; expected 0 to 1",
                                        group.at("skin_weight"), i, weight));
            }
            if (weight > 0.0f && skin[i].frame[k] >= frames) {
                throw Error(fmt::format("{}: point {} refers to frame {}, but there are only {}",
                                        group.at("skin_frame"), i, skin[i].frame[k], frames));
            }
            sum += weight;
        }
        if (std::abs(sum - 1.0f) > tolerance) {
            throw Error(fmt::format("{}: the weights of point {} sum to {}; expected 1",
                                    group.at("skin_weight"), i, sum));
        }
    }
}

}  // namespace eti::hdf5
