// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
//
// The filter in front of the library: which datagrams it passes, and which participants it asks about.
#include "common/bus/guard/fragment_guard.hpp"
#include "common/bus/guard/rtps_message.hpp"
#include "reader.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace eti;
    const std::span datagram(data, size);
    std::size_t asked = 0;
    bus::FragmentGuard guard;
    const bool passes = bus::is_well_formed(datagram, [&](const bus::WriterSubmessage& written) {
        if (written.fragments) {
            const bus::Bytes payload = written.fragments->payload;
            fuzz::require(payload.data() >= data && payload.data() + payload.size() <= data + size,
                          "fragments outside the datagram");
            (void)guard.plausible(written.writer, *written.fragments, asked % 2 == 0);
        }
        return ++asked == 0;
    });
    fuzz::require(asked <= size / 4, "more writers than the datagram has room for");
    fuzz::require(passes == bus::is_well_formed(datagram), "asking about writers changes what may pass");
    if (asked > 0) {
        fuzz::require(!bus::is_well_formed(datagram, [](const bus::WriterSubmessage&) { return true; }),
                      "a refused writer passes");
    }
    return 0;
}
