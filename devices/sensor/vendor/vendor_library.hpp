// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <initializer_list>
#include <string>

#include "common/math/transform.hpp"

namespace eti::devices {

/// A vendor's library, loaded at run time: building needs no vendor files.
class VendorLibrary {
  public:
    /// Loads `chosen` or, if that is empty, the first of `names` that is found. Throws DeviceError with the
    /// loader's message and `remedy`.
    VendorLibrary(const std::string& chosen, std::initializer_list<const char*> names, std::string remedy);
    ~VendorLibrary();
    VendorLibrary(const VendorLibrary&) = delete;
    VendorLibrary& operator=(const VendorLibrary&) = delete;

    /// Sets `function` to the entry point `name`. Throws DeviceError if there is none.
    template <class Function>
    void bind(Function*& function, const char* name) const {
        function = reinterpret_cast<Function*>(entry(name));
    }

  private:
    [[nodiscard]] void* entry(const char* name) const;

    std::string remedy_, loaded_;
    void* handle_ = nullptr;
};

/// Quaternion of a rotation matrix; NaN if the matrix is not a rotation: not finite, not orthonormal, or
/// left-handed. SensorMonitor rejects such a pose.
[[nodiscard]] Quatf rotation_or_nan(const Mat3f& matrix);

}  // namespace eti::devices
