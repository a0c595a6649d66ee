// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <stdexcept>

namespace eti::devices {

/// A device that does not exist, cannot be opened or was lost; the text states the remedy.
class DeviceError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

}  // namespace eti::devices
