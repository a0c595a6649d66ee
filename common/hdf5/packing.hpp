// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "common/hdf5/group.hpp"
#include "common/mesh/skinning.hpp"
#include "common/mesh/triangle_mesh.hpp"
#include "common/model/surface.hpp"
#include "common/model/tissue.hpp"

namespace eti::hdf5 {

/// Rows of N equal numbers without padding, stored as a data set with N columns.
template <class Row>
struct RowOf;
template <>
struct RowOf<Vec3f> {
    using Number = float;
};
template <class T, std::size_t N>
struct RowOf<std::array<T, N>> {
    using Number = T;
};

template <class Row>
inline constexpr std::size_t columns_of = sizeof(Row) / sizeof(typename RowOf<Row>::Number);

/// The numbers of rows, in order.
template <class Row>
[[nodiscard]] std::span<const typename RowOf<Row>::Number> numbers_of(const std::vector<Row>& rows) {
    using Number = typename RowOf<Row>::Number;
    static_assert(sizeof(Row) % sizeof(Number) == 0);
    return {reinterpret_cast<const Number*>(rows.data()), rows.size() * columns_of<Row>};
}

template <class Row>
void write_rows(const Group& group, const std::string& name, const std::vector<Row>& rows,
                const Label& label) {
    group.write(name, numbers_of(rows), {rows.size(), columns_of<Row>}, label);
}

/// Reads `count` rows; any_extent reads all.
template <class Row>
[[nodiscard]] std::vector<Row> read_rows(const Group& group, const std::string& name,
                                         std::size_t count = any_extent) {
    using Number = typename RowOf<Row>::Number;
    const Array<Number> array = group.read<Number>(name, {count, columns_of<Row>});
    std::vector<Row> rows(array.shape[0]);
    if (!rows.empty()) {
        std::memcpy(static_cast<void*>(rows.data()), array.values.data(),
                    array.values.size() * sizeof(Number));
    }
    return rows;
}

/// A mesh as `vertices` and `triangles`.
void write_mesh(const Group& group, const TriangleMesh& mesh);
[[nodiscard]] TriangleMesh read_mesh(const Group& group);

/// Skin weights as `skin_frame` and `skin_weight`.
void write_skin(const Group& group, const std::vector<SkinWeights>& skin);
[[nodiscard]] std::vector<SkinWeights> read_skin(const Group& group, std::size_t count);

/// Writes tissue numbers; state the names of the numbers in the description.
void write_tissues(const Group& group, const std::string& name, const std::vector<Tissue>& tissues);
[[nodiscard]] std::vector<Tissue> read_tissues(const Group& group, const std::string& name,
                                               std::size_t count);

void write_surface(const Group& group, const Surface& surface);
/// Reads a surface of a model with `frames` frames. Throws Error naming the inconsistent data set.
[[nodiscard]] Surface read_surface(const Group& group, std::size_t frames);

// Checks to run before computing with a file's contents. Each throws Error naming the data set.
void require_finite(const Group& group, const std::string& name, std::span<const float> values);
void require_indices(const Group& group, const std::string& name, std::span<const std::uint32_t> indices,
                     std::size_t count, std::string_view of_what);
/// Frames in range, weights in 0..1 that sum to one.
void require_skin(const Group& group, std::span<const SkinWeights> skin, std::size_t frames);

}  // namespace eti::hdf5
