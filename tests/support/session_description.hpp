// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string>

#include "common/bus/codec/convert.hpp"
#include "common/bus/security/session_keys.hpp"

namespace eti::test {

/// A description that programs of this version accept.
[[nodiscard]] inline msg::SessionDescription session_description(
    const Landmarks& rest = zero_landmarks(), const Laryngoscope& scope = make_laryngoscope(Blade::miller_1),
    const Tube& tube = {}) {
    msg::SessionDescription out;
    out.session("test");
    out.version(ETI_VERSION);
    out.scenario("synthetic");
    out.description("made by a test");
    out.scenario_text("name: synthetic\n");
    out.steps_per_second(180);
    out.time_limit_s(30.0f);
    out.patient_weight_kg(3.5f);
    bus::set_keys({}, out);
    bus::set_tools(scope, tube, out);
    for (std::size_t i = 0; i < landmark_count; ++i) {
        out.landmarks().emplace_back();
        out.landmarks().back().name(std::string(landmark_names[i]));
        out.landmarks().back().rest(bus::to_msg(rest[i]));
    }
    return out;
}

}  // namespace eti::test
