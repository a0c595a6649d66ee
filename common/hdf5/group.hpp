// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/hdf5/handle.hpp"

namespace eti::hdf5 {

/// Extents of a data set, slowest first.
using Shape = std::vector<std::size_t>;

/// An extent that the reader of a data set leaves open.
inline constexpr std::size_t any_extent = static_cast<std::size_t>(-1);

/// Unit and description that every data set carries. Dimensionless data sets have the unit "1".
struct Label {
    std::string_view units;
    std::string_view description;
};

template <class T>
struct Array {
    Shape shape;
    std::vector<T> values;  ///< last extent fastest
};

/// A group of a file. Every function throws Error, which names the file, the path and the problem.
class Group {
  public:
    Group() = default;
    /// `place`: file and path, as messages show them ("run.eti.h5: /scene").
    Group(Handle id, std::string place) : id_(std::move(id)), place_(std::move(place)) {}

    [[nodiscard]] hid_t id() const { return id_.get(); }
    [[nodiscard]] const std::string& place() const { return place_; }

    [[nodiscard]] Group create(const std::string& name) const;
    [[nodiscard]] Group open(const std::string& name) const;
    [[nodiscard]] bool has(const std::string& name) const;
    /// Names of the members, sorted.
    [[nodiscard]] std::vector<std::string> members() const;
    [[nodiscard]] bool is_group(const std::string& name) const;

    /// Writes a whole data set: chunked, shuffled and deflated.
    template <class T>
    void write(const std::string& name, std::span<const T> values, const Shape& shape,
               const Label& label) const {
        write_raw(name, number_type<T>(), values.data(), values.size(), shape, label);
    }
    /// Writes a list of texts as one data set of fixed-length UTF-8 strings.
    void write_texts(const std::string& name, const std::vector<std::string>& texts,
                     const Label& label) const;

    /// Reads a whole data set of numbers; `expected` gives its rank and, where not any_extent, its extents.
    template <class T>
    [[nodiscard]] Array<T> read(const std::string& name, const Shape& expected) const {
        Array<T> array;
        const Opened opened = open_numbers(name, std::is_floating_point_v<T>, sizeof(T), expected);
        array.shape = opened.shape;
        array.values.resize(opened.count);
        read_raw(name, opened, number_type<T>(), array.values.data());
        return array;
    }
    [[nodiscard]] std::vector<std::string> read_texts(const std::string& name) const;

    void set_text(const std::string& attribute, std::string_view value) const;
    void set_number(const std::string& attribute, double value) const;
    void set_integer(const std::string& attribute, std::uint64_t value) const;
    /// Changes an existing integer attribute in place; false on failure.
    [[nodiscard]] bool change_integer(const std::string& attribute, std::uint64_t value) const;
    [[nodiscard]] std::string text(const std::string& attribute) const;
    [[nodiscard]] double number(const std::string& attribute) const;
    [[nodiscard]] std::uint64_t integer(const std::string& attribute) const;
    [[nodiscard]] std::vector<std::string> attributes() const;

    /// Location of a member of this group, for error texts.
    [[nodiscard]] std::string at(const std::string& name) const;

  private:
    struct Opened {
        Handle data_set;
        Shape shape;
        std::size_t count = 0;
    };
    void write_raw(const std::string& name, hid_t type, const void* values, std::size_t count,
                   const Shape& shape, const Label& label) const;
    [[nodiscard]] Opened open_numbers(const std::string& name, bool floating, std::size_t size,
                                      const Shape& expected) const;
    void read_raw(const std::string& name, const Opened& opened, hid_t type, void* values) const;

    Handle id_;
    std::string place_;
};

/// Sets the attributes `units` and `description` of a data set; false on failure.
[[nodiscard]] bool set_label(hid_t data_set, const Label& label);

/// Fixed-length, null-padded UTF-8.
[[nodiscard]] Handle fixed_text_type(std::size_t size);

/// Upper limit [bytes] on one read, far above any data set of this project. A larger claim means a damaged
/// file; it is rejected before memory is allocated.
inline constexpr std::size_t max_read_bytes = std::size_t{4} << 30;

}  // namespace eti::hdf5
