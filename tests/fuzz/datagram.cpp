// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
//
// What the filter before the library lets pass, and whom it asks about.
#include "common/bus/rtps_message.hpp"
#include "reader.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace eti;
    const std::span datagram(data, size);
    std::size_t asked = 0;
    const bool passes = bus::bearable(datagram, [&](const bus::Written&) { return ++asked == 0; });
    fuzz::require(asked <= size / 4, "more writers than the datagram has room for");
    fuzz::require(passes == bus::bearable(datagram), "asking about writers changes what may pass");
    if (asked > 0) {
        fuzz::require(!bus::bearable(datagram, [](const bus::Written&) { return true; }),
                      "a refused writer passes");
    }
    return 0;
}
