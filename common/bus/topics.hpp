// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "idl/eti_wire.hpp"

namespace eti::bus {

namespace msg = ::eti::msg;

/// Raised when a message or a topic changes so that older programs would misread it. Programs of different
/// protocols do not meet; self_check() says so, with both versions. New keys of a SessionDescription do not
/// count.
inline constexpr int protocol = 7;

/// The DDS partition of a session. Programs of another protocol would misread messages: they meet in another
/// partition. No session's name holds a slash.
[[nodiscard]] inline std::string partition_of(const std::string& session) {
    return session + '/' + std::to_string(protocol);
}

/// From whom samples of a topic are taken.
enum class Source : std::uint8_t {
    anybody,
    server,  ///< the participant that owns the session, alone
    first,   ///< one writer at a time: whoever was found first, until it falls silent or goes
};

/// How a topic travels.
struct Quality {
    bool reliable = false;
    bool transient_local = false;    ///< late joiners get the last sample of each key
    int depth = 1;                   ///< samples kept per key
    bool manual_liveliness = false;  ///< a hung loop shows within 300 ms
    Source from = Source::server;
};

template <class Message>
struct Topic {
    std::string_view name;
    Quality quality;
};

struct TopicSource {
    std::string_view name;
    Source from;
};

/// Every topic: X(name, message, members of Quality...). A new topic is a struct in eti.idl and a row here.
// Best effort with room for the chunks of a few states: keep last 1 would drop all but the last chunk.
#define ETI_TOPICS(X)                                                                     \
    X(session_description, SessionDescription, .reliable = true, .transient_local = true) \
    X(scene, SceneDescription, .reliable = true, .transient_local = true)                 \
    X(laryngoscope_pose, ToolPose, .from = Source::first)                                 \
    X(tube_pose, ToolPose, .from = Source::first)                                         \
    X(eye_pose, EyePose, .from = Source::first)                                           \
    X(proxy, ProxyState)                                                                  \
    X(tissue_contacts, TissueContacts)                                                    \
    X(tube_force, TubeForce)                                                              \
    X(deformation, DeformationState, .depth = 1024)                                       \
    X(deformation_slow, DeformationState, .depth = 1024)                                  \
    X(fluid, FluidState, .depth = 128)                                                    \
    X(particle_state, ParticleState, .depth = 1024)                                       \
    X(mesh_state, MeshState, .depth = 1024)                                               \
    X(command, Command, .reliable = true, .depth = 64, .from = Source::anybody)           \
    X(command_result, CommandResult, .reliable = true, .depth = 64)                       \
    X(annotation, Annotation, .reliable = true, .depth = 64, .from = Source::anybody)     \
    X(shown_annotation, ShownAnnotation, .reliable = true, .transient_local = true)       \
    X(live_metrics, LiveMetrics)                                                          \
    X(attempt_summary, AttemptSummary, .reliable = true, .transient_local = true)         \
    X(echo_question, Echo, .depth = 16, .from = Source::anybody)                          \
    X(echo_answer, Echo, .depth = 64, .from = Source::anybody)                            \
    X(session_status, SessionStatus, .reliable = true, .transient_local = true, .manual_liveliness = true)

namespace topics {
#define ETI_TOPIC(name, message, ...) inline constexpr Topic<msg::message> name{"eti/" #name, {__VA_ARGS__}};
ETI_TOPICS(ETI_TOPIC)
#undef ETI_TOPIC
#define ETI_TOPIC(topic, ...) {topics::topic.name, topics::topic.quality.from},
inline constexpr TopicSource all[] = {ETI_TOPICS(ETI_TOPIC)};
#undef ETI_TOPIC
}  // namespace topics

}  // namespace eti::bus
