// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "idl/eti_wire.hpp"

namespace eti::bus {

namespace msg = ::eti::msg;

/// Incremented when a change of a message or topic would make older programs misread it. Programs of
/// different protocols do not match; self_check() reports both versions. New keys of a SessionDescription
/// need no increment.
inline constexpr int protocol = 8;

/// The DDS partition of a session. Programs of another protocol would misread messages, so they use another
/// partition. A session's name contains no slash.
[[nodiscard]] inline std::string partition_of(const std::string& session) {
    return session + '/' + std::to_string(protocol);
}

/// From which writers samples of a topic are accepted.
enum class WriterPolicy : std::uint8_t {
    any,
    server,     ///< the participant that owns the session, alone
    exclusive,  ///< one writer at a time: the first discovered, until it falls silent or leaves
};

/// QoS of a topic.
struct Qos {
    bool reliable = false;
    bool transient_local = false;    ///< late joiners receive the last sample of each key
    int depth = 1;                   ///< samples kept per key
    bool manual_liveliness = false;  ///< a hung loop is detected within 300 ms
    WriterPolicy from = WriterPolicy::server;
};

template <class Message>
struct Topic {
    std::string_view name;
    Qos qos;
};

struct TopicWriterPolicy {
    std::string_view name;
    WriterPolicy from;
};

/// Every topic: X(name, message, members of Qos...). A new topic is a struct in eti.idl and a row here.
// Best effort with room for the chunks of a few states: keep last 1 would drop all but the last chunk.
#define ETI_TOPICS(X)                                                                     \
    X(session_description, SessionDescription, .reliable = true, .transient_local = true) \
    X(scene, SceneDescription, .reliable = true, .transient_local = true)                 \
    X(laryngoscope_pose, ToolPose, .from = WriterPolicy::exclusive)                       \
    X(tube_pose, ToolPose, .from = WriterPolicy::exclusive)                               \
    X(eye_pose, EyePose, .from = WriterPolicy::exclusive)                                 \
    X(proxy, ProxyState)                                                                  \
    X(tissue_contacts, TissueContacts)                                                    \
    X(tube_force, TubeForce)                                                              \
    X(deformation, DeformationState, .depth = 1024)                                       \
    X(deformation_slow, DeformationState, .depth = 1024)                                  \
    X(fluid, FluidState, .depth = 128)                                                    \
    X(particle_state, ParticleState, .depth = 1024)                                       \
    X(mesh_state, MeshState, .depth = 1024)                                               \
    X(command, Command, .reliable = true, .depth = 64, .from = WriterPolicy::any)         \
    X(command_result, CommandResult, .reliable = true, .depth = 64)                       \
    X(annotation, Annotation, .reliable = true, .depth = 64, .from = WriterPolicy::any)   \
    X(shown_annotation, ShownAnnotation, .reliable = true, .transient_local = true)       \
    X(live_metrics, LiveMetrics)                                                          \
    X(attempt_summary, AttemptSummary, .reliable = true, .transient_local = true)         \
    X(echo_question, Echo, .depth = 16, .from = WriterPolicy::any)                        \
    X(echo_answer, Echo, .depth = 64, .from = WriterPolicy::any)                          \
    X(session_status, SessionStatus, .reliable = true, .transient_local = true, .manual_liveliness = true)

namespace topics {
#define ETI_TOPIC(name, message, ...) inline constexpr Topic<msg::message> name{"eti/" #name, {__VA_ARGS__}};
ETI_TOPICS(ETI_TOPIC)
#undef ETI_TOPIC
#define ETI_TOPIC(topic, ...) {topics::topic.name, topics::topic.qos.from},
inline constexpr TopicWriterPolicy all[] = {ETI_TOPICS(ETI_TOPIC)};
#undef ETI_TOPIC
}  // namespace topics

}  // namespace eti::bus
