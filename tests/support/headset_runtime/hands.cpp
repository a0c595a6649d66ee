// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "tests/support/headset_runtime/hands.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "tests/support/headset_runtime/state.hpp"

namespace eti::headset_runtime {
namespace {

// Of several bound inputs, the one with the largest magnitude counts (OpenXR 1.0, 11.4).
std::array<float, 2> value_of(const XrActionStateGetInfo* info, XrActionType type, bool& active) {
    const Action& action = state.actions.at(number(info->action));
    if (action.type != type) {
        simulation().fault("an action was asked for what it is not");
    }
    active = false;
    std::array<float, 2> out{};
    for (const std::string& input : action.inputs) {
        // Restricted to one hand if the application passes a subaction path.
        if (!input.starts_with(state.paths.at(info->subactionPath))) {
            continue;
        }
        active = state.synchronised;
        const auto one = simulation().script().input_at(input, simulation().frame());
        if (active && std::hypot(one[0], one[1]) > std::hypot(out[0], out[1])) {
            out = one;
        }
    }
    return out;
}

}  // namespace

XrResult XRAPI_CALL string_to_path(XrInstance, const char* text, XrPath* out) {
    for (std::size_t i = 1; i < state.paths.size(); ++i) {
        if (state.paths[i] == text) {
            *out = i;
            return XR_SUCCESS;
        }
    }
    state.paths.emplace_back(text);
    *out = state.paths.size() - 1;
    return XR_SUCCESS;
}

XrResult XRAPI_CALL path_to_string(XrInstance, XrPath path, std::uint32_t capacity, std::uint32_t* count,
                                   char* out) {
    const std::string& text = state.paths.at(path);
    return fill(std::vector<char>(text.c_str(), text.c_str() + text.size() + 1), capacity, count, out);
}

XrResult XRAPI_CALL create_action_set(XrInstance, const XrActionSetCreateInfo*, XrActionSet* out) {
    ETI_UNLESS_LOST();
    *out = new_handle<XrActionSet>();
    return XR_SUCCESS;
}
XrResult XRAPI_CALL destroy_action_set(XrActionSet) {
    state.actions.clear();
    return XR_SUCCESS;
}

XrResult XRAPI_CALL create_action(XrActionSet, const XrActionCreateInfo* info, XrAction* out) {
    *out = new_handle<XrAction>();
    state.actions[number(*out)] = {info->actionType, {}};
    return XR_SUCCESS;
}
XrResult XRAPI_CALL destroy_action(XrAction action) {
    state.actions.erase(number(action));
    return XR_SUCCESS;
}

XrResult XRAPI_CALL suggest(XrInstance, const XrInteractionProfileSuggestedBinding* bindings) {
    if (state.attached) {
        simulation().fault("bindings were suggested after the session began to use them");
        return XR_ERROR_ACTIONSETS_ALREADY_ATTACHED;
    }
    const std::string profile = state.paths.at(bindings->interactionProfile);
    auto& profiles = simulation().report_json()["profiles"];
    if (std::find(profiles.begin(), profiles.end(), profile) == profiles.end()) {
        profiles.push_back(profile);
    }
    for (std::uint32_t i = 0;
         profile == simulation().script().controller && i < bindings->countSuggestedBindings; ++i) {
        const auto& [action, path] = bindings->suggestedBindings[i];
        state.actions.at(number(action)).inputs.push_back(state.paths.at(path));
    }
    return XR_SUCCESS;
}

XrResult XRAPI_CALL attach(XrSession, const XrSessionActionSetsAttachInfo*) {
    state.attached = true;
    return XR_SUCCESS;
}

XrResult XRAPI_CALL synchronise(XrSession, const XrActionsSyncInfo*) {
    ETI_UNLESS_LOST();
    state.synchronised = simulation().focused();
    return state.synchronised ? XR_SUCCESS : XR_SESSION_NOT_FOCUSED;
}

XrResult XRAPI_CALL create_action_space(XrSession, const XrActionSpaceCreateInfo* info, XrSpace* out) {
    ETI_UNLESS_LOST();
    if (state.actions.at(number(info->action)).type != XR_ACTION_TYPE_POSE_INPUT) {
        simulation().fault("a space was asked for of an action that is no pose");
        return XR_ERROR_ACTION_TYPE_MISMATCH;
    }
    *out = new_handle<XrSpace>();
    state.action_spaces[number(*out)] = {number(info->action), state.paths.at(info->subactionPath)};
    return XR_SUCCESS;
}

XrResult XRAPI_CALL locate_space(XrSpace space, XrSpace, XrTime when, XrSpaceLocation* out) {
    ETI_UNLESS_LOST();
    if (when != simulation().seen_at()) {
        simulation().fault("a hand was asked for at another time than the frame is seen");
    }
    const ActionSpace& asked = state.action_spaces.at(number(space));
    const Action& action = state.actions.at(asked.action);
    const bool bound = std::ranges::any_of(
        action.inputs, [&](const std::string& input) { return input.starts_with(asked.hand); });
    const auto aim = simulation().aim(asked.hand);
    out->locationFlags = 0;
    out->pose = {{0.0f, 0.0f, 0.0f, 1.0f}, {0.0f, 0.0f, 0.0f}};
    if (state.synchronised && bound && aim) {
        out->locationFlags = XR_SPACE_LOCATION_POSITION_VALID_BIT | XR_SPACE_LOCATION_ORIENTATION_VALID_BIT |
                             XR_SPACE_LOCATION_POSITION_TRACKED_BIT |
                             XR_SPACE_LOCATION_ORIENTATION_TRACKED_BIT;
        const Quatf& turn = aim->rotation;
        const Vec3f& place = aim->translation;
        out->pose = {{turn.x(), turn.y(), turn.z(), turn.w()}, {place.x(), place.y(), place.z()}};
    }
    return XR_SUCCESS;
}

XrResult XRAPI_CALL get_float(XrSession, const XrActionStateGetInfo* info, XrActionStateFloat* out) {
    bool active = false;
    out->currentState = value_of(info, XR_ACTION_TYPE_FLOAT_INPUT, active)[0];
    out->changedSinceLastSync = XR_FALSE;
    out->lastChangeTime = simulation().seen_at();
    out->isActive = active;
    return XR_SUCCESS;
}
XrResult XRAPI_CALL get_boolean(XrSession, const XrActionStateGetInfo* info, XrActionStateBoolean* out) {
    bool active = false;
    out->currentState = value_of(info, XR_ACTION_TYPE_BOOLEAN_INPUT, active)[0] > 0.5f;
    out->changedSinceLastSync = XR_FALSE;
    out->lastChangeTime = simulation().seen_at();
    out->isActive = active;
    return XR_SUCCESS;
}
XrResult XRAPI_CALL get_vector(XrSession, const XrActionStateGetInfo* info, XrActionStateVector2f* out) {
    bool active = false;
    const auto value = value_of(info, XR_ACTION_TYPE_VECTOR2F_INPUT, active);
    out->currentState = {value[0], value[1]};
    out->changedSinceLastSync = XR_FALSE;
    out->lastChangeTime = simulation().seen_at();
    out->isActive = active;
    return XR_SUCCESS;
}

}  // namespace eti::headset_runtime
