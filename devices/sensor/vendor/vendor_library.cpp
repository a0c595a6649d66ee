// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/sensor/vendor/vendor_library.hpp"

#include <dlfcn.h>

#include <limits>
#include <utility>

#include "devices/sensor/device_error.hpp"

namespace eti::devices {

VendorLibrary::VendorLibrary(const std::string& chosen, std::initializer_list<const char*> names,
                             std::string remedy)
    : remedy_(std::move(remedy)) {
    std::string said;
    const auto load = [&](const char* name) {
        // Never unloaded: a vendor's thread may still run in it.
        handle_ = ::dlopen(name, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
        if (handle_ == nullptr) {
            const char* why = ::dlerror();
            said += (said.empty() ? "" : "; ") + std::string(why == nullptr ? name : why);
        } else {
            loaded_ = name;
        }
    };
    if (!chosen.empty()) {
        load(chosen.c_str());
    } else {
        for (const char* name : names) {
            if (handle_ == nullptr) {
                load(name);
            }
        }
    }
    if (handle_ == nullptr) {
        throw DeviceError("cannot load the device's library: " + said + ". " + remedy_);
    }
}

VendorLibrary::~VendorLibrary() {
    ::dlclose(handle_);
}

void* VendorLibrary::entry(const char* name) const {
    void* found = ::dlsym(handle_, name);
    if (found == nullptr) {
        throw DeviceError(loaded_ + " has no function " + name + ": it is another library or version. " +
                          remedy_);
    }
    return found;
}

Quatf rotation_or_nan(const Mat3f& matrix) {
    // Written so that NaN fails too. Vendors give about six digits.
    const bool rotation = (matrix * matrix.transpose() - Mat3f::Identity()).cwiseAbs().maxCoeff() < 1e-2f &&
                          matrix.determinant() > 0.0f;
    if (rotation) {
        return Quatf(matrix).normalized();
    }
    constexpr float none = std::numeric_limits<float>::quiet_NaN();
    return {none, none, none, none};
}

}  // namespace eti::devices
