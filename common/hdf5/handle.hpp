// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <hdf5.h>

#include <cstdint>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>

namespace eti::hdf5 {

/// An error of a file; the text names the file, the location inside it and the problem.
class Error : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// Owner of one HDF5 identifier.
class Handle {
  public:
    using Closer = herr_t (*)(hid_t);

    Handle() = default;
    Handle(hid_t id, Closer closer) : id_(id), closer_(closer) {}
    Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), closer_(other.closer_) {}
    Handle& operator=(Handle&& other) noexcept {
        if (this != &other) {
            close();
            id_ = std::exchange(other.id_, -1);
            closer_ = other.closer_;
        }
        return *this;
    }
    Handle(const Handle&) = delete;
    Handle& operator=(const Handle&) = delete;
    ~Handle() { close(); }

    [[nodiscard]] hid_t get() const { return id_; }
    explicit operator bool() const { return id_ >= 0; }

    /// False if the library cannot close it (unwritten data on a full disk).
    bool close() {
        const hid_t id = std::exchange(id_, -1);
        return id < 0 || closer_(id) >= 0;
    }

    /// Releases the identifier without closing it.
    void abandon() { id_ = -1; }

  private:
    hid_t id_ = -1;
    Closer closer_ = nullptr;
};

/// Call first on every thread that uses HDF5. The library then returns errors instead of printing them and
/// skips open files at exit. Otherwise a file that cannot be written (full disk) would delay the exit with a
/// page of the library's messages.
void prepare_thread();

/// The innermost message of this thread's last failure, e.g. "file signature not found".
[[nodiscard]] std::string last_error();

/// The native HDF5 type of a number.
template <class T>
[[nodiscard]] hid_t number_type() {
    static_assert(std::is_arithmetic_v<T>);
    if constexpr (std::is_same_v<T, float>) {
        return H5T_NATIVE_FLOAT;
    } else if constexpr (std::is_same_v<T, double>) {
        return H5T_NATIVE_DOUBLE;
    } else if constexpr (std::is_same_v<T, std::uint8_t>) {
        return H5T_NATIVE_UINT8;
    } else if constexpr (std::is_same_v<T, std::uint16_t>) {
        return H5T_NATIVE_UINT16;
    } else if constexpr (std::is_same_v<T, std::uint32_t>) {
        return H5T_NATIVE_UINT32;
    } else if constexpr (std::is_same_v<T, std::uint64_t>) {
        return H5T_NATIVE_UINT64;
    } else {
        static_assert(std::is_same_v<T, std::int32_t>, "add the type here");
        return H5T_NATIVE_INT32;
    }
}

}  // namespace eti::hdf5
