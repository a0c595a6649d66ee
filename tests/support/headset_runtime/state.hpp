// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <openxr/openxr.h>

#include <algorithm>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "tests/support/headset_runtime/runtime_swapchain.hpp"
#include "tests/support/headset_runtime/simulated_session.hpp"

namespace eti::headset_runtime {

struct Action {
    XrActionType type;
    std::vector<std::string> inputs;  // of the controller in the script
};

// An action space.
struct ActionSpace {
    std::uint64_t action;
    std::string hand;
};

// One of each at a time; the validation layer checks handles.
struct State {
    std::unique_ptr<SimulatedSession> simulation;
    std::vector<std::string> paths{""};
    std::map<std::uint64_t, std::unique_ptr<RuntimeSwapchain>> chains;
    std::map<std::uint64_t, Action> actions;
    std::map<std::uint64_t, ActionSpace> action_spaces;
    std::uint64_t next_handle = 1;
    XrSession session = XR_NULL_HANDLE;
    void* display = nullptr;  // Xlib's display, for an application with a window
    bool versions_asked = false, attached = false, synchronised = false;
    int asked_for_headset = 0;
};
extern State state;

template <class Handle>
[[nodiscard]] Handle new_handle() {
    return reinterpret_cast<Handle>(state.next_handle++);
}
template <class Handle>
[[nodiscard]] std::uint64_t number(Handle handle) {
    return reinterpret_cast<std::uint64_t>(handle);
}

[[nodiscard]] inline SimulatedSession& simulation() {
    return *state.simulation;
}

// Every call on a lost runtime fails.
#define ETI_UNLESS_LOST()              \
    if (simulation().lost()) {         \
        return XR_ERROR_INSTANCE_LOST; \
    }

template <class Value>
[[nodiscard]] XrResult fill(const std::vector<Value>& values, std::uint32_t capacity, std::uint32_t* count,
                            Value* out) {
    *count = static_cast<std::uint32_t>(values.size());
    if (capacity == 0) {
        return XR_SUCCESS;
    }
    if (capacity < *count) {
        return XR_ERROR_SIZE_INSUFFICIENT;
    }
    std::copy(values.begin(), values.end(), out);
    return XR_SUCCESS;
}

}  // namespace eti::headset_runtime
