// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "client/view/annotations.hpp"
#include "client/view/attempt_report.hpp"
#include "client/view/drop_log.hpp"
#include "client/view/liquid_detail.hpp"
#include "client/view/scene_object.hpp"
#include "client/view/skinned_surface.hpp"
#include "client/view/tube_sweep.hpp"
#include "common/bus/session_keys.hpp"
#include "common/mesh/skinning.hpp"
#include "common/model/landmark.hpp"
#include "common/model/live.hpp"
#include "idl/eti_wire.hpp"

namespace eti::view {

/// What arrived from the bus, put together: the scene's objects, their current shape and pose, and
/// the session's numbers. Every apply() checks its message first; one that cannot be right changes
/// nothing, is counted, and makes apply() return false. One thread uses it.
class SceneView {
  public:
    bool apply(const msg::SessionDescription& message);
    bool apply(const msg::SceneDescription& message);
    bool apply(const msg::DeformationState& message);
    bool apply(const msg::FluidState& message);
    bool apply(const msg::ProxyState& message);
    bool apply(const msg::LiveMetrics& message);
    bool apply(const msg::SessionStatus& message);
    bool apply(const msg::AttemptSummary& message);
    bool apply(const msg::ShownAnnotation& message);

    /// Brings frames, tube and liquid up to date with what arrived.
    void update();

    /// The session's description and all objects that the server announced have arrived.
    [[nodiscard]] bool complete() const;
    /// complete(), and where each frame is has been heard: from then on a picture shows the patient as it is.
    [[nodiscard]] bool shaped() const;

    /// As of the last update(). Shapes are computed when they are first asked for after it: what is drawn is
    /// skinned elsewhere, from frame_maps().
    [[nodiscard]] const std::map<std::string, SkinnedSurface>& surfaces() const;
    /// A surface as it was described, or nullptr.
    [[nodiscard]] const RestSurface* rest_surface(const std::string& name) const;
    [[nodiscard]] const std::optional<ToolMesh>& laryngoscope() const { return laryngoscope_; }
    [[nodiscard]] const std::optional<RigidTransform>& laryngoscope_pose() const {
        return laryngoscope_pose_;
    }
    /// The tube once its course is known, else null.
    [[nodiscard]] const TubeSweep* tube() const;
    [[nodiscard]] std::span<const Vec3f> tube_nodes() const { return tube_nodes_; }
    /// Liquid particles [m] as of the last update(), none while there are no secretions.
    [[nodiscard]] std::span<const Vec3f> liquid() const { return liquid_; }
    [[nodiscard]] float liquid_spacing() const { return liquid_spacing_; }  ///< [m], of particles at rest
    /// Foam and threads of the liquid, as of the last state that arrived whole.
    [[nodiscard]] const LiquidDetail& liquid_detail() const { return liquid_detail_; }
    [[nodiscard]] LiquidKind liquid_kind() const { return keys_ ? keys_->liquid() : LiquidKind::saliva; }
    /// Another whenever liquid() is.
    [[nodiscard]] std::uint64_t liquid_revision() const { return liquid_revision_; }
    /// Newest landmarks; those of the rest posture until live ones come.
    [[nodiscard]] const Landmarks& landmarks() const { return landmarks_; }

    /// Of the description; zeros before.
    [[nodiscard]] const Landmarks& rest_landmarks() const { return rest_landmarks_; }

    /// Once the session has described itself; until then there is no scene.
    [[nodiscard]] const std::optional<bus::SessionKeys>& keys() const { return keys_; }
    [[nodiscard]] const std::optional<msg::SessionDescription>& description() const { return description_; }

    [[nodiscard]] const std::optional<msg::LiveMetrics>& metrics() const { return metrics_; }
    /// What commands change, as the server last said, or as the session begins; NaN for what it does not say.
    [[nodiscard]] const LiveValues& live() const { return live_; }
    /// The session asks for the enhanced view.
    [[nodiscard]] bool enhanced() const { return live_.view_enhanced > 0.5f; }
    /// The session asks for an aid, by itself or with all of the enhanced view.
    [[nodiscard]] bool shows(float LiveValues::*aid) const { return enhanced() || live_.*aid > 0.5f; }
    /// Where the blade presses on the upper gum [m], by the newest contacts; nothing while it does not.
    [[nodiscard]] const std::optional<Vec3f>& gum_contact() const { return gum_contact_; }
    /// Closed polygon around the glottic opening [m]; empty before metrics came.
    [[nodiscard]] std::span<const Vec3f> glottis_contour() const { return glottis_contour_; }
    /// The trainee's eye in the patient frame, as the server last heard of it; nothing while nobody says.
    [[nodiscard]] const std::optional<RigidTransform>& trainees_eye() const { return trainees_eye_; }
    /// What instructors and observers wrote, point at and drew.
    [[nodiscard]] const Annotations& annotations() const { return annotations_; }
    [[nodiscard]] const std::optional<msg::SessionStatus>& status() const { return status_; }
    /// How the newest attempt of this run ended.
    [[nodiscard]] const std::optional<AttemptReport>& attempt_report() const { return attempt_report_; }
    /// How the whole run ended, once it has.
    [[nodiscard]] const std::optional<AttemptReport>& run_report() const { return run_report_; }
    /// Newest simulation time [ns] seen on any topic of the scene's state.
    [[nodiscard]] std::uint64_t simulation_time_ns() const { return simulation_time_ns_; }
    /// Another whenever an object of the scene was added or replaced.
    [[nodiscard]] std::uint64_t scene_revision() const { return scene_revision_; }
    [[nodiscard]] std::uint64_t dropped() const { return drops_.count(); }
    [[nodiscard]] std::span<const FramePose> frames() const { return frames_; }
    /// What the frames do to rest points, as of the last update().
    [[nodiscard]] std::span<const FrameMap> frame_maps() const { return maps_; }
    /// Another whenever frame_maps() are.
    [[nodiscard]] std::uint64_t frames_revision() const { return frames_revision_; }

  private:
    /// A part of the liquid, and when it was so.
    struct LiquidChunk {
        std::uint64_t time_ns = 0;
        std::vector<Vec3f> positions;
    };

    bool refuse(const char* topic, const std::string& why);
    void keep(const std::string& name, RestFrames&& object);
    void keep(const std::string& name, RestSurface&& object);
    void keep(const std::string& name, ToolMesh&& object);
    void clear_scene();
    void note_time(std::uint64_t time_ns);
    void advance_liquid();

    std::optional<bus::SessionKeys> keys_;
    std::optional<msg::SessionDescription> description_;
    std::map<std::string, msg::ObjectKind> arrived_;
    std::uint32_t object_count_ = 0;
    std::uint64_t scene_revision_ = 0;

    std::vector<Vec3f> rest_centres_;
    std::vector<FramePose> frames_;
    std::vector<FramePose> decoded_;  ///< of the message at hand; empty in between
    std::vector<FrameMap> maps_;
    std::vector<std::uint8_t> moved_;           ///< since the last update()
    std::vector<std::uint64_t> frame_time_ns_;  ///< of the newest update of each frame
    std::vector<std::uint8_t> heard_;           ///< by frame: whether any update has arrived
    std::size_t heard_count_ = 0;
    bool any_moved_ = false;
    std::uint64_t frames_revision_ = 0;

    // Shapes follow when they are asked for.
    mutable std::map<std::string, SkinnedSurface> surfaces_;
    mutable std::vector<std::uint8_t> unskinned_;  ///< by frame: moved since shapes were last computed
    mutable bool any_unskinned_ = false;
    std::optional<ToolMesh> laryngoscope_;
    std::optional<RigidTransform> laryngoscope_pose_;
    std::optional<TubeSweep> tube_;
    std::vector<Vec3f> tube_nodes_;
    std::uint64_t tube_time_ns_ = 0;
    bool tube_moved_ = false;
    std::vector<LiquidChunk> liquid_chunks_;
    std::uint64_t liquid_time_ns_ = 0;
    std::vector<Vec3f> arriving_, whole_;
    std::vector<Vec3f> liquid_;
    float liquid_spacing_ = 0.0f;
    std::uint64_t liquid_revision_ = 0;
    bool liquid_moved_ = false;
    LiquidDetail liquid_detail_;
    Landmarks landmarks_ = unseen_landmarks();
    Landmarks rest_landmarks_ = unseen_landmarks();
    bool live_landmarks_ = false;

    std::optional<Vec3f> gum_contact_;
    std::optional<RigidTransform> trainees_eye_;
    Annotations annotations_;
    std::vector<Vec3f> glottis_contour_;
    std::optional<msg::LiveMetrics> metrics_;
    LiveValues live_;
    std::optional<msg::SessionStatus> status_;
    std::optional<AttemptReport> attempt_report_;
    std::optional<AttemptReport> run_report_;
    std::uint64_t simulation_time_ns_ = 0;
    DropLog drops_;
};

}  // namespace eti::view
