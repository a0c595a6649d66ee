// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <initializer_list>
#include <string>

#include "common/math/transform.hpp"

namespace eti::devices {

/// A vendor's library, loaded at run time so that building needs nothing of the vendor's.
class VendorLibrary {
  public:
    /// Loads `chosen`, or where that is empty the first of `names` that is found. Throws DeviceError with
    /// the loader's words and `remedy`.
    VendorLibrary(const std::string& chosen, std::initializer_list<const char*> names, std::string remedy);
    ~VendorLibrary();
    VendorLibrary(const VendorLibrary&) = delete;
    VendorLibrary& operator=(const VendorLibrary&) = delete;

    /// Sets `function` to the entry point `name`. Throws DeviceError where there is none.
    template <class Function>
    void bind(Function*& function, const char* name) const {
        function = reinterpret_cast<Function*>(entry(name));
    }

  private:
    [[nodiscard]] void* entry(const char* name) const;

    std::string remedy_, loaded_;
    void* handle_ = nullptr;
};

/// Quaternion of a rotation matrix; one of NaNs when the matrix is none: not finite, not
/// orthonormal, or left-handed. A SensorWatch refuses such a pose.
[[nodiscard]] Quatf rotation_or_nothing(const Mat3f& matrix);

}  // namespace eti::devices
