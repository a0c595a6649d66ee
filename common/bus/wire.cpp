// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/bus/wire.hpp"

#include <fastcdr/Cdr.h>

#include <cstdint>
#include <string>

namespace eti::bus {

// The bounds stand in eti.idl; the generator does not export them.
bool within_bounds(const msg::SceneDescription& message) {
    return message.kind() <= msg::OBJECT_LANDMARKS;
}
bool within_bounds(const msg::DeformationState& message) {
    return message.frames().size() <= 48 && message.tube_nodes().size() <= 40;
}
bool within_bounds(const msg::FluidState& message) {
    return message.places().size() <= 576;
}
bool within_bounds(const msg::ProxyState& message) {
    return message.contacts().size() <= 16;
}
bool within_bounds(const msg::TissueContacts& message) {
    return message.contacts().size() <= 96;
}
bool within_bounds(const msg::LiveMetrics& message) {
    return message.live().size() <= 64 && message.landmarks().size() <= 32 &&
           message.parameters().size() <= msg::PARAMETER_COUNT;
}
bool within_bounds(const msg::AttemptSummary& message) {
    return message.parameters().size() <= msg::PARAMETER_COUNT;
}
bool within_bounds(const msg::SessionStatus& message) {
    return message.phase() <= msg::PHASE_FINISHED;
}

bool plausible_size(const SerializedPayload_t& payload) {
    eprosima::fastcdr::FastBuffer buffer(reinterpret_cast<char*>(payload.data), payload.length);
    eprosima::fastcdr::Cdr reader(buffer, eprosima::fastcdr::Cdr::DEFAULT_ENDIAN,
                                  eprosima::fastcdr::Cdr::DDS_CDR);
    reader.read_encapsulation();
    std::string object;
    msg::Header header;
    std::uint32_t number = 0;
    reader >> object >> header >> number >> number >> number;
    // vertices, triangles, triangle_tissue, skin_frame, skin_weight; each followed by a word, hence
    // padded to four bytes, which jump() leaves to its caller.
    for (const std::size_t size : {4, 4, 1, 2, 1}) {
        reader >> number;
        if (!reader.jump((number * size + 3) / 4 * 4)) {
            return false;
        }
    }
    reader >> number;
    const std::size_t left = payload.length - reader.getSerializedDataLength();
    return number <= left / 4;  // a string's length alone takes four bytes
}

}  // namespace eti::bus
