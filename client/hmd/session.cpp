// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/hmd/session.hpp"

#include <spdlog/spdlog.h>

#include <vector>

#include "client/hmd/platform.hpp"

namespace eti::hmd {
namespace {

// A runtime rejects a session unless its supported OpenGL versions were queried before.
void ask_for_versions(const Runtime& runtime, XrSystemId system) {
    auto versions = make_struct<XrGraphicsRequirementsOpenGLKHR>(XR_TYPE_GRAPHICS_REQUIREMENTS_OPENGL_KHR);
    const auto ask =
        runtime.function<PFN_xrGetOpenGLGraphicsRequirementsKHR>("xrGetOpenGLGraphicsRequirementsKHR");
    check(ask(runtime.instance(), system, &versions), "xrGetOpenGLGraphicsRequirementsKHR");
    GLint major = 0, minor = 0;
    glGetIntegerv(GL_MAJOR_VERSION, &major);
    glGetIntegerv(GL_MINOR_VERSION, &minor);
    if (XR_MAKE_VERSION(major, minor, 0) < versions.minApiVersionSupported) {
        throw std::runtime_error(
            fmt::format("OpenXR: the driver supports OpenGL {}.{}, the headset's runtime requires {}.{}. "
                        "Install a newer driver.",
                        major, minor, XR_VERSION_MAJOR(versions.minApiVersionSupported),
                        XR_VERSION_MINOR(versions.minApiVersionSupported)));
    }
}

}  // namespace

Session::Session(const Runtime& runtime, const Headset& headset, const Graphics& graphics,
                 std::span<const QuadSize> panels)
    : runtime_(runtime) {
    ask_for_versions(runtime, headset.system);
    auto info = make_struct<XrSessionCreateInfo>(XR_TYPE_SESSION_CREATE_INFO);
    info.next = graphics.binding();
    info.systemId = headset.system;
    check(xrCreateSession(runtime.instance(), &info, session_.put()), "xrCreateSession");
    graphics.make_current();
    auto space = make_struct<XrReferenceSpaceCreateInfo>(XR_TYPE_REFERENCE_SPACE_CREATE_INFO);
    space.referenceSpaceType = XR_REFERENCE_SPACE_TYPE_LOCAL;
    space.poseInReferenceSpace = to_xr(RigidTransform{});
    check(xrCreateReferenceSpace(session_.get(), &space, world_.put()), "xrCreateReferenceSpace");
    actions_.emplace(runtime.instance(), session_.get());
    eye_images_.emplace(session_.get(), graphics, headset.eye_width, headset.eye_height);
    for (const QuadSize& panel : panels) {
        panel_images_.push_back(
            std::make_unique<QuadImage>(session_.get(), graphics, panel.width, panel.height));
    }
}

// Errors due to a lost session or runtime end the session; others are rethrown.
template <class Call>
auto Session::guarded(Call call) -> decltype(call()) {
    try {
        return call();
    } catch (const OpenXrError& failed) {
        if (failed.runtime_lost()) {
            life_.end_with(SessionEnd::runtime_lost);
        } else if (failed.headset_lost()) {
            life_.end_with(SessionEnd::headset_lost);
        } else {
            throw;
        }
        return decltype(call())();
    }
}

void Session::poll() {
    guarded([&] {
        while (life_.end() == SessionEnd::none) {
            auto event = make_struct<XrEventDataBuffer>(XR_TYPE_EVENT_DATA_BUFFER);
            if (check(xrPollEvent(runtime_.instance(), &event), "xrPollEvent") == XR_EVENT_UNAVAILABLE) {
                break;
            }
            switch (event.type) {
                case XR_TYPE_EVENT_DATA_SESSION_STATE_CHANGED:
                    on_state(*reinterpret_cast<const XrEventDataSessionStateChanged*>(&event));
                    break;
                case XR_TYPE_EVENT_DATA_REFERENCE_SPACE_CHANGE_PENDING:
                    // The runtime moves the world's origin; the patient keeps its place in it, in front of
                    // the trainee.
                    spdlog::info("the headset was recentred");
                    ++recentred_;
                    break;
                case XR_TYPE_EVENT_DATA_INSTANCE_LOSS_PENDING:
                    life_.end_with(SessionEnd::runtime_lost);
                    break;
                case XR_TYPE_EVENT_DATA_EVENTS_LOST:
                    spdlog::warn("the headset's runtime lost events: they were not polled in time");
                    break;
                default:
                    break;
            }
        }
    });
}

void Session::on_state(const XrEventDataSessionStateChanged& event) {
    if (event.session != session_.get()) {
        return;
    }
    switch (life_.enter(event.state)) {
        case RequiredCall::begin_session: {
            auto info = make_struct<XrSessionBeginInfo>(XR_TYPE_SESSION_BEGIN_INFO);
            info.primaryViewConfigurationType = XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO;
            check(xrBeginSession(session_.get(), &info), "xrBeginSession");
            break;
        }
        case RequiredCall::end_session:
            check(xrEndSession(session_.get()), "xrEndSession");
            break;
        case RequiredCall::none:
            break;
    }
}

void Session::leave() {
    guarded([&] {
        if (life_.request_exit()) {
            check(xrRequestExitSession(session_.get()), "xrRequestExitSession");
        }
    });
}

std::optional<Frame> Session::wait_frame() {
    return guarded([&]() -> std::optional<Frame> {
        auto state = make_struct<XrFrameState>(XR_TYPE_FRAME_STATE);
        check(xrWaitFrame(session_.get(), nullptr, &state), "xrWaitFrame");
        check(xrBeginFrame(session_.get(), nullptr), "xrBeginFrame");
        return Frame{state.predictedDisplayTime, state.shouldRender == XR_TRUE};
    });
}

std::optional<Eyes> Session::eyes(const Frame& frame) {
    return guarded([&]() -> std::optional<Eyes> {
        auto info = make_struct<XrViewLocateInfo>(XR_TYPE_VIEW_LOCATE_INFO);
        info.viewConfigurationType = XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO;
        info.displayTime = frame.display_time;
        info.space = world_.get();
        auto state = make_struct<XrViewState>(XR_TYPE_VIEW_STATE);
        std::array<XrView, 2> views{};
        views.fill(make_struct<XrView>(XR_TYPE_VIEW));
        std::uint32_t count = 0;
        check(xrLocateViews(session_.get(), &info, &state, static_cast<std::uint32_t>(views.size()), &count,
                            views.data()),
              "xrLocateViews");
        constexpr XrViewStateFlags known =
            XR_VIEW_STATE_POSITION_VALID_BIT | XR_VIEW_STATE_ORIENTATION_VALID_BIT;
        if ((state.viewStateFlags & known) != known || count != views.size()) {
            return std::nullopt;
        }
        Eyes out;
        for (std::size_t i = 0; i < views.size(); ++i) {
            out[i] = {hmd::from_xr(views[i].pose), hmd::from_xr(views[i].fov)};
        }
        return out;
    });
}

HandInput Session::hands(const Frame& frame) {
    return guarded(
        [&] { return life_.focused() ? actions_->read(world_.get(), frame.display_time) : HandInput{}; });
}

void Session::draw(const render::RenderTarget& both, std::span<const render::RenderTarget* const> panels) {
    guarded([&] {
        eye_images_->show(both);
        for (std::size_t i = 0; i < panels.size(); ++i) {
            panel_images_[i]->show(*panels[i]);
        }
    });
}

void Session::end_frame(const Frame& frame, const std::optional<Eyes>& seen_by,
                        std::span<const Quad> panels) {
    guarded([&] {
        std::array<XrCompositionLayerProjectionView, 2> views{};
        auto room = make_struct<XrCompositionLayerProjection>(XR_TYPE_COMPOSITION_LAYER_PROJECTION);
        std::vector<XrCompositionLayerQuad> sheets(
            panels.size(), make_struct<XrCompositionLayerQuad>(XR_TYPE_COMPOSITION_LAYER_QUAD));
        std::vector<const XrCompositionLayerBaseHeader*> layers;
        if (seen_by) {
            for (std::size_t i = 0; i < views.size(); ++i) {
                views[i] = {XR_TYPE_COMPOSITION_LAYER_PROJECTION_VIEW, nullptr, to_xr((*seen_by)[i].pose),
                            to_xr((*seen_by)[i].field), eye_images_->of(static_cast<int>(i))};
            }
            room.space = world_.get();
            room.viewCount = static_cast<std::uint32_t>(views.size());
            room.views = views.data();
            layers.push_back(reinterpret_cast<const XrCompositionLayerBaseHeader*>(&room));
            for (std::size_t i = 0; i < panels.size(); ++i) {
                XrCompositionLayerQuad& sheet = sheets[i];
                sheet.layerFlags = XR_COMPOSITION_LAYER_BLEND_TEXTURE_SOURCE_ALPHA_BIT;
                sheet.space = world_.get();
                sheet.eyeVisibility = XR_EYE_VISIBILITY_BOTH;
                sheet.subImage = panel_images_[i]->image();
                sheet.pose = to_xr(panels[i].pose);
                sheet.size = {panels[i].width, panels[i].height};
                layers.push_back(reinterpret_cast<const XrCompositionLayerBaseHeader*>(&sheet));
            }
        }
        auto info = make_struct<XrFrameEndInfo>(XR_TYPE_FRAME_END_INFO);
        info.displayTime = frame.display_time;
        info.environmentBlendMode = XR_ENVIRONMENT_BLEND_MODE_OPAQUE;
        info.layerCount = static_cast<std::uint32_t>(layers.size());
        info.layers = layers.data();
        check(xrEndFrame(session_.get(), &info), "xrEndFrame");
    });
}

}  // namespace eti::hmd
