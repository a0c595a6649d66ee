// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/scenario/preset.hpp"
#include "common/scenario/data_file.hpp"

#include "reader.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace eti;
    const std::string text = fuzz::text_of(data, size);
    fuzz::read_or_refuse<InputError>("fuzzed.yaml", [&] { (void)parse_preset(text, "fuzzed.yaml"); });
    return 0;
}
