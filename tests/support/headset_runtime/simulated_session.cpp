// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "tests/support/headset_runtime/simulated_session.hpp"

#include <chrono>
#include <fstream>
#include <thread>

#include <fmt/format.h>

namespace eti::headset_runtime {
namespace {

constexpr XrTime begun_at = 1'000'000'000;
constexpr std::size_t most_faults = 10;  // the first ones are the most informative

}  // namespace

SimulatedSession::SimulatedSession(const std::filesystem::path& folder)
    : folder_(folder), script_(read_script(folder / "script.json")), now_(begun_at) {
    // The loader unloads a lost runtime; the next one resumes from the report on disk.
    if (std::ifstream before(folder / "report.json"); before) {
        report_ = nlohmann::json::parse(before);
        life_ = report_["lives"];
    } else {
        report_ = {{"faults", nlohmann::json::array()},
                   {"frames", 0},
                   {"shown", 0},
                   {"sessions", 0},
                   {"profiles", nlohmann::json::array()},
                   {"pictures", nlohmann::json::array()}};
    }
    report_["lives"] = life_ + 1;
}

void SimulatedSession::fault(const std::string& what) {
    if (report_["faults"].size() < most_faults) {
        report_["faults"].push_back(fmt::format("life {}, frame {}: {}", life_, frame_, what));
    }
}

void SimulatedSession::report() const {
    std::ofstream(folder_ / "report.json") << report_.dump(2) << '\n';
}

void SimulatedSession::go(XrSessionState state) {
    planned_ = state;
    messages_.push_back(state);
}

void SimulatedSession::session_made() {
    report_["sessions"] = report_["sessions"].get<int>() + 1;
    go(XR_SESSION_STATE_IDLE);
    go(XR_SESSION_STATE_READY);
}

void SimulatedSession::session_gone() {
    if (running_ && planned_ != XR_SESSION_STATE_LOSS_PENDING && !lost_) {
        fault("the session was destroyed while it ran");
    }
    if (begun_) {
        fault("the session was destroyed within a frame");
    }
    messages_.clear();
    running_ = waited_ = begun_ = false;
    state_ = planned_ = XR_SESSION_STATE_UNKNOWN;
}

XrResult SimulatedSession::begin_session() {
    if (running_) {
        fault("xrBeginSession while the session runs");
        return XR_ERROR_SESSION_RUNNING;
    }
    if (state_ != XR_SESSION_STATE_READY) {
        fault("xrBeginSession before READY");
        return XR_ERROR_SESSION_NOT_READY;
    }
    running_ = true;
    go(XR_SESSION_STATE_SYNCHRONIZED);
    go(XR_SESSION_STATE_VISIBLE);
    go(XR_SESSION_STATE_FOCUSED);
    return XR_SUCCESS;
}

XrResult SimulatedSession::end_session() {
    if (!running_ || state_ != XR_SESSION_STATE_STOPPING) {
        fault("xrEndSession before STOPPING");
        return XR_ERROR_SESSION_NOT_STOPPING;
    }
    if (begun_ || waited_) {
        fault("xrEndSession within a frame");
    }
    running_ = false;
    go(XR_SESSION_STATE_IDLE);
    go(exit_asked_ ? XR_SESSION_STATE_EXITING : XR_SESSION_STATE_READY);
    return XR_SUCCESS;
}

XrResult SimulatedSession::request_exit() {
    if (!running_) {
        fault("xrRequestExitSession while the session does not run");
        return XR_ERROR_SESSION_NOT_RUNNING;
    }
    apply_event("leave");
    return XR_SUCCESS;
}

std::optional<SimulatedSession::Message> SimulatedSession::next_message() {
    if (messages_.empty()) {
        return std::nullopt;
    }
    const Message message = messages_.front();
    messages_.pop_front();
    if (const auto* const state = std::get_if<XrSessionState>(&message)) {
        state_ = *state;
    }
    return message;
}

void SimulatedSession::apply_event(const std::string& what) {
    if (what == "blur") {
        go(XR_SESSION_STATE_VISIBLE);
    } else if (what == "focus") {
        go(XR_SESSION_STATE_FOCUSED);
    } else if (what == "hide") {
        go(XR_SESSION_STATE_VISIBLE);
        go(XR_SESSION_STATE_SYNCHRONIZED);
    } else if (what == "show") {
        go(XR_SESSION_STATE_VISIBLE);
        go(XR_SESSION_STATE_FOCUSED);
    } else if (what == "sleep" || what == "leave") {
        exit_asked_ = exit_asked_ || what == "leave";
        go(XR_SESSION_STATE_VISIBLE);
        go(XR_SESSION_STATE_SYNCHRONIZED);
        go(XR_SESSION_STATE_STOPPING);
    } else if (what == "recentre") {
        centre_ = script_.head_at(frame_at(seen_at())).translation;
        messages_.push_back(Recentred{});
    } else if (what == "lose_headset") {
        go(XR_SESSION_STATE_LOSS_PENDING);
    } else if (what == "lose_runtime") {
        lost_ = true;
    } else {
        fault("the script asks for '" + what + "', which is unknown");
    }
}

XrResult SimulatedSession::wait_frame(XrFrameState& frame) {
    if (!running_) {
        fault("xrWaitFrame while the session does not run");
        return XR_ERROR_SESSION_NOT_RUNNING;
    }
    if (waited_) {
        fault("xrWaitFrame twice, without xrBeginFrame");
        return XR_ERROR_CALL_ORDER_INVALID;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(script_.pace_ms));
    now_ += period;
    ++frame_;
    waited_ = true;
    for (const Event& event : script_.events) {
        if (event.life == life_ && static_cast<int>(event.frame) == frame_) {
            apply_event(event.what);
        }
    }
    if (lost_) {
        return XR_ERROR_INSTANCE_LOST;
    }
    frame.predictedDisplayTime = seen_at();
    frame.predictedDisplayPeriod = period;
    frame.shouldRender = state_ == XR_SESSION_STATE_VISIBLE || state_ == XR_SESSION_STATE_FOCUSED;
    return XR_SUCCESS;
}

XrResult SimulatedSession::begin_frame() {
    if (!waited_ || begun_) {
        fault("xrBeginFrame without xrWaitFrame");
        return XR_ERROR_CALL_ORDER_INVALID;
    }
    waited_ = false;
    begun_ = true;
    return XR_SUCCESS;
}

XrResult SimulatedSession::end_frame(XrTime when, bool shown) {
    if (!begun_) {
        fault("xrEndFrame without xrBeginFrame");
        return XR_ERROR_CALL_ORDER_INVALID;
    }
    begun_ = false;
    if (when < now_) {
        fault("a frame came after it should have been seen");
    } else if (when != seen_at()) {
        fault("a frame came for another time than was predicted");
    }
    report_["frames"] = report_["frames"].get<int>() + 1;
    report_["shown"] = report_["shown"].get<int>() + (shown ? 1 : 0);
    return XR_SUCCESS;
}

double SimulatedSession::frame_at(XrTime when) const {
    return static_cast<double>(when - period - begun_at) / static_cast<double>(period);
}

std::optional<RigidTransform> SimulatedSession::aim(const std::string& hand) const {
    auto aim = script_.aim_at(hand, frame_);
    if (aim) {
        aim->translation -= centre_;
    }
    return aim;
}

XrView SimulatedSession::eye(int which, XrTime when) const {
    const float side = which == 0 ? -1.0f : 1.0f;
    const RigidTransform head = script_.head_at(frame_at(when));
    const RigidTransform eye =
        head * RigidTransform::from(Quatf::Identity(), {side * 0.5f * script_.between_eyes, 0.0f, 0.0f});
    const Vec3f place = eye.translation - centre_;
    const auto& [left, right, up, down] = script_.left_fov;
    XrView view{};
    view.type = XR_TYPE_VIEW;
    view.pose = {{eye.rotation.x(), eye.rotation.y(), eye.rotation.z(), eye.rotation.w()},
                 {place.x(), place.y(), place.z()}};
    view.fov = which == 0 ? XrFovf{left, right, up, down} : XrFovf{-right, -left, up, down};
    return view;
}

}  // namespace eti::headset_runtime
