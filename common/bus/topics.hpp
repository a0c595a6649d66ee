// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string_view>

#include "idl/eti.h"

namespace eti::bus {

namespace msg = ::eti::msg;

/// How a topic travels. One table says it for all topics; a new topic is a new row.
struct Quality {
    bool reliable = false;
    bool transient_local = false;    ///< late joiners get the last sample of each key
    int depth = 1;                   ///< samples kept per key
    bool manual_liveliness = false;  ///< a hung loop shows within 300 ms
};

template <class Message>
struct Topic {
    std::string_view name;
    Quality quality;
};

namespace topics {
inline constexpr Topic<msg::SceneDescription> scene{"eti/scene", {.reliable = true, .transient_local = true}};
inline constexpr Topic<msg::ToolPose> laryngoscope_pose{"eti/laryngoscope_pose", {}};
inline constexpr Topic<msg::ToolPose> tube_pose{"eti/tube_pose", {}};
inline constexpr Topic<msg::EyePose> eye_pose{"eti/eye_pose", {}};
inline constexpr Topic<msg::ProxyState> proxy{"eti/proxy", {}};
inline constexpr Topic<msg::TissueContacts> tissue_contacts{"eti/tissue_contacts", {}};
inline constexpr Topic<msg::TubeForce> tube_force{"eti/tube_force", {}};
// Best effort with room for the chunks of a few states: keep last 1 would drop all but the last chunk.
inline constexpr Topic<msg::DeformationState> deformation{"eti/deformation", {.depth = 1024}};
inline constexpr Topic<msg::DeformationState> deformation_slow{"eti/deformation_slow", {.depth = 1024}};
inline constexpr Topic<msg::FluidState> fluid{"eti/fluid", {.depth = 128}};
inline constexpr Topic<msg::Command> command{"eti/command", {.reliable = true, .depth = 64}};
inline constexpr Topic<msg::CommandResult> command_result{"eti/command_result",
                                                          {.reliable = true, .depth = 64}};
inline constexpr Topic<msg::LiveMetrics> live_metrics{"eti/live_metrics", {}};
inline constexpr Topic<msg::AttemptSummary> attempt_summary{"eti/attempt_summary",
                                                            {.reliable = true, .transient_local = true}};
inline constexpr Topic<msg::SessionStatus> session_status{
    "eti/session_status", {.reliable = true, .transient_local = true, .manual_liveliness = true}};
}  // namespace topics

}  // namespace eti::bus
