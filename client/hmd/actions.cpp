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
    auto info = made<XrActionSetCreateInfo>(XR_TYPE_ACTION_SET_CREATE_INFO);
    std::strncpy(info.actionSetName, "hands", XR_MAX_ACTION_SET_NAME_SIZE - 1);
    std::strncpy(info.localizedActionSetName, "Hands", XR_MAX_LOCALIZED_ACTION_SET_NAME_SIZE - 1);
    check(xrCreateActionSet(instance, &info, set_.put()), "xrCreateActionSet");
    suction_ = make(XR_ACTION_TYPE_FLOAT_INPUT, "suction", "Suction");
    head_and_jaw_ =
        make(XR_ACTION_TYPE_VECTOR2F_INPUT, "head_and_jaw", "Head up and down, jaw open and closed");
    head_and_jaw_pressed_ = make(XR_ACTION_TYPE_BOOLEAN_INPUT, "head_and_jaw_pressed", "Move head or jaw");
    table_ = make(XR_ACTION_TYPE_VECTOR2F_INPUT, "table", "Table head-up and head-down");
    table_pressed_ = make(XR_ACTION_TYPE_BOOLEAN_INPUT, "table_pressed", "Tilt the table");
    head_up_ = make(XR_ACTION_TYPE_BOOLEAN_INPUT, "head_up", "Head up");
    head_down_ = make(XR_ACTION_TYPE_BOOLEAN_INPUT, "head_down", "Head down");
    enhanced_ = make(XR_ACTION_TYPE_BOOLEAN_INPUT, "enhanced", "Enhanced view on or off");
    suggest(instance);
    const XrActionSet set = set_.get();
    auto attach = made<XrSessionActionSetsAttachInfo>(XR_TYPE_SESSION_ACTION_SETS_ATTACH_INFO);
    attach.countActionSets = 1;
    attach.actionSets = &set;
    check(xrAttachSessionActionSets(session, &attach), "xrAttachSessionActionSets");
}

XrAction Actions::make(XrActionType type, const char* name, const char* shown) const {
    auto info = made<XrActionCreateInfo>(XR_TYPE_ACTION_CREATE_INFO);
    info.actionType = type;
    std::strncpy(info.actionName, name, XR_MAX_ACTION_NAME_SIZE - 1);
    std::strncpy(info.localizedActionName, shown, XR_MAX_LOCALIZED_ACTION_NAME_SIZE - 1);
    XrAction action = XR_NULL_HANDLE;
    check(xrCreateAction(set_.get(), &info, &action), "xrCreateAction");
    return action;
}

// Runtimes offer them to whoever holds such a controller, and fit others to them.
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
                                         {{suction_, "/user/hand/right/input/trigger/value"},
                                          {suction_, "/user/hand/left/input/trigger/value"},
                                          {head_and_jaw_, "/user/hand/right/input/trackpad"},
                                          {head_and_jaw_pressed_, "/user/hand/right/input/trackpad/click"},
                                          {table_, "/user/hand/left/input/trackpad"},
                                          {table_pressed_, "/user/hand/left/input/trackpad/click"},
                                          {enhanced_, "/user/hand/right/input/menu/click"},
                                          {enhanced_, "/user/hand/left/input/menu/click"}}},
                                        // Two buttons a hand: enough for what a trainee asks for most.
                                        {"/interaction_profiles/khr/simple_controller",
                                         {{suction_, "/user/hand/right/input/select/click"},
                                          {enhanced_, "/user/hand/right/input/menu/click"},
                                          {head_up_, "/user/hand/left/input/select/click"},
                                          {head_down_, "/user/hand/left/input/menu/click"}}}};
    for (const Profile& profile : profiles) {
        std::vector<XrActionSuggestedBinding> bindings;
        for (const Row& row : profile.rows) {
            bindings.push_back({row.action, path(instance, row.input)});
        }
        auto suggestion =
            made<XrInteractionProfileSuggestedBinding>(XR_TYPE_INTERACTION_PROFILE_SUGGESTED_BINDING);
        suggestion.interactionProfile = path(instance, profile.name);
        suggestion.countSuggestedBindings = static_cast<std::uint32_t>(bindings.size());
        suggestion.suggestedBindings = bindings.data();
        check(xrSuggestInteractionProfileBindings(instance, &suggestion),
              "xrSuggestInteractionProfileBindings");
    }
}

HandInput Actions::read() const {
    const XrActiveActionSet set{set_.get(), XR_NULL_PATH};
    auto sync = made<XrActionsSyncInfo>(XR_TYPE_ACTIONS_SYNC_INFO);
    sync.countActiveActionSets = 1;
    sync.activeActionSets = &set;
    if (check(xrSyncActions(session_, &sync), "xrSyncActions") == XR_SESSION_NOT_FOCUSED) {
        return {};
    }
    HandInput out;
    auto info = made<XrActionStateGetInfo>(XR_TYPE_ACTION_STATE_GET_INFO);
    info.action = suction_;
    auto suction = made<XrActionStateFloat>(XR_TYPE_ACTION_STATE_FLOAT);
    check(xrGetActionStateFloat(session_, &info, &suction), "xrGetActionStateFloat");
    out.suction = suction.isActive == XR_TRUE ? suction.currentState : 0.0f;
    out.head_and_jaw = pad(head_and_jaw_, head_and_jaw_pressed_);
    out.table = pad(table_, table_pressed_);
    out.head_up = pressed(head_up_);
    out.head_down = pressed(head_down_);
    out.enhanced = pressed(enhanced_);
    return out;
}

bool Actions::pressed(XrAction action) const {
    auto info = made<XrActionStateGetInfo>(XR_TYPE_ACTION_STATE_GET_INFO);
    info.action = action;
    auto state = made<XrActionStateBoolean>(XR_TYPE_ACTION_STATE_BOOLEAN);
    check(xrGetActionStateBoolean(session_, &info, &state), "xrGetActionStateBoolean");
    return state.isActive == XR_TRUE && state.currentState == XR_TRUE;
}

Pad Actions::pad(XrAction place, XrAction press) const {
    auto info = made<XrActionStateGetInfo>(XR_TYPE_ACTION_STATE_GET_INFO);
    info.action = place;
    auto state = made<XrActionStateVector2f>(XR_TYPE_ACTION_STATE_VECTOR2F);
    check(xrGetActionStateVector2f(session_, &info, &state), "xrGetActionStateVector2f");
    return state.isActive == XR_TRUE ? Pad{state.currentState.x, state.currentState.y, pressed(press)}
                                     : Pad{};
}

}  // namespace eti::hmd
