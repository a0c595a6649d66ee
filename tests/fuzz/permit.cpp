// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
//
// The permissions document of an identity.
#include <stdexcept>

#include "common/bus/security/permit.hpp"
#include "reader.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace eti;
    const std::string text = fuzz::text_of(data, size);
    fuzz::read_or_refuse<std::runtime_error>("", [&] {
        for (const bus::Permit& permit : bus::read_permits(text)) {
            (void)permit.domain(0);
            (void)permit.partition(0, "session");
            (void)permit.topic(0, "session", "eti/proxy", true);
        }
    });
    return 0;
}
