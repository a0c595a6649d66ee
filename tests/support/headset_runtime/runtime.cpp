// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors

// An OpenXR runtime for tests: a headset and two hand controllers driven by a script in simulated time. It
// implements only the functions that this project calls, checks call order and frame times, and saves the
// submitted images. ETI_HEADSET_FOLDER names the folder of script.json (input), report.json and the images
// (output).
#include <openxr/openxr.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "tests/support/headset_runtime/hands.hpp"
#include "tests/support/headset_runtime/state.hpp"

// Included last: X11 defines macros that clash with other headers.
#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <epoxy/glx.h>

#define XR_USE_GRAPHICS_API_OPENGL
#define XR_USE_PLATFORM_EGL
#define XR_USE_PLATFORM_XLIB
#include <openxr/openxr_platform.h>

// Loader negotiation (OpenXR loader design, "Loader to runtime"); Debian ships no header for it.
struct XrNegotiateLoaderInfo {
    std::uint32_t structType, structVersion;
    std::size_t structSize;
    std::uint32_t minInterfaceVersion, maxInterfaceVersion;
    XrVersion minApiVersion, maxApiVersion;
};
struct XrNegotiateRuntimeRequest {
    std::uint32_t structType, structVersion;
    std::size_t structSize;
    std::uint32_t runtimeInterfaceVersion;
    XrVersion runtimeApiVersion;
    PFN_xrGetInstanceProcAddr getInstanceProcAddr;
};

namespace eti::headset_runtime {

State state;

namespace {

// ---- instance and system ---------------------------------------------------------------------

XrResult XRAPI_CALL extensions(const char*, std::uint32_t capacity, std::uint32_t* count,
                               XrExtensionProperties* out) {
    std::vector<XrExtensionProperties> all;
    for (const char* const name : {XR_KHR_OPENGL_ENABLE_EXTENSION_NAME, XR_MNDX_EGL_ENABLE_EXTENSION_NAME}) {
        XrExtensionProperties one{};
        one.type = XR_TYPE_EXTENSION_PROPERTIES;
        std::strncpy(one.extensionName, name, XR_MAX_EXTENSION_NAME_SIZE - 1);
        one.extensionVersion = 1;
        all.push_back(one);
    }
    return fill(all, capacity, count, out);
}

XrResult XRAPI_CALL create_instance(const XrInstanceCreateInfo*, XrInstance* out) {
    const char* const folder = std::getenv("ETI_HEADSET_FOLDER");
    try {
        state.simulation = std::make_unique<SimulatedSession>(folder != nullptr ? folder : ".");
    } catch (const std::exception& error) {
        fmt::print(stderr, "headset_runtime: script.json cannot be read: {}\n", error.what());
        return XR_ERROR_RUNTIME_FAILURE;
    }
    *out = new_handle<XrInstance>();
    return XR_SUCCESS;
}

XrResult XRAPI_CALL destroy_instance(XrInstance) {
    if (state.session != XR_NULL_HANDLE) {
        simulation().fault("the instance was destroyed before its session");
    }
    simulation().report();
    state = State();
    return XR_SUCCESS;
}

XrResult XRAPI_CALL instance_properties(XrInstance, XrInstanceProperties* out) {
    std::strncpy(out->runtimeName, "scripted headset", XR_MAX_RUNTIME_NAME_SIZE - 1);
    out->runtimeVersion = XR_MAKE_VERSION(1, 0, 0);
    return XR_SUCCESS;
}

XrResult XRAPI_CALL poll_event(XrInstance, XrEventDataBuffer* out) {
    ETI_UNLESS_LOST();
    const auto message = simulation().next_message();
    if (!message) {
        return XR_EVENT_UNAVAILABLE;
    }
    if (const auto* const changed = std::get_if<XrSessionState>(&*message)) {
        XrEventDataSessionStateChanged event{};
        event.type = XR_TYPE_EVENT_DATA_SESSION_STATE_CHANGED;
        event.session = state.session;
        event.state = *changed;
        event.time = simulation().seen_at();
        std::memcpy(out, &event, sizeof event);
    } else {
        XrEventDataReferenceSpaceChangePending event{};
        event.type = XR_TYPE_EVENT_DATA_REFERENCE_SPACE_CHANGE_PENDING;
        event.session = state.session;
        event.referenceSpaceType = XR_REFERENCE_SPACE_TYPE_LOCAL;
        event.changeTime = simulation().seen_at();
        event.poseInPreviousSpace.orientation.w = 1.0f;
        std::memcpy(out, &event, sizeof event);
    }
    return XR_SUCCESS;
}

XrResult XRAPI_CALL get_system(XrInstance, const XrSystemGetInfo* info, XrSystemId* out) {
    ETI_UNLESS_LOST();
    if (info->formFactor != XR_FORM_FACTOR_HEAD_MOUNTED_DISPLAY) {
        return XR_ERROR_FORM_FACTOR_UNSUPPORTED;
    }
    if (state.asked_for_headset++ < simulation().script().absent) {
        return XR_ERROR_FORM_FACTOR_UNAVAILABLE;
    }
    *out = 1;
    return XR_SUCCESS;
}

XrResult XRAPI_CALL system_properties(XrInstance, XrSystemId id, XrSystemProperties* out) {
    out->systemId = id;
    out->vendorId = 0;
    std::strncpy(out->systemName, "scripted headset", XR_MAX_SYSTEM_NAME_SIZE - 1);
    out->graphicsProperties = {4096, 4096, XR_MIN_COMPOSITION_LAYERS_SUPPORTED};
    out->trackingProperties = {XR_TRUE, XR_TRUE};
    return XR_SUCCESS;
}

XrResult XRAPI_CALL view_configurations(XrInstance, XrSystemId, std::uint32_t capacity, std::uint32_t* count,
                                        XrViewConfigurationType* out) {
    return fill<XrViewConfigurationType>({XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO}, capacity, count, out);
}

XrResult XRAPI_CALL view_configuration_views(XrInstance, XrSystemId, XrViewConfigurationType,
                                             std::uint32_t capacity, std::uint32_t* count,
                                             XrViewConfigurationView* out) {
    const auto width = static_cast<std::uint32_t>(simulation().script().eye_width);
    const auto height = static_cast<std::uint32_t>(simulation().script().eye_height);
    const XrViewConfigurationView view{
        XR_TYPE_VIEW_CONFIGURATION_VIEW, nullptr, width, 2 * width, height, 2 * height, 1, 4};
    return fill<XrViewConfigurationView>({view, view}, capacity, count, out);
}

XrResult XRAPI_CALL blend_modes(XrInstance, XrSystemId, XrViewConfigurationType, std::uint32_t capacity,
                                std::uint32_t* count, XrEnvironmentBlendMode* out) {
    return fill<XrEnvironmentBlendMode>({XR_ENVIRONMENT_BLEND_MODE_OPAQUE}, capacity, count, out);
}

XrResult XRAPI_CALL graphics_requirements(XrInstance, XrSystemId, XrGraphicsRequirementsOpenGLKHR* out) {
    state.versions_asked = true;
    out->minApiVersionSupported = XR_MAKE_VERSION(3, 3, 0);
    out->maxApiVersionSupported = XR_MAKE_VERSION(4, 6, 0);
    return XR_SUCCESS;
}

// ---- session ---------------------------------------------------------------------------------

bool names_current_context(const XrBaseInStructure* binding) {
    if (binding != nullptr && binding->type == XR_TYPE_GRAPHICS_BINDING_EGL_MNDX) {
        return reinterpret_cast<const XrGraphicsBindingEGLMNDX*>(binding)->context == eglGetCurrentContext();
    }
    if (binding != nullptr && binding->type == XR_TYPE_GRAPHICS_BINDING_OPENGL_XLIB_KHR) {
        const auto& named = *reinterpret_cast<const XrGraphicsBindingOpenGLXlibKHR*>(binding);
        state.display = named.xDisplay;
        return named.glxContext == glXGetCurrentContext() && named.glxDrawable == glXGetCurrentDrawable() &&
               named.glxFBConfig != nullptr && named.visualid != 0;
    }
    return false;
}

XrResult XRAPI_CALL create_session(XrInstance, const XrSessionCreateInfo* info, XrSession* out) {
    ETI_UNLESS_LOST();
    if (!state.versions_asked) {
        simulation().fault("xrCreateSession before xrGetOpenGLGraphicsRequirementsKHR");
        return XR_ERROR_GRAPHICS_REQUIREMENTS_CALL_MISSING;
    }
    if (!names_current_context(static_cast<const XrBaseInStructure*>(info->next))) {
        simulation().fault("xrCreateSession without the context that is current");
        return XR_ERROR_GRAPHICS_DEVICE_INVALID;
    }
    *out = state.session = new_handle<XrSession>();
    state.attached = state.synchronised = false;
    simulation().session_made();
    return XR_SUCCESS;
}

XrResult XRAPI_CALL destroy_session(XrSession) {
    state.chains.clear();
    state.session = XR_NULL_HANDLE;
    simulation().session_gone();
    simulation().report();
    return XR_SUCCESS;
}

XrResult XRAPI_CALL begin_session(XrSession, const XrSessionBeginInfo*) {
    ETI_UNLESS_LOST();
    return simulation().begin_session();
}
XrResult XRAPI_CALL end_session(XrSession) {
    ETI_UNLESS_LOST();
    return simulation().end_session();
}
XrResult XRAPI_CALL request_exit(XrSession) {
    ETI_UNLESS_LOST();
    return simulation().request_exit();
}

XrResult XRAPI_CALL create_space(XrSession, const XrReferenceSpaceCreateInfo* info, XrSpace* out) {
    if (info->referenceSpaceType != XR_REFERENCE_SPACE_TYPE_LOCAL) {
        return XR_ERROR_REFERENCE_SPACE_UNSUPPORTED;
    }
    *out = new_handle<XrSpace>();
    return XR_SUCCESS;
}
XrResult XRAPI_CALL destroy_space(XrSpace space) {
    state.action_spaces.erase(number(space));
    return XR_SUCCESS;
}

// ---- pictures --------------------------------------------------------------------------------

XrResult XRAPI_CALL formats(XrSession, std::uint32_t capacity, std::uint32_t* count, std::int64_t* out) {
    return fill<std::int64_t>({GL_SRGB8_ALPHA8, GL_RGBA8}, capacity, count, out);
}

XrResult XRAPI_CALL create_swapchain(XrSession, const XrSwapchainCreateInfo* info, XrSwapchain* out) {
    ETI_UNLESS_LOST();
    if (info->arraySize > 1 && !simulation().script().layered) {
        return XR_ERROR_FEATURE_UNSUPPORTED;
    }
    *out = new_handle<XrSwapchain>();
    state.chains[number(*out)] = std::make_unique<RuntimeSwapchain>(
        static_cast<int>(info->width), static_cast<int>(info->height), static_cast<int>(info->arraySize),
        static_cast<GLenum>(info->format));
    return XR_SUCCESS;
}

XrResult XRAPI_CALL destroy_swapchain(XrSwapchain swapchain) {
    state.chains.erase(number(swapchain));
    return XR_SUCCESS;
}

XrResult XRAPI_CALL swapchain_images(XrSwapchain swapchain, std::uint32_t capacity, std::uint32_t* count,
                                     XrSwapchainImageBaseHeader* out) {
    *count = RuntimeSwapchain::length;
    for (std::uint32_t i = 0; i < std::min(capacity, RuntimeSwapchain::length); ++i) {
        reinterpret_cast<XrSwapchainImageOpenGLKHR*>(out)[i].image =
            state.chains.at(number(swapchain))->textures[i];
    }
    return XR_SUCCESS;
}

XrResult XRAPI_CALL acquire(XrSwapchain swapchain, const XrSwapchainImageAcquireInfo*, std::uint32_t* index) {
    ETI_UNLESS_LOST();
    RuntimeSwapchain& chain = *state.chains.at(number(swapchain));
    if (chain.acquired || !simulation().in_frame()) {
        simulation().fault("a picture was acquired twice, or outside a frame");
        return XR_ERROR_CALL_ORDER_INVALID;
    }
    chain.acquired = true;
    *index = chain.next;
    chain.next = (chain.next + 1) % RuntimeSwapchain::length;
    return XR_SUCCESS;
}

XrResult XRAPI_CALL wait_image(XrSwapchain swapchain, const XrSwapchainImageWaitInfo*) {
    RuntimeSwapchain& chain = *state.chains.at(number(swapchain));
    if (!chain.acquired || chain.waited) {
        simulation().fault("a picture was waited for that was not acquired");
        return XR_ERROR_CALL_ORDER_INVALID;
    }
    chain.waited = true;
    // The specification allows this: the application must make its own context current again.
    if (state.display != nullptr) {
        glXMakeCurrent(static_cast<Display*>(state.display), 0, nullptr);
    } else {
        eglMakeCurrent(eglGetCurrentDisplay(), EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    }
    return XR_SUCCESS;
}

XrResult XRAPI_CALL release(XrSwapchain swapchain, const XrSwapchainImageReleaseInfo*) {
    RuntimeSwapchain& chain = *state.chains.at(number(swapchain));
    if (!chain.waited) {
        simulation().fault("a picture was released that was not waited for");
        return XR_ERROR_CALL_ORDER_INVALID;
    }
    if (glGetError() != GL_NO_ERROR) {
        simulation().fault("OpenGL reports an error");
    }
    chain.acquired = chain.waited = false;
    chain.ever_released = true;
    return XR_SUCCESS;
}

// ---- frames ----------------------------------------------------------------------------------

XrResult XRAPI_CALL wait_frame(XrSession, const XrFrameWaitInfo*, XrFrameState* out) {
    ETI_UNLESS_LOST();
    return simulation().wait_frame(*out);
}
XrResult XRAPI_CALL begin_frame(XrSession, const XrFrameBeginInfo*) {
    ETI_UNLESS_LOST();
    return simulation().begin_frame();
}

XrResult XRAPI_CALL locate_views(XrSession, const XrViewLocateInfo* info, XrViewState* views,
                                 std::uint32_t capacity, std::uint32_t* count, XrView* out) {
    ETI_UNLESS_LOST();
    if (info->displayTime != simulation().seen_at()) {
        simulation().fault("eyes were asked for at another time than the frame is seen");
    }
    views->viewStateFlags = XR_VIEW_STATE_POSITION_VALID_BIT | XR_VIEW_STATE_ORIENTATION_VALID_BIT |
                            XR_VIEW_STATE_POSITION_TRACKED_BIT | XR_VIEW_STATE_ORIENTATION_TRACKED_BIT;
    return fill<XrView>({simulation().eye(0, info->displayTime), simulation().eye(1, info->displayTime)},
                        capacity, count, out);
}

bool fits(const XrSwapchainSubImage& part) {
    const auto found = state.chains.find(number(part.swapchain));
    if (found == state.chains.end()) {
        return false;
    }
    const RuntimeSwapchain& chain = *found->second;
    const auto& [offset, extent] = part.imageRect;
    return !chain.acquired && chain.ever_released && offset.x >= 0 && offset.y >= 0 && extent.width > 0 &&
           extent.height > 0 && offset.x + extent.width <= chain.width &&
           offset.y + extent.height <= chain.height && static_cast<int>(part.imageArrayIndex) < chain.layers;
}

void keep(const XrSwapchainSubImage& part, const char* what) {
    state.chains.at(number(part.swapchain))
        ->write(static_cast<int>(part.imageArrayIndex),
                simulation().folder() / fmt::format("{:03d}_{}.png", simulation().frame(), what));
}

bool same(const XrView& a, const XrCompositionLayerProjectionView& b) {
    const auto near = [](float x, float y) { return std::abs(x - y) < 1e-4f; };
    const XrQuaternionf &p = a.pose.orientation, &q = b.pose.orientation;
    return near(a.pose.position.x, b.pose.position.x) && near(a.pose.position.y, b.pose.position.y) &&
           near(a.pose.position.z, b.pose.position.z) &&
           near(std::abs(p.x * q.x + p.y * q.y + p.z * q.z + p.w * q.w), 1.0f) &&
           near(a.fov.angleLeft, b.fov.angleLeft) && near(a.fov.angleRight, b.fov.angleRight) &&
           near(a.fov.angleUp, b.fov.angleUp) && near(a.fov.angleDown, b.fov.angleDown);
}

void show_eyes(const XrCompositionLayerProjection& layer, bool kept) {
    if (layer.viewCount != 2) {
        simulation().fault("not two eyes were shown");
        return;
    }
    nlohmann::json eyes = nlohmann::json::array();
    for (int i = 0; i < 2; ++i) {
        const XrCompositionLayerProjectionView& view = layer.views[i];
        if (!same(simulation().eye(i, simulation().seen_at()), view)) {
            simulation().fault("an eye was drawn from elsewhere than it will be");
        }
        if (!fits(view.subImage)) {
            simulation().fault("an eye's picture is none, or lies outside its chain");
        } else if (kept) {
            keep(view.subImage, i == 0 ? "left" : "right");
        }
        const auto& [place, turn] = std::pair(view.pose.position, view.pose.orientation);
        eyes.push_back(
            {{"position", {place.x, place.y, place.z}},
             {"orientation", {turn.w, turn.x, turn.y, turn.z}},
             {"fov", {view.fov.angleLeft, view.fov.angleRight, view.fov.angleUp, view.fov.angleDown}}});
    }
    if (kept) {
        simulation().report_json()["pictures"].push_back({{"frame", simulation().frame()}, {"eyes", eyes}});
    }
}

XrResult XRAPI_CALL end_frame(XrSession, const XrFrameEndInfo* info) {
    ETI_UNLESS_LOST();
    const bool kept = simulation().script().pictures.contains(simulation().frame());
    bool shown = false;
    int sheets = 0;
    for (std::uint32_t i = 0; i < info->layerCount; ++i) {
        const XrCompositionLayerBaseHeader* const layer = info->layers[i];
        if (layer->type == XR_TYPE_COMPOSITION_LAYER_PROJECTION) {
            show_eyes(*reinterpret_cast<const XrCompositionLayerProjection*>(layer), kept);
            shown = true;
        } else if (layer->type == XR_TYPE_COMPOSITION_LAYER_QUAD) {
            const auto& sheet = *reinterpret_cast<const XrCompositionLayerQuad*>(layer);
            if (!fits(sheet.subImage)) {
                simulation().fault("the sheet's picture is none, or lies outside its chain");
            } else if (kept) {
                // The first quad carries the readout.
                const char* const name = sheets == 0 ? "sheet" : "panel";
                keep(sheet.subImage, name);
                const auto& [turn, place] = sheet.pose;
                simulation().report_json()[name] = {{"position", {place.x, place.y, place.z}},
                                                    {"orientation", {turn.w, turn.x, turn.y, turn.z}},
                                                    {"size", {sheet.size.width, sheet.size.height}}};
            }
            ++sheets;
        } else {
            simulation().fault("a layer of an unknown kind");
        }
    }
    return simulation().end_frame(info->displayTime, shown);
}

XrResult XRAPI_CALL function_named(XrInstance, const char* name, PFN_xrVoidFunction* out) {
    static const std::map<std::string, void*> functions{
        {"xrGetInstanceProcAddr", reinterpret_cast<void*>(function_named)},
        {"xrEnumerateInstanceExtensionProperties", reinterpret_cast<void*>(extensions)},
        {"xrCreateInstance", reinterpret_cast<void*>(create_instance)},
        {"xrDestroyInstance", reinterpret_cast<void*>(destroy_instance)},
        {"xrGetInstanceProperties", reinterpret_cast<void*>(instance_properties)},
        {"xrPollEvent", reinterpret_cast<void*>(poll_event)},
        {"xrGetSystem", reinterpret_cast<void*>(get_system)},
        {"xrGetSystemProperties", reinterpret_cast<void*>(system_properties)},
        {"xrEnumerateViewConfigurations", reinterpret_cast<void*>(view_configurations)},
        {"xrEnumerateViewConfigurationViews", reinterpret_cast<void*>(view_configuration_views)},
        {"xrEnumerateEnvironmentBlendModes", reinterpret_cast<void*>(blend_modes)},
        {"xrGetOpenGLGraphicsRequirementsKHR", reinterpret_cast<void*>(graphics_requirements)},
        {"xrCreateSession", reinterpret_cast<void*>(create_session)},
        {"xrDestroySession", reinterpret_cast<void*>(destroy_session)},
        {"xrBeginSession", reinterpret_cast<void*>(begin_session)},
        {"xrEndSession", reinterpret_cast<void*>(end_session)},
        {"xrRequestExitSession", reinterpret_cast<void*>(request_exit)},
        {"xrCreateReferenceSpace", reinterpret_cast<void*>(create_space)},
        {"xrCreateActionSpace", reinterpret_cast<void*>(create_action_space)},
        {"xrLocateSpace", reinterpret_cast<void*>(locate_space)},
        {"xrDestroySpace", reinterpret_cast<void*>(destroy_space)},
        {"xrEnumerateSwapchainFormats", reinterpret_cast<void*>(formats)},
        {"xrCreateSwapchain", reinterpret_cast<void*>(create_swapchain)},
        {"xrDestroySwapchain", reinterpret_cast<void*>(destroy_swapchain)},
        {"xrEnumerateSwapchainImages", reinterpret_cast<void*>(swapchain_images)},
        {"xrAcquireSwapchainImage", reinterpret_cast<void*>(acquire)},
        {"xrWaitSwapchainImage", reinterpret_cast<void*>(wait_image)},
        {"xrReleaseSwapchainImage", reinterpret_cast<void*>(release)},
        {"xrWaitFrame", reinterpret_cast<void*>(wait_frame)},
        {"xrBeginFrame", reinterpret_cast<void*>(begin_frame)},
        {"xrLocateViews", reinterpret_cast<void*>(locate_views)},
        {"xrEndFrame", reinterpret_cast<void*>(end_frame)},
        {"xrStringToPath", reinterpret_cast<void*>(string_to_path)},
        {"xrPathToString", reinterpret_cast<void*>(path_to_string)},
        {"xrCreateActionSet", reinterpret_cast<void*>(create_action_set)},
        {"xrDestroyActionSet", reinterpret_cast<void*>(destroy_action_set)},
        {"xrCreateAction", reinterpret_cast<void*>(create_action)},
        {"xrDestroyAction", reinterpret_cast<void*>(destroy_action)},
        {"xrSuggestInteractionProfileBindings", reinterpret_cast<void*>(suggest)},
        {"xrAttachSessionActionSets", reinterpret_cast<void*>(attach)},
        {"xrSyncActions", reinterpret_cast<void*>(synchronise)},
        {"xrGetActionStateFloat", reinterpret_cast<void*>(get_float)},
        {"xrGetActionStateBoolean", reinterpret_cast<void*>(get_boolean)},
        {"xrGetActionStateVector2f", reinterpret_cast<void*>(get_vector)}};
    const auto found = functions.find(name);
    if (found == functions.end()) {
        *out = nullptr;
        return XR_ERROR_FUNCTION_UNSUPPORTED;
    }
    *out = reinterpret_cast<PFN_xrVoidFunction>(found->second);
    return XR_SUCCESS;
}

}  // namespace
}  // namespace eti::headset_runtime

extern "C" __attribute__((visibility("default"))) XrResult XRAPI_CALL
xrNegotiateLoaderRuntimeInterface(const XrNegotiateLoaderInfo*, XrNegotiateRuntimeRequest* request) {
    request->runtimeInterfaceVersion = 1;
    request->runtimeApiVersion = XR_CURRENT_API_VERSION;
    request->getInstanceProcAddr = eti::headset_runtime::function_named;
    return XR_SUCCESS;
}
