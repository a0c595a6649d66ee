// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string>
#include <type_traits>

#include "common/bus/codec/convert.hpp"
#include "common/bus/topics.hpp"

namespace eti::bus {

/// Sets a part of a message, and every member of it, to distinct values: sequences at their bounds, strings
/// not empty. `next` counts.
template <class Part>
void fill(Part& part, std::size_t bound, int& next) {
    ++next;
    if constexpr (std::is_same_v<Part, bool>) {
        part = true;
    } else if constexpr (std::is_enum_v<Part>) {
        part = static_cast<Part>(bound - 1);
    } else if constexpr (std::is_floating_point_v<Part>) {
        part = static_cast<Part>(next) * Part(0.25);
    } else if constexpr (std::is_integral_v<Part>) {
        part = static_cast<Part>(next);
    } else if constexpr (requires { part.emplace_back(); }) {
        part.resize(bound == msg::no_bound ? 5 : bound);
        for (auto& element : part) {
            fill(element, msg::no_bound, next);
        }
    } else if constexpr (requires { part = std::string(); }) {
        part = "text " + std::to_string(next);
    } else {
        msg::for_members(part, [&](const char*, auto& member, std::size_t of) { fill(member, of, next); });
    }
}

/// One message of each kind with a distinct value in every member.
template <class Message>
Message example() {
    Message out;
    int next = 0;
    fill(out, msg::no_bound, next);
    return out;
}

}  // namespace eti::bus
