// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

// Fast DDS 2.9 to 2.14 and Fast DDS 3 under the same names. This folder alone knows the version (ETI_FASTDDS,
// set by cmake/fastdds.cmake); names that agree in both are used as the library has them.

#if ETI_FASTDDS >= 3
#include <fastdds/dds/core/ReturnCode.hpp>
#include <fastdds/dds/core/Time_t.hpp>
#include <fastdds/rtps/attributes/ReaderAttributes.hpp>
#include <fastdds/rtps/attributes/WriterAttributes.hpp>
#include <fastdds/rtps/common/Guid.hpp>
#include <fastdds/rtps/common/InstanceHandle.hpp>
#include <fastdds/rtps/common/Locator.hpp>
#include <fastdds/rtps/common/SerializedPayload.hpp>
#include <fastdds/rtps/transport/TransportDescriptorInterface.hpp>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.hpp>
#include <fastdds/rtps/transport/UDPv6TransportDescriptor.hpp>
#include <fastdds/rtps/transport/shared_mem/SharedMemTransportDescriptor.hpp>
#include <fastdds/utils/IPLocator.hpp>
#else
#include <fastdds/rtps/attributes/ReaderAttributes.h>
#include <fastdds/rtps/attributes/WriterAttributes.h>
#include <fastdds/rtps/common/Guid.h>
#include <fastdds/rtps/common/InstanceHandle.h>
#include <fastdds/rtps/common/Locator.h>
#include <fastdds/rtps/common/SerializedPayload.h>
#include <fastdds/rtps/common/Time_t.h>
#include <fastdds/rtps/transport/TransportDescriptorInterface.h>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastdds/rtps/transport/UDPv6TransportDescriptor.h>
#include <fastdds/rtps/transport/shared_mem/SharedMemTransportDescriptor.h>
#include <fastrtps/types/TypesBase.h>
#include <fastrtps/utils/IPLocator.h>
#endif
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>

namespace eti::bus {

namespace dds = eprosima::fastdds::dds;
namespace transport = eprosima::fastdds::rtps;

#if ETI_FASTDDS >= 3
namespace rtps = eprosima::fastdds::rtps;
using Duration = dds::Duration_t;
using ReturnCode = dds::ReturnCode_t;
#else
namespace rtps = eprosima::fastrtps::rtps;
using Duration = eprosima::fastrtps::Duration_t;
using ReturnCode = eprosima::fastrtps::types::ReturnCode_t;
#endif

[[nodiscard]] inline bool succeeded(const ReturnCode& code) {
#if ETI_FASTDDS >= 3
    return code == dds::RETCODE_OK;
#else
    return code == ReturnCode::RETCODE_OK;
#endif
}

/// Whether `writer` took the sample. Version 3 returns a code, whose success is 0; version 2 returns true.
[[nodiscard]] inline bool write_sample(dds::DataWriter& writer, const void* sample) {
#if ETI_FASTDDS >= 3
    return writer.write(sample) == dds::RETCODE_OK;
#else
    return writer.write(const_cast<void*>(sample));
#endif
}

[[nodiscard]] inline bool is_keyed(const dds::TopicDataType& type) {
#if ETI_FASTDDS >= 3
    return type.is_compute_key_provided;
#else
    return type.m_isGetKeyDefined;
#endif
}

/// Heartbeats of a reliable writer, and its delay before it repeats a lost sample.
inline void set_repair(rtps::WriterTimes& times, const Duration& heartbeat, const Duration& delay) {
#if ETI_FASTDDS >= 3
    times.heartbeat_period = heartbeat;
    times.nack_response_delay = delay;
#else
    times.heartbeatPeriod = heartbeat;
    times.nackResponseDelay = delay;
#endif
}

/// Delay before a reliable reader asks for a lost sample.
inline void set_repair(rtps::ReaderTimes& times, const Duration& delay) {
#if ETI_FASTDDS >= 3
    times.heartbeat_response_delay = delay;
#else
    times.heartbeatResponseDelay = delay;
#endif
}

}  // namespace eti::bus
