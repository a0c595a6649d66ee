// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "volume.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    eti::fuzz::read_volume([](std::span<const std::uint8_t> bytes,
                              const std::string& file) { return eti::imaging::parse_nifti(bytes, file); },
                           data, size);
    return 0;
}
