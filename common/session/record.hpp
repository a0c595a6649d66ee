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
#include "common/model/attempt_metrics.hpp"
#include "common/model/landmark.hpp"
#include "common/model/live_measures.hpp"
#include "common/model/runtime_parameters.hpp"
#include "common/model/surface.hpp"
#include "common/model/tissue.hpp"

namespace eti::session {

/// Names of further texts of a session, see SessionInfo::more.
inline constexpr const char* participant_text = "participant";  ///< pseudonym
inline constexpr const char* manikin_text = "manikin";          ///< present if a real manikin was used
inline constexpr const char* skill_text = "operator_skill";     ///< of a scripted operator, 0 to 1
inline constexpr const char* quality_text = "quality";          ///< of the simulation: full or reduced
// Bit-equality depends on these beside the build.
inline constexpr const char* processor_text = "processor";
inline constexpr const char* libraries_text = "libraries";
inline constexpr const char* physics_text = "physics";
inline constexpr const char* patient_hash_text = "patient_hash";

/// Metadata of a session.
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

    /// The further text of this name; empty if there is none.
    [[nodiscard]] std::string text(const std::string& name) const {
        const auto found = more.find(name);
        return found == more.end() ? std::string() : found->second;
    }
};

/// A point carried by the frames: a landmark, or a corner of the glottis (nameless).
struct PointRecord {
    std::string name;
    Vec3f rest = Vec3f::Zero();  ///< [m]
    SkinWeights skin;
};

inline constexpr float missing_number = std::numeric_limits<float>::quiet_NaN();

/// A pose that did not arrive: every number is NaN.
[[nodiscard]] inline RigidTransform missing_pose() {
    return {Quatf(missing_number, missing_number, missing_number, missing_number),
            Vec3f::Constant(missing_number)};
}

/// Definitions of the session's metrics at the time of recording: an extract of docs/metrics.md.
struct Definitions {
    struct Words {
        std::string key, unit, run, definition, aim;
    };
    struct Number {
        std::string name;
        double value = 0.0;
        std::string unit, meaning;
    };
    std::uint64_t version = 0;  ///< 0: not stated in the file
    std::vector<Words> metrics;
    std::vector<Number> thresholds;
};

/// The constants of a session, so that a replay needs neither server nor scenario.
struct SceneRecord {
    std::vector<Vec3f> frame_rest_centre;  ///< [m], bones, clusters, the head's
    std::vector<Surface> surfaces;
    std::vector<PointRecord> landmarks;
    std::vector<PointRecord> glottis_contour;
    std::string blade;
    TriangleMesh laryngoscope;            ///< tool frame
    float blade_length = missing_number;  ///< [m], from the tool's origin to the tip along +z
    float tube_outer_diameter = 0.0f;     ///< [m]
    float tube_inner_diameter = 0.0f;     ///< [m]
    std::size_t tube_nodes = 0;           ///< points of the centre line in every step
    bool liquid = false;                  ///< whether the session has secretions
    float weight = missing_number;        ///< [kg], of the newborn
    Definitions definitions;
    /// Tool poses before the first step; missing_pose() if the file does not contain them.
    RigidTransform laryngoscope_start = missing_pose(), tube_grip_start = missing_pose();
};

/// Tissues below this number can be touched.
inline constexpr std::size_t touched_tissues = static_cast<std::size_t>(Tissue::vocal_cord);

/// Contact loads of the blade on each tissue, by tissue number.
struct TissueLoads {
    std::array<float, touched_tissues> pressed{};             ///< [N], sum of the shell's normal forces
    std::array<std::array<float, 3>, touched_tissues> net{};  ///< [N], of its particles on the blade
    /// [m], force-weighted mean position of the contacts with shell and particles; NaN where there is none.
    std::array<std::array<float, 3>, touched_tissues> place{};
};

/// One simulation step. Patient frame, unless said otherwise.
struct StepRecord {
    std::uint64_t time_ns = 0;  ///< since the session began
    std::uint64_t step = 0;
    // Inputs, as latched.
    RigidTransform laryngoscope;  ///< the device
    RigidTransform tube_grip;
    RigidTransform eye = missing_pose();  ///< of the trainee's client
    // Tools.
    RigidTransform proxy;                  ///< the laryngoscope as constrained by the shell
    Vec3f shell_force = Vec3f::Zero();     ///< [N], on the proxy
    Vec3f shell_torque = Vec3f::Zero();    ///< [N m], about the proxy's origin
    Vec3f tissue_force = Vec3f::Zero();    ///< [N], on the blade
    Vec3f tissue_torque = Vec3f::Zero();   ///< [N m], about the proxy's origin
    std::vector<Vec3f> tube_nodes;         ///< [m], connector to tip
    RuntimeParameters runtime_parameters;  ///< current values in this step
    TissueLoads loads;                     ///< of the blade
    // Patient state from which positions and angles are computed.
    std::array<float, 4> skull_rotation{};                         ///< w x y z, from rest
    std::array<std::array<float, 3>, landmark_count> landmarks{};  ///< [m]
    // Metrics.
    std::uint32_t attempt = 0;  ///< 0 before the first
    bool attempt_running = false;
    LiveMeasures measures;
    std::array<float, 3> eye_used{};  ///< [m], eye position at the last view of the glottis
    AttemptMetrics metrics;           ///< of the current attempt so far
};

/// A command as it was latched.
struct CommandRecord {
    std::uint64_t time_ns = 0;
    std::uint64_t step = 0;
    std::string kind;    ///< e.g. "jaw_opening"
    double value = 0.0;  ///< SI, as the command's kind defines (idl/eti.idl)
    std::string sender;
    std::uint32_t id = 0;  ///< chosen by the sender
};

/// Hash of the simulation's state after a step; the same inputs reproduce it.
struct StateRecord {
    std::uint64_t time_ns = 0;
    std::uint64_t step = 0;
    std::string hash;  ///< 16 hexadecimal digits
};

/// Poses of the frames that moved since the previous record.
struct DeformationRecord {
    std::uint64_t time_ns = 0;
    std::vector<std::uint16_t> frame;
    std::vector<FramePose> pose;  ///< one per entry of `frame`
};

/// Positions of the liquid.
struct FluidRecord {
    std::uint64_t time_ns = 0;
    std::vector<Vec3f> position;  ///< [m], patient frame
};

/// Event kinds of what people add to a session: notes, and actions on annotations.
inline constexpr std::string_view note_event = "note", annotation_event = "annotation";
/// Event kind of "laryngoscope here", "tube silent", "tube back". The first event of a tool means that the
/// tool was placed, before the next step, where its device holds it.
inline constexpr std::string_view device_event = "device";

struct EventRecord {
    std::uint64_t time_ns = 0;
    std::string kind;  ///< one word: attempt, contact, error, command, ...
    std::string text;
};

/// What a person pointed at or drew on a surface; written notes are events.
struct AnnotationRecord {
    std::uint64_t time_ns = 0;
    std::string kind;  ///< point, stroke
    std::string sender;
    std::string text;
    std::string object;  ///< the surface, or "laryngoscope"
    std::vector<SurfacePlace> place;
    std::vector<Vec3f> position;  ///< [m], of each place at that time
};

/// Metrics and outcome of one attempt, or of the whole run (attempt 0); a later record of the same attempt
/// replaces an earlier one.
struct SummaryRecord {
    std::uint32_t attempt = 0;
    Outcome outcome;
    AttemptMetrics metrics;
    double began = std::numeric_limits<double>::quiet_NaN();  ///< [s], simulation time
    double ended = began;
};

}  // namespace eti::session
