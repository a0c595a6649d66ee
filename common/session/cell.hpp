// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "common/hdf5/group.hpp"
#include "common/math/transform.hpp"

namespace eti::session {

template <class T>
[[nodiscard]] hdf5::Handle number() {
    return {H5Tcopy(hdf5::number_type<T>()), H5Tclose};
}

/// Maps a field of a record to one row of its data set: element type, extents behind the row's index, and
/// conversion in both directions. `width` is used for fields of variable size only: bytes of a text, points
/// of a line.
template <class T>
struct Cell {
    static_assert(std::is_arithmetic_v<T>);
    static hdf5::Handle type(std::size_t) { return number<T>(); }
    static hdf5::Shape shape(std::size_t) { return {}; }
    static std::size_t bytes(std::size_t) { return sizeof(T); }
    static void pack(const T& value, std::size_t, std::byte* row) { std::memcpy(row, &value, sizeof(T)); }
    static void unpack(const std::byte* row, std::size_t, T& value) { std::memcpy(&value, row, sizeof(T)); }
};

template <class T, std::size_t N>
struct Cell<std::array<T, N>> {
    static hdf5::Handle type(std::size_t width) { return Cell<T>::type(width); }
    static hdf5::Shape shape(std::size_t width) {
        hdf5::Shape shape = Cell<T>::shape(width);
        shape.insert(shape.begin(), N);
        return shape;
    }
    static std::size_t bytes(std::size_t width) { return N * Cell<T>::bytes(width); }
    static void pack(const std::array<T, N>& value, std::size_t width, std::byte* row) {
        for (std::size_t i = 0; i < N; ++i) {
            Cell<T>::pack(value[i], width, row + i * Cell<T>::bytes(width));
        }
    }
    static void unpack(const std::byte* row, std::size_t width, std::array<T, N>& value) {
        for (std::size_t i = 0; i < N; ++i) {
            Cell<T>::unpack(row + i * Cell<T>::bytes(width), width, value[i]);
        }
    }
};

/// Measured values: floating-point numbers and arrays of them. Older files may lack some.
template <class T>
inline constexpr bool is_measure = std::is_floating_point_v<T>;
template <class T, std::size_t N>
inline constexpr bool is_measure<std::array<T, N>> = is_measure<T>;

/// 0 or 1 in one byte.
template <>
struct Cell<bool> {
    static hdf5::Handle type(std::size_t) { return number<std::uint8_t>(); }
    static hdf5::Shape shape(std::size_t) { return {}; }
    static std::size_t bytes(std::size_t) { return 1; }
    static void pack(const bool& value, std::size_t, std::byte* row) { *row = std::byte{value}; }
    static void unpack(const std::byte* row, std::size_t, bool& value) { value = *row != std::byte{0}; }
};

template <>
struct Cell<Vec3f> {
    static hdf5::Handle type(std::size_t) { return number<float>(); }
    static hdf5::Shape shape(std::size_t) { return {3}; }
    static std::size_t bytes(std::size_t) { return 3 * sizeof(float); }
    static void pack(const Vec3f& value, std::size_t, std::byte* row) {
        std::memcpy(row, value.data(), bytes(0));
    }
    static void unpack(const std::byte* row, std::size_t, Vec3f& value) {
        std::memcpy(value.data(), row, bytes(0));
    }
};

/// w x y z.
template <>
struct Cell<Quatf> {
    static hdf5::Handle type(std::size_t) { return number<float>(); }
    static hdf5::Shape shape(std::size_t) { return {4}; }
    static std::size_t bytes(std::size_t) { return 4 * sizeof(float); }
    static void pack(const Quatf& value, std::size_t, std::byte* row) {
        const float numbers[4] = {value.w(), value.x(), value.y(), value.z()};
        std::memcpy(row, numbers, sizeof(numbers));
    }
    static void unpack(const std::byte* row, std::size_t, Quatf& value) {
        float numbers[4];
        std::memcpy(numbers, row, sizeof(numbers));
        value = Quatf(numbers[0], numbers[1], numbers[2], numbers[3]);
    }
};

/// Position x y z, then quaternion w x y z.
template <>
struct Cell<RigidTransform> {
    static hdf5::Handle type(std::size_t) { return number<float>(); }
    static hdf5::Shape shape(std::size_t) { return {7}; }
    static std::size_t bytes(std::size_t) { return 7 * sizeof(float); }
    static void pack(const RigidTransform& value, std::size_t, std::byte* row) {
        Cell<Vec3f>::pack(value.translation, 0, row);
        Cell<Quatf>::pack(value.rotation, 0, row + Cell<Vec3f>::bytes(0));
    }
    static void unpack(const std::byte* row, std::size_t, RigidTransform& value) {
        Cell<Vec3f>::unpack(row, 0, value.translation);
        Cell<Quatf>::unpack(row + Cell<Vec3f>::bytes(0), 0, value.rotation);
    }
};

/// `width` points; a shorter line is padded with NaN, a longer one truncated.
template <>
struct Cell<std::vector<Vec3f>> {
    static hdf5::Handle type(std::size_t) { return number<float>(); }
    static hdf5::Shape shape(std::size_t width) { return {width, 3}; }
    static std::size_t bytes(std::size_t width) { return width * Cell<Vec3f>::bytes(0); }
    static void pack(const std::vector<Vec3f>& value, std::size_t width, std::byte* row);
    static void unpack(const std::byte* row, std::size_t width, std::vector<Vec3f>& value);
};

/// At most `width` bytes of UTF-8, null-padded; a longer text is truncated between two characters.
template <>
struct Cell<std::string> {
    static hdf5::Handle type(std::size_t width) { return hdf5::fixed_text_type(width); }
    static hdf5::Shape shape(std::size_t) { return {}; }
    static std::size_t bytes(std::size_t width) { return width; }
    static void pack(const std::string& value, std::size_t width, std::byte* row);
    static void unpack(const std::byte* row, std::size_t width, std::string& value);
};

}  // namespace eti::session
