// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <exception>
#include <mutex>
#include <type_traits>

#include "common/bus/topics.hpp"
#include "idl/etiPubSubTypes.h"

namespace eti::bus {

using eprosima::fastrtps::rtps::SerializedPayload_t;

/// True when every bounded sequence keeps the bound that eti.idl gives it and every enumerator is one
/// of its type. The generated code checks neither, on writing or on reading.
[[nodiscard]] bool within_bounds(const msg::SceneDescription& message);
[[nodiscard]] bool within_bounds(const msg::DeformationState& message);
[[nodiscard]] bool within_bounds(const msg::FluidState& message);
[[nodiscard]] bool within_bounds(const msg::ProxyState& message);
[[nodiscard]] bool within_bounds(const msg::TissueContacts& message);
[[nodiscard]] bool within_bounds(const msg::LiveMetrics& message);
[[nodiscard]] bool within_bounds(const msg::AttemptSummary& message);
[[nodiscard]] bool within_bounds(const msg::SessionStatus& message);
[[nodiscard]] inline bool within_bounds(const msg::ToolPose&) {
    return true;
}
[[nodiscard]] inline bool within_bounds(const msg::TubeForce&) {
    return true;
}
[[nodiscard]] inline bool within_bounds(const msg::EyePose&) {
    return true;
}
[[nodiscard]] inline bool within_bounds(const msg::Command&) {
    return true;
}
[[nodiscard]] inline bool within_bounds(const msg::CommandResult&) {
    return true;
}

/// False when a scene description's payload announces more names than it has bytes for. The generated
/// code checks sequences of numbers, but allocates sequences of strings as announced, up to 128 GB.
[[nodiscard]] bool plausible_size(const SerializedPayload_t& payload);

/// The generated type, made safe against what anybody may send: whatever a sample holds, reading it
/// neither throws nor allocates beyond its own size times a constant.
template <class Generated>
class WireType : public Generated {
  public:
    using Message = typename Generated::type;

    bool serialize(void* data, SerializedPayload_t* payload) override {
        try {
            return Generated::serialize(data, payload);
        } catch (const std::exception&) {
            return false;
        }
    }

    bool deserialize(SerializedPayload_t* payload, void* data) override {
        try {
            if constexpr (std::is_same_v<Message, msg::SceneDescription>) {
                if (!plausible_size(*payload)) {
                    return false;
                }
            }
            return Generated::deserialize(payload, data) && within_bounds(*static_cast<const Message*>(data));
        } catch (const std::exception&) {
            return false;
        }
    }

    /// The generated code computes keys in a buffer that all readers and writers of the participant
    /// share, on whatever threads they run.
    bool getKey(void* data, eprosima::fastrtps::rtps::InstanceHandle_t* handle, bool force_md5) override {
        const std::lock_guard lock(key_mutex_);
        return Generated::getKey(data, handle, force_md5);
    }

  private:
    std::mutex key_mutex_;
};

}  // namespace eti::bus
