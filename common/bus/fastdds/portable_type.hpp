// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <functional>

#include "common/bus/fastdds/names.hpp"
#if ETI_FASTDDS >= 3
#include "idl/etiPubSubTypes.hpp"
#else
#include "idl/etiPubSubTypes.h"
#endif

namespace eti::bus {

/// A generated type whose functions a derived class overrides under the same names for every version of the
/// library. By default each does what the generator wrote. Samples are encoded as XCDR version 1.
template <class Generated>
class PortableType : public Generated {
  public:
    using Message = typename Generated::type;

    /// Whether `data` was written into `payload`, which has room for size_of() bytes.
    virtual bool write(const void* data, rtps::SerializedPayload_t& payload) {
        return generated_write(data, payload);
    }
    virtual bool read(rtps::SerializedPayload_t& payload, void* data) {
        return generated_read(payload, data);
    }
    [[nodiscard]] virtual std::uint32_t size_of(const void* data) { return generated_size_of(data); }
    virtual bool key_of(const void* data, rtps::InstanceHandle_t& handle, bool force_md5) {
        return generated_key_of(data, handle, force_md5);
    }

#if ETI_FASTDDS >= 3
    bool serialize(const void* const data, rtps::SerializedPayload_t& payload,
                   dds::DataRepresentationId_t /*only XCDR 1*/) final {
        return write(data, payload);
    }
    bool deserialize(rtps::SerializedPayload_t& payload, void* data) final {
        return read(payload, data);
    }
    std::uint32_t calculate_serialized_size(const void* const data, dds::DataRepresentationId_t) final {
        return size_of(data);
    }
    bool compute_key(const void* const data, rtps::InstanceHandle_t& handle, bool force_md5) final {
        return key_of(data, handle, force_md5);
    }
    bool compute_key(rtps::SerializedPayload_t& payload, rtps::InstanceHandle_t& handle,
                     bool force_md5) final {
        Message message;
        return read(payload, &message) && key_of(&message, handle, force_md5);
    }

  private:
    static constexpr auto xcdr1 = dds::DataRepresentationId_t::XCDR_DATA_REPRESENTATION;

    bool generated_write(const void* data, rtps::SerializedPayload_t& payload) {
        return Generated::serialize(data, payload, xcdr1);
    }
    bool generated_read(rtps::SerializedPayload_t& payload, void* data) {
        return Generated::deserialize(payload, data);
    }
    std::uint32_t generated_size_of(const void* data) {
        return Generated::calculate_serialized_size(data, xcdr1);
    }
    bool generated_key_of(const void* data, rtps::InstanceHandle_t& handle, bool force_md5) {
        return Generated::compute_key(data, handle, force_md5);
    }
#else
    bool serialize(void* data, rtps::SerializedPayload_t* payload) final {
        return write(data, *payload);
    }
    bool deserialize(rtps::SerializedPayload_t* payload, void* data) final {
        return read(*payload, data);
    }
    std::function<std::uint32_t()> getSerializedSizeProvider(void* data) final {
        return [this, data] { return size_of(data); };
    }
    bool getKey(void* data, rtps::InstanceHandle_t* handle, bool force_md5) final {
        return key_of(data, *handle, force_md5);
    }

  private:
    bool generated_write(const void* data, rtps::SerializedPayload_t& payload) {
        return Generated::serialize(const_cast<void*>(data), &payload);
    }
    bool generated_read(rtps::SerializedPayload_t& payload, void* data) {
        return Generated::deserialize(&payload, data);
    }
    std::uint32_t generated_size_of(const void* data) {
        return Generated::getSerializedSizeProvider(const_cast<void*>(data))();
    }
    bool generated_key_of(const void* data, rtps::InstanceHandle_t& handle, bool force_md5) {
        return Generated::getKey(const_cast<void*>(data), &handle, force_md5);
    }
#endif
};

}  // namespace eti::bus
