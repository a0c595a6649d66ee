// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "common/math/transform.hpp"
#include "common/mesh/skinning.hpp"
#include "common/mesh/surface_place.hpp"
#include "common/mesh/triangle_mesh.hpp"
#include "common/model/landmark.hpp"
#include "common/model/live.hpp"
#include "common/model/parameters.hpp"
#include "common/model/surface.hpp"
#include "common/model/tissue.hpp"

namespace eti::session {

/// Names of further texts of a session, see SessionInfo::more.
inline constexpr const char* participant_text = "participant";  ///< pseudonym
inline constexpr const char* manikin_text = "manikin";          ///< there where tools went into one
inline constexpr const char* skill_text = "operator_skill";     ///< of a scripted operator, 0 to 1
// What bits depend on beside the build.
inline constexpr const char* processor_text = "processor";
inline constexpr const char* libraries_text = "libraries";
inline constexpr const char* patient_hash_text = "patient_hash";

/// What a session file says of the session as a whole.
struct SessionInfo {
    std::string session;        ///< name
    std::string start_time;     ///< UTC, ISO 8601
    std::string scenario;       ///< name
    std::string scenario_text;  ///< the file as read
    std::string operator_name;  ///< empty when people or other processes hold the tools
    std::string operator_text;
    std::string version;  ///< of the program that recorded
    std::string build;    ///< compiler, build type, instruction set: what bit-equality depends on
    std::uint64_t seed = 0;
    std::map<std::string, std::string> more;  ///< further texts, by name
};

/// A point that moves with the frames: a landmark, or a corner of the glottis (nameless).
struct PointRecord {
    std::string name;
    Vec3f rest = Vec3f::Zero();  ///< [m]
    SkinWeights skin;
};

inline constexpr float no_number = std::numeric_limits<float>::quiet_NaN();

/// A pose that did not arrive: every number is NaN.
[[nodiscard]] inline RigidTransform no_pose() {
    return {Quatf(no_number, no_number, no_number, no_number), Vec3f::Constant(no_number)};
}

/// What the session's parameters mean: docs/metrics.md in short, as it was when they were measured.
struct Definitions {
    struct Words {
        std::string key, unit, run, definition, aim;
    };
    struct Number {
        std::string name;
        double value = 0.0;
        std::string unit, meaning;
    };
    std::uint64_t version = 0;  ///< 0: the file does not say
    std::vector<Words> parameters;
    std::vector<Number> thresholds;
};

/// What does not change during a session, so that a replay needs neither server nor scenario.
struct SceneRecord {
    std::vector<Vec3f> frame_rest_centre;  ///< [m], bones, clusters, the head's
    std::vector<Surface> surfaces;
    std::vector<PointRecord> landmarks;
    std::vector<PointRecord> glottis_contour;
    std::string blade;
    TriangleMesh laryngoscope;         ///< tool frame
    float blade_length = no_number;    ///< [m], from the tool's origin to the tip along +z
    float tube_outer_diameter = 0.0f;  ///< [m]
    float tube_inner_diameter = 0.0f;  ///< [m]
    std::size_t tube_nodes = 0;        ///< points of the centre line in every step
    bool liquid = false;               ///< whether the session has secretions
    float weight = no_number;          ///< [kg], of the newborn
    Definitions definitions;
    /// Where the tools were before the first step; no_pose() in a file that does not say it.
    RigidTransform laryngoscope_start = no_pose(), tube_grip_start = no_pose();
};

/// The first so many tissues may be touched.
inline constexpr std::size_t touched_tissues = static_cast<std::size_t>(Tissue::vocal_cord);

/// What the blade meets of each tissue, by the tissue's number.
struct TissueLoads {
    std::array<float, touched_tissues> pressed{};             ///< [N], sum of the shell's normal forces
    std::array<std::array<float, 3>, touched_tissues> net{};  ///< [N], of its particles on the blade
    /// [m], mean of the contacts with shell and particles, weighted by force; NaN where there is none.
    std::array<std::array<float, 3>, touched_tissues> place{};
};

/// One simulation step. Patient frame, unless said otherwise.
struct StepRecord {
    std::uint64_t time_ns = 0;  ///< since the session began
    std::uint64_t step = 0;
    // Inputs, as latched.
    RigidTransform laryngoscope;  ///< the device
    RigidTransform tube_grip;
    RigidTransform eye = no_pose();  ///< of the trainee's client
    // Tools.
    RigidTransform proxy;                 ///< the laryngoscope as the shell stops it
    Vec3f shell_force = Vec3f::Zero();    ///< [N], on the proxy
    Vec3f shell_torque = Vec3f::Zero();   ///< [N m], about the proxy's origin
    Vec3f tissue_force = Vec3f::Zero();   ///< [N], on the blade
    Vec3f tissue_torque = Vec3f::Zero();  ///< [N m], about the proxy's origin
    std::vector<Vec3f> tube_nodes;        ///< [m], connector to tip
    LiveValues live;                      ///< what commands change, as it was in this step
    TissueLoads loads;                    ///< of the blade
    // What of the patient places and angles are told from.
    std::array<float, 4> skull_rotation{};                         ///< w x y z, from rest
    std::array<std::array<float, 3>, landmark_count> landmarks{};  ///< [m]
    // Metrics.
    std::uint32_t attempt = 0;  ///< 0 before the first
    bool attempt_running = false;
    float glottic_opening_percent = 0.0f;  ///< now in sight
    float gum_force_n = 0.0f;              ///< now
    float tube_depth_past_glottis = 0.0f;  ///< [m], negative before the cords
    std::array<float, 3> eye_used{};       ///< [m], where the glottis was last looked at from
    /// 1 where the last look saw it; looked for only where nothing of the opening was in sight.
    float epiglottis_in_sight = no_number;
    float oxygen_saturation = no_number;  ///< [%], where it is simulated
    float heart_rate = no_number;         ///< [1/min], likewise
    Parameters parameters;                ///< of the current attempt so far
};

/// A command as it was latched.
struct CommandRecord {
    std::uint64_t time_ns = 0;
    std::uint64_t step = 0;
    std::string kind;    ///< e.g. "jaw_opening"
    double value = 0.0;  ///< SI, as the command's kind says (idl/eti.idl)
    std::string sender;
    std::uint32_t id = 0;  ///< chosen by the sender
};

/// The simulation's state after a step, in one number: what the same inputs give again.
struct StateRecord {
    std::uint64_t time_ns = 0;
    std::uint64_t step = 0;
    std::string hash;  ///< 16 hexadecimal digits
};

/// Where the frames are that moved since the record before.
struct DeformationRecord {
    std::uint64_t time_ns = 0;
    std::vector<std::uint16_t> frame;
    std::vector<FramePose> pose;  ///< one per entry of `frame`
};

/// Where liquid is.
struct FluidRecord {
    std::uint64_t time_ns = 0;
    std::vector<Vec3f> position;  ///< [m], patient frame
};

/// Kinds of what people leave in a session: what they write, and what they do with marks.
inline constexpr std::string_view note_event = "note", annotation_event = "annotation";
/// The kind of "laryngoscope here", "tube silent", "tube back". The first of a tool says that it was put,
/// before the next step, where its device holds it.
inline constexpr std::string_view device_event = "device";

struct EventRecord {
    std::uint64_t time_ns = 0;
    std::string kind;  ///< one word: attempt, contact, error, command, ...
    std::string text;
};

/// What somebody pointed at or drew on a surface; what was written is an event.
struct AnnotationRecord {
    std::uint64_t time_ns = 0;
    std::string kind;  ///< point, stroke
    std::string sender;
    std::string text;
    std::string object;  ///< the surface, or "laryngoscope"
    std::vector<SurfacePlace> place;
    std::vector<Vec3f> position;  ///< [m], of each place at that time
};

/// Parameters and outcome of one attempt, or of the whole run (attempt 0); a later record of the
/// same attempt replaces an earlier one.
struct SummaryRecord {
    std::uint32_t attempt = 0;
    Outcome outcome;
    Parameters parameters;
    double began = std::numeric_limits<double>::quiet_NaN();  ///< [s], simulation time
    double ended = began;
};

}  // namespace eti::session
