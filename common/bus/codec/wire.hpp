// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <algorithm>
#include <concepts>
#include <exception>
#include <mutex>
#include <type_traits>

#include "common/bus/codec/payload.hpp"
#include "common/bus/fastdds/portable_type.hpp"
#include "common/bus/topics.hpp"

namespace eti::bus {

/// True when every sequence keeps its bound in eti.idl and every enumerator is valid, in a message or any
/// part of it. The generated code checks neither.
template <class Part>
[[nodiscard]] bool within_bounds(const Part& part) {
    bool within = true;
    if constexpr (requires { msg::for_members(part, [](const char*, const auto&, std::size_t) {}); }) {
        msg::for_members(part, [&](const char*, const auto& member, std::size_t bound) {
            using Member = std::remove_cvref_t<decltype(member)>;
            if constexpr (std::is_enum_v<Member>) {
                within = within && static_cast<std::size_t>(member) < bound;
            } else if constexpr (requires(Member m) { m.emplace_back(); }) {
                within = within && member.size() <= bound;
                if constexpr (std::is_class_v<typename Member::value_type>) {
                    within =
                        within && std::ranges::all_of(member, [](const auto& e) { return within_bounds(e); });
                }
            } else {
                within = within && within_bounds(member);
            }
        });
    }
    return within;
}

/// The generated type, hardened against untrusted input: deserialising any sample neither throws nor
/// allocates more than a constant times its own size.
template <class Generated>
class WireType : public PortableType<Generated> {
  public:
    using Base = PortableType<Generated>;
    using Message = typename Base::Message;

    bool write(const void* data, rtps::SerializedPayload_t& payload) override {
        try {
            return Base::write(data, payload);
        } catch (const std::exception&) {
            return false;
        }
    }

    bool read(rtps::SerializedPayload_t& payload, void* data) override {
        try {
            Payload walked(payload.data, payload.length);
            return whole(walked, static_cast<const Message*>(nullptr)) && Base::read(payload, data);
        } catch (const std::exception&) {
            return false;
        }
    }

    /// The generated code computes keys in a buffer shared by all readers and writers of the participant, on
    /// all their threads.
    bool key_of(const void* data, rtps::InstanceHandle_t& handle, bool force_md5) override {
        const std::lock_guard lock(key_mutex_);
        return Base::key_of(data, handle, force_md5);
    }

  private:
    std::mutex key_mutex_;
};

}  // namespace eti::bus
