// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "tests/support/headset_runtime/script.hpp"

#include <algorithm>
#include <fstream>

#include <nlohmann/json.hpp>

namespace eti::headset_runtime {

RigidTransform Script::head_at(double frame) const {
    const auto after = std::ranges::find_if(head, [&](const HeadKeyframe& one) { return one.frame > frame; });
    const HeadKeyframe& to = after == head.end() ? head.back() : *after;
    const HeadKeyframe& from = after == head.begin() ? head.front() : *(after - 1);
    const double length = to.frame - from.frame;
    const auto share = static_cast<float>(length > 0.0 ? (frame - from.frame) / length : 0.0);
    const float pitch = from.pitch + share * (to.pitch - from.pitch);
    return RigidTransform::from(Quatf(Eigen::AngleAxisf(pitch, Vec3f::UnitX())),
                                from.position + share * (to.position - from.position));
}

std::array<float, 2> Script::input_at(const std::string& input, double frame) const {
    std::array<float, 2> out{};
    for (const InputKeyframe& one : hands) {
        if (one.input == input && one.frame <= frame) {
            out = one.value;
        }
    }
    return out;
}

std::optional<RigidTransform> Script::aim_at(const std::string& hand, double frame) const {
    std::optional<RigidTransform> out;
    for (const AimKeyframe& one : aims) {
        if (one.hand == hand && one.frame <= frame) {
            out = one.aim;
        }
    }
    return out;
}

Script read_script(const std::filesystem::path& file) {
    const auto text = nlohmann::json::parse(std::ifstream(file));
    Script out;
    out.eye_width = text.value("eye_width", out.eye_width);
    out.eye_height = text.value("eye_height", out.eye_height);
    out.layered = text.value("layered", out.layered);
    out.absent = text.value("absent", out.absent);
    out.pace_ms = text.value("pace_ms", out.pace_ms);
    out.controller = text.value("controller", out.controller);
    out.pictures = text.value("pictures", out.pictures);
    if (text.contains("head")) {
        out.head.clear();
        for (const auto& one : text["head"]) {
            const auto p = one["position"].get<std::array<float, 3>>();
            out.head.push_back({one.value("frame", 0.0), {p[0], p[1], p[2]}, one.value("pitch", 0.0f)});
        }
    }
    for (const auto& one : text.value("hands", nlohmann::json::array())) {
        const auto& value = one["value"];
        out.hands.push_back({one["frame"], one["input"],
                             value.is_array() ? value.get<std::array<float, 2>>()
                                              : std::array<float, 2>{value.get<float>(), 0.0f}});
    }
    for (const auto& one : text.value("aims", nlohmann::json::array())) {
        const auto p = one["position"].get<std::array<float, 3>>();
        const auto q = one["orientation"].get<std::array<float, 4>>();  // w first
        out.aims.push_back({one["frame"], one["hand"],
                            RigidTransform::from(Quatf(q[0], q[1], q[2], q[3]), {p[0], p[1], p[2]})});
    }
    for (const auto& one : text.value("events", nlohmann::json::array())) {
        out.events.push_back({one["frame"], one["what"], one.value("life", 0)});
    }
    return out;
}

}  // namespace eti::headset_runtime
