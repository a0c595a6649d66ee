// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
//
// A sample as received from the bus: the first byte chooses its type, the others are its payload.
#include <algorithm>
#include <iterator>

#include "common/bus/codec/wire.hpp"
#include "reader.hpp"

namespace eti::bus {
namespace {

template <class Generated>
void read(const std::uint8_t* data, std::size_t size) {
    WireType<Generated> type;
    typename WireType<Generated>::Message message;
    rtps::SerializedPayload_t payload(static_cast<std::uint32_t>(size));
    std::copy_n(data, size, payload.data);
    payload.length = static_cast<std::uint32_t>(size);
    if (!type.read(payload, &message)) {
        return;
    }
    fuzz::require(within_bounds(message), "a message beyond the bounds of eti.idl was taken");
    rtps::SerializedPayload_t again(type.size_of(&message));
    fuzz::require(type.write(&message, again), "a message that was taken cannot be written");
    fuzz::require(type.read(again, &message), "a message that was written is not taken");
}

constexpr void (*readers[])(const std::uint8_t*, std::size_t) = {
#define ETI_READ(name) &read<msg::name##PubSubType>,
    ETI_MESSAGES(ETI_READ)
#undef ETI_READ
};

}  // namespace
}  // namespace eti::bus

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size > 0) {
        eti::bus::readers[data[0] % std::size(eti::bus::readers)](data + 1, size - 1);
    }
    return 0;
}
