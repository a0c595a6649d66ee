// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/hmd/runtime.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <vector>

#include <fmt/format.h>

#include "client/hmd/platform.hpp"

namespace eti::hmd {
namespace {

[[noreturn]] void no_runtime(const char* call, XrResult result) {
    throw RuntimeUnavailable(fmt::format(
        "--view hmd: no OpenXR runtime responds ({}: {}). Expected one named by XR_RUNTIME_JSON or by "
        "openxr/1/active_runtime.json in ~/.config, /etc/xdg or /etc. Install the headset's software, e.g. "
        "Monado or SteamVR, and start it once; eti-doctor lists the searched locations.",
        call, name_of(result)));
}

std::vector<XrExtensionProperties> offered() {
    std::uint32_t count = 0;
    const char* const call = "xrEnumerateInstanceExtensionProperties";
    XrResult result = xrEnumerateInstanceExtensionProperties(nullptr, 0, &count, nullptr);
    std::vector<XrExtensionProperties> out(count,
                                           make_struct<XrExtensionProperties>(XR_TYPE_EXTENSION_PROPERTIES));
    if (XR_SUCCEEDED(result) && count > 0) {
        result = xrEnumerateInstanceExtensionProperties(nullptr, count, &count, out.data());
    }
    if (XR_FAILED(result)) {
        no_runtime(call, result);
    }
    return out;
}

}  // namespace

Runtime::Runtime() {
    const auto all = offered();
    const auto has = [&](const char* wanted) {
        return std::ranges::any_of(
            all, [&](const auto& one) { return std::strcmp(one.extensionName, wanted) == 0; });
    };
    if (!has(XR_KHR_OPENGL_ENABLE_EXTENSION_NAME)) {
        throw RuntimeUnavailable(
            fmt::format("--view hmd: the OpenXR runtime does not support {}, which rendering to a headset "
                        "requires. Choose one that does, e.g. Monado or SteamVR, with XR_RUNTIME_JSON.",
                        XR_KHR_OPENGL_ENABLE_EXTENSION_NAME));
    }
    std::vector<const char*> extensions{XR_KHR_OPENGL_ENABLE_EXTENSION_NAME};
    egl_ = has(XR_MNDX_EGL_ENABLE_EXTENSION_NAME);
    if (egl_) {
        extensions.push_back(XR_MNDX_EGL_ENABLE_EXTENSION_NAME);
    }
    auto info = make_struct<XrInstanceCreateInfo>(XR_TYPE_INSTANCE_CREATE_INFO);
    std::strncpy(info.applicationInfo.applicationName, "NeoETI", XR_MAX_APPLICATION_NAME_SIZE - 1);
    info.applicationInfo.apiVersion = XR_MAKE_VERSION(1, 0, 0);
    info.enabledExtensionCount = static_cast<std::uint32_t>(extensions.size());
    info.enabledExtensionNames = extensions.data();
    if (const XrResult result = xrCreateInstance(&info, instance_.put()); XR_FAILED(result)) {
        no_runtime("xrCreateInstance", result);
    }
    auto properties = make_struct<XrInstanceProperties>(XR_TYPE_INSTANCE_PROPERTIES);
    check(xrGetInstanceProperties(instance(), &properties), "xrGetInstanceProperties");
    name_ = properties.runtimeName;
}

std::optional<Headset> Runtime::headset() const {
    auto info = make_struct<XrSystemGetInfo>(XR_TYPE_SYSTEM_GET_INFO);
    info.formFactor = XR_FORM_FACTOR_HEAD_MOUNTED_DISPLAY;
    Headset out;
    const XrResult result = xrGetSystem(instance(), &info, &out.system);
    if (result == XR_ERROR_FORM_FACTOR_UNAVAILABLE) {
        return std::nullopt;
    }
    if (result == XR_ERROR_FORM_FACTOR_UNSUPPORTED) {
        throw RuntimeUnavailable(
            fmt::format("--view hmd: the OpenXR runtime '{}' does not support headsets. Choose one that does "
                        "with XR_RUNTIME_JSON.",
                        name_));
    }
    check(result, "xrGetSystem");
    auto properties = make_struct<XrSystemProperties>(XR_TYPE_SYSTEM_PROPERTIES);
    check(xrGetSystemProperties(instance(), out.system, &properties), "xrGetSystemProperties");
    out.name = properties.systemName;
    std::array<XrViewConfigurationView, 2> views{};
    views.fill(make_struct<XrViewConfigurationView>(XR_TYPE_VIEW_CONFIGURATION_VIEW));
    std::uint32_t count = 0;
    check(xrEnumerateViewConfigurationViews(instance(), out.system, XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO,
                                            static_cast<std::uint32_t>(views.size()), &count, views.data()),
          "xrEnumerateViewConfigurationViews");
    // Both eyes are drawn side by side into one target of equal halves.
    for (const XrViewConfigurationView& view : views) {
        out.eye_width = std::max(out.eye_width, static_cast<int>(view.recommendedImageRectWidth));
        out.eye_height = std::max(out.eye_height, static_cast<int>(view.recommendedImageRectHeight));
    }
    return out;
}

}  // namespace eti::hmd
