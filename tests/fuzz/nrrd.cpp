// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "volume.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    eti::fuzz::read_volume(&eti::imaging::parse_nrrd, data, size);
    return 0;
}
