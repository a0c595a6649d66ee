// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <openxr/openxr.h>

#include <cstdint>

namespace eti::headset_runtime {

// OpenXR functions for paths and actions.
XrResult XRAPI_CALL string_to_path(XrInstance, const char* text, XrPath* out);
XrResult XRAPI_CALL path_to_string(XrInstance, XrPath path, std::uint32_t capacity, std::uint32_t* count,
                                   char* out);
XrResult XRAPI_CALL create_action_set(XrInstance, const XrActionSetCreateInfo*, XrActionSet* out);
XrResult XRAPI_CALL destroy_action_set(XrActionSet);
XrResult XRAPI_CALL create_action(XrActionSet, const XrActionCreateInfo* info, XrAction* out);
XrResult XRAPI_CALL destroy_action(XrAction action);
XrResult XRAPI_CALL suggest(XrInstance, const XrInteractionProfileSuggestedBinding* bindings);
XrResult XRAPI_CALL attach(XrSession, const XrSessionActionSetsAttachInfo*);
XrResult XRAPI_CALL synchronise(XrSession, const XrActionsSyncInfo*);
XrResult XRAPI_CALL get_float(XrSession, const XrActionStateGetInfo* info, XrActionStateFloat* out);
XrResult XRAPI_CALL get_boolean(XrSession, const XrActionStateGetInfo* info, XrActionStateBoolean* out);
XrResult XRAPI_CALL create_action_space(XrSession, const XrActionSpaceCreateInfo* info, XrSpace* out);
XrResult XRAPI_CALL locate_space(XrSpace space, XrSpace base, XrTime when, XrSpaceLocation* out);
XrResult XRAPI_CALL get_vector(XrSession, const XrActionStateGetInfo* info, XrActionStateVector2f* out);

}  // namespace eti::headset_runtime
