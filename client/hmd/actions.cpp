// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/hmd/actions.hpp"

#include <cstring>
#include <vector>

namespace eti::hmd {
namespace {

XrPath path(XrInstance instance, const char* text) {
    XrPath out = XR_NULL_PATH;
    check(xrStringToPath(instance, text, &out), text);
    return out;
}

}  // namespace

Actions::Actions(XrInstance instance, XrSession session) : session_(session) {
    auto info = make_struct<XrActionSetCreateInfo>(XR_TYPE_ACTION_SET_CREATE_INFO);
    std::strncpy(info.actionSetName, "hands", XR_MAX_ACTION_SET_NAME_SIZE - 1);
    std::strncpy(info.localizedActionSetName, "Hands", XR_MAX_LOCALIZED_ACTION_SET_NAME_SIZE - 1);
    check(xrCreateActionSet(instance, &info, set_.put()), "xrCreateActionSet");
    hands_ = {path(instance, "/user/hand/left"), path(instance, "/user/hand/right")};
    trigger_ =
        make(XR_ACTION_TYPE_FLOAT_INPUT, "trigger", "Suction, or a click on the panel", HandScope::each_hand);
    aim_ = make(XR_ACTION_TYPE_POSE_INPUT, "aim", "Point at the panel", HandScope::each_hand);
    head_and_jaw_ =
        make(XR_ACTION_TYPE_VECTOR2F_INPUT, "head_and_jaw", "Head up and down, jaw open and closed");
    head_and_jaw_pressed_ = make(XR_ACTION_TYPE_BOOLEAN_INPUT, "head_and_jaw_pressed", "Move head or jaw");
    table_ = make(XR_ACTION_TYPE_VECTOR2F_INPUT, "table", "Table head-up and head-down");
    table_pressed_ = make(XR_ACTION_TYPE_BOOLEAN_INPUT, "table_pressed", "Tilt the table");
    head_up_ = make(XR_ACTION_TYPE_BOOLEAN_INPUT, "head_up", "Head up");
    head_down_ = make(XR_ACTION_TYPE_BOOLEAN_INPUT, "head_down", "Head down");
    enhanced_ = make(XR_ACTION_TYPE_BOOLEAN_INPUT, "enhanced", "Enhanced view on or off");
    panel_ = make(XR_ACTION_TYPE_BOOLEAN_INPUT, "panel", "Instructor's panel on or off");
    suggest(instance);
    const XrActionSet set = set_.get();
    auto attach = make_struct<XrSessionActionSetsAttachInfo>(XR_TYPE_SESSION_ACTION_SETS_ATTACH_INFO);
    attach.countActionSets = 1;
    attach.actionSets = &set;
    check(xrAttachSessionActionSets(session, &attach), "xrAttachSessionActionSets");
    for (std::size_t hand = 0; hand < hands_.size(); ++hand) {
        auto space = make_struct<XrActionSpaceCreateInfo>(XR_TYPE_ACTION_SPACE_CREATE_INFO);
        space.action = aim_;
        space.subactionPath = hands_[hand];
        space.poseInActionSpace = to_xr(RigidTransform{});
        check(xrCreateActionSpace(session, &space, aims_[hand].put()), "xrCreateActionSpace");
    }
}

XrAction Actions::make(XrActionType type, const char* name, const char* shown, HandScope scope) const {
    auto info = make_struct<XrActionCreateInfo>(XR_TYPE_ACTION_CREATE_INFO);
    info.actionType = type;
    std::strncpy(info.actionName, name, XR_MAX_ACTION_NAME_SIZE - 1);
    std::strncpy(info.localizedActionName, shown, XR_MAX_LOCALIZED_ACTION_NAME_SIZE - 1);
    if (scope == HandScope::each_hand) {
        info.countSubactionPaths = static_cast<std::uint32_t>(hands_.size());
        info.subactionPaths = hands_.data();
    }
    XrAction action = XR_NULL_HANDLE;
    check(xrCreateAction(set_.get(), &info, &action), "xrCreateAction");
    return action;
}

// Suggested bindings; runtimes adapt them to controllers without their own profile.
void Actions::suggest(XrInstance instance) const {
    struct Row {
        XrAction action;
        const char* input;
    };
    struct Profile {
        const char* name;
        std::vector<Row> rows;
    };
    const std::vector<Profile> profiles{{"/interaction_profiles/htc/vive_controller",
                                         {{trigger_, "/user/hand/right/input/trigger/value"},
                                          {trigger_, "/user/hand/left/input/trigger/value"},
                                          {aim_, "/user/hand/right/input/aim/pose"},
                                          {aim_, "/user/hand/left/input/aim/pose"},
                                          {head_and_jaw_, "/user/hand/right/input/trackpad"},
                                          {head_and_jaw_pressed_, "/user/hand/right/input/trackpad/click"},
                                          {table_, "/user/hand/left/input/trackpad"},
                                          {table_pressed_, "/user/hand/left/input/trackpad/click"},
                                          {enhanced_, "/user/hand/right/input/menu/click"},
                                          {panel_, "/user/hand/left/input/menu/click"}}},
                                        // Two buttons per hand: enough for a trainee's most frequent
                                        // actions.
                                        {"/interaction_profiles/khr/simple_controller",
                                         {{trigger_, "/user/hand/right/input/select/click"},
                                          {aim_, "/user/hand/right/input/aim/pose"},
                                          {enhanced_, "/user/hand/right/input/menu/click"},
                                          {head_up_, "/user/hand/left/input/select/click"},
                                          {head_down_, "/user/hand/left/input/menu/click"}}}};
    for (const Profile& profile : profiles) {
        std::vector<XrActionSuggestedBinding> bindings;
        for (const Row& row : profile.rows) {
            bindings.push_back({row.action, path(instance, row.input)});
        }
        auto suggestion =
            make_struct<XrInteractionProfileSuggestedBinding>(XR_TYPE_INTERACTION_PROFILE_SUGGESTED_BINDING);
        suggestion.interactionProfile = path(instance, profile.name);
        suggestion.countSuggestedBindings = static_cast<std::uint32_t>(bindings.size());
        suggestion.suggestedBindings = bindings.data();
        check(xrSuggestInteractionProfileBindings(instance, &suggestion),
              "xrSuggestInteractionProfileBindings");
    }
}

HandInput Actions::read(XrSpace world, XrTime at) const {
    const XrActiveActionSet set{set_.get(), XR_NULL_PATH};
    auto sync = make_struct<XrActionsSyncInfo>(XR_TYPE_ACTIONS_SYNC_INFO);
    sync.countActiveActionSets = 1;
    sync.activeActionSets = &set;
    if (check(xrSyncActions(session_, &sync), "xrSyncActions") == XR_SESSION_NOT_FOCUSED) {
        return {};
    }
    HandInput out;
    for (std::size_t hand = 0; hand < hands_.size(); ++hand) {
        out.hands[hand] = {aim(hand, world, at), trigger(hand)};
    }
    out.head_and_jaw = pad(head_and_jaw_, head_and_jaw_pressed_);
    out.table = pad(table_, table_pressed_);
    out.head_up = pressed(head_up_);
    out.head_down = pressed(head_down_);
    out.enhanced = pressed(enhanced_);
    out.panel = pressed(panel_);
    return out;
}

float Actions::trigger(std::size_t hand) const {
    auto info = make_struct<XrActionStateGetInfo>(XR_TYPE_ACTION_STATE_GET_INFO);
    info.action = trigger_;
    info.subactionPath = hands_[hand];
    auto state = make_struct<XrActionStateFloat>(XR_TYPE_ACTION_STATE_FLOAT);
    check(xrGetActionStateFloat(session_, &info, &state), "xrGetActionStateFloat");
    return state.isActive == XR_TRUE ? state.currentState : 0.0f;
}

std::optional<RigidTransform> Actions::aim(std::size_t hand, XrSpace world, XrTime at) const {
    auto location = make_struct<XrSpaceLocation>(XR_TYPE_SPACE_LOCATION);
    check(xrLocateSpace(aims_[hand].get(), world, at, &location), "xrLocateSpace");
    constexpr XrSpaceLocationFlags known =
        XR_SPACE_LOCATION_POSITION_VALID_BIT | XR_SPACE_LOCATION_ORIENTATION_VALID_BIT;
    return (location.locationFlags & known) == known ? std::optional(from_xr(location.pose)) : std::nullopt;
}

bool Actions::pressed(XrAction action) const {
    auto info = make_struct<XrActionStateGetInfo>(XR_TYPE_ACTION_STATE_GET_INFO);
    info.action = action;
    auto state = make_struct<XrActionStateBoolean>(XR_TYPE_ACTION_STATE_BOOLEAN);
    check(xrGetActionStateBoolean(session_, &info, &state), "xrGetActionStateBoolean");
    return state.isActive == XR_TRUE && state.currentState == XR_TRUE;
}

Pad Actions::pad(XrAction place, XrAction press) const {
    auto info = make_struct<XrActionStateGetInfo>(XR_TYPE_ACTION_STATE_GET_INFO);
    info.action = place;
    auto state = make_struct<XrActionStateVector2f>(XR_TYPE_ACTION_STATE_VECTOR2F);
    check(xrGetActionStateVector2f(session_, &info, &state), "xrGetActionStateVector2f");
    return state.isActive == XR_TRUE ? Pad{state.currentState.x, state.currentState.y, pressed(press)}
                                     : Pad{};
}

}  // namespace eti::hmd
