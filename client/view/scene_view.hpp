// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "client/view/annotations.hpp"
#include "client/view/liquid/liquid_detail.hpp"
#include "client/view/skinned_surface.hpp"
#include "client/view/tube_sweep.hpp"
#include "common/bus/codec/attempt_report.hpp"
#include "common/bus/codec/scene_object.hpp"
#include "common/bus/security/session_keys.hpp"
#include "common/mesh/skinning.hpp"
#include "common/model/landmark.hpp"
#include "common/model/runtime_parameters.hpp"
#include "common/scenario/scenario.hpp"
#include "idl/eti_wire.hpp"

namespace eti::view {

/// State assembled from the bus: the scene's objects, their current shapes and poses, and the session's
/// metrics. Every apply() validates its message first; an invalid one changes nothing, is counted, and
/// makes apply() return false. Single-threaded.
class SceneView {
  public:
    /// Time this far [ns] behind the newest is not a late datagram: the session restarted.
    static constexpr std::uint64_t restart_gap_ns = 1'000'000'000;

    bool apply(const msg::SessionDescription& message);
    bool apply(const msg::SceneDescription& message);
    bool apply(const msg::DeformationState& message);
    bool apply(const msg::FluidState& message);
    bool apply(const msg::ProxyState& message);
    bool apply(const msg::LiveMetrics& message);
    bool apply(const msg::SessionStatus& message);
    bool apply(const msg::AttemptSummary& message);
    bool apply(const msg::ShownAnnotation& message);

    /// Updates frames, tube and liquid from the messages received.
    void update();

    /// Whether the session's description and all announced objects have arrived.
    [[nodiscard]] bool complete() const;
    /// complete(), and the pose of every frame has been received: from then on pictures show the patient's
    /// actual posture.
    [[nodiscard]] bool has_all_frames() const;

    /// As of the last update(). Shapes are computed on demand; rendering skins on the GPU from frame_maps()
    /// instead.
    [[nodiscard]] const std::map<std::string, SkinnedSurface>& surfaces() const;
    /// A surface as described, or nullptr.
    [[nodiscard]] const bus::RestSurface* rest_surface(const std::string& name) const;
    [[nodiscard]] const std::optional<TriangleMesh>& laryngoscope() const { return laryngoscope_; }
    [[nodiscard]] const std::optional<RigidTransform>& laryngoscope_pose() const {
        return laryngoscope_pose_;
    }
    /// The tube once its nodes are known, else null.
    [[nodiscard]] const TubeSweep* tube() const;
    [[nodiscard]] std::span<const Vec3f> tube_nodes() const { return tube_nodes_; }
    /// Liquid particles [m] as of the last update(), empty without secretions.
    [[nodiscard]] std::span<const Vec3f> liquid() const { return liquid_; }
    [[nodiscard]] float liquid_spacing() const { return liquid_spacing_; }  ///< [m], of particles at rest
    /// Foam and filaments of the liquid, as of the last complete state.
    [[nodiscard]] const LiquidDetail& liquid_detail() const { return liquid_detail_; }
    [[nodiscard]] LiquidKind liquid_kind() const { return keys_ ? keys_->liquid() : LiquidKind::saliva; }
    /// Revision counter; changes with liquid().
    [[nodiscard]] std::uint64_t liquid_revision() const { return liquid_revision_; }
    /// Newest landmarks; those of the rest posture until the first metrics arrive.
    [[nodiscard]] const Landmarks& landmarks() const { return landmarks_; }

    /// From the description; zeros before it arrives.
    [[nodiscard]] const Landmarks& rest_landmarks() const { return rest_landmarks_; }

    /// Set once the session's description has arrived; there is no scene before.
    [[nodiscard]] const std::optional<bus::SessionKeys>& keys() const { return keys_; }
    [[nodiscard]] const std::optional<msg::SessionDescription>& description() const { return description_; }
    /// The session's scenario; defaults until its description has arrived.
    [[nodiscard]] const Scenario& scenario() const { return scenario_; }

    [[nodiscard]] const std::optional<msg::LiveMetrics>& metrics() const { return metrics_; }
    /// NaN for measures that the server does not publish.
    [[nodiscard]] const LiveMeasures& measures() const { return measures_; }
    /// Runtime parameters as last published, or initially as described; NaN if not published.
    [[nodiscard]] const RuntimeParameters& live() const { return live_; }
    /// Whether the session requests the enhanced view.
    [[nodiscard]] bool enhanced() const { return live_.view_enhanced > 0.5f; }
    /// Whether the session requests an aid, individually or as part of the enhanced view.
    [[nodiscard]] bool shows(float RuntimeParameters::*aid) const { return enhanced() || live_.*aid > 0.5f; }
    /// Contact point of the blade on the upper gum [m], from the newest contacts; nullopt without contact.
    [[nodiscard]] const std::optional<Vec3f>& gum_contact() const { return gum_contact_; }
    /// Closed polygon around the glottic opening [m]; empty before metrics arrive.
    [[nodiscard]] std::span<const Vec3f> glottis_contour() const { return glottis_contour_; }
    /// The trainee's eye in the patient frame, as last published by the server; nullopt while unknown.
    [[nodiscard]] const std::optional<RigidTransform>& trainee_eye() const { return trainee_eye_; }
    /// Notes, pointers and drawings of instructors and observers.
    [[nodiscard]] const Annotations& annotations() const { return annotations_; }
    [[nodiscard]] const std::optional<msg::SessionStatus>& status() const { return status_; }
    /// Outcome of the newest attempt of this run.
    [[nodiscard]] const std::optional<bus::AttemptReport>& attempt_report() const { return attempt_report_; }
    /// Outcome of the whole run, once it has ended.
    [[nodiscard]] const std::optional<bus::AttemptReport>& run_report() const { return run_report_; }
    /// Newest simulation time [ns] received on any topic of the scene's state.
    [[nodiscard]] std::uint64_t simulation_time_ns() const { return simulation_time_ns_; }
    /// Revision counter; changes whenever an object of the scene is added or replaced.
    [[nodiscard]] std::uint64_t scene_revision() const { return scene_revision_; }
    [[nodiscard]] std::uint64_t dropped() const { return dropped_; }
    [[nodiscard]] std::span<const FramePose> frames() const { return frames_; }
    /// Maps from rest to current positions by frame, as of the last update().
    [[nodiscard]] std::span<const FrameMap> frame_maps() const { return maps_; }
    /// Revision counter; changes with frame_maps().
    [[nodiscard]] std::uint64_t frames_revision() const { return frames_revision_; }

  private:
    /// A part of the liquid, with its time.
    struct LiquidChunk {
        std::uint64_t time_ns = 0;
        std::vector<Vec3f> positions;
    };

    /// Counts the message; logs at most once a second, so that no sender floods the log. Returns false.
    bool reject(const char* topic, const std::string& why);
    void keep(const std::string& name, std::vector<Vec3f>&& rest_centres);
    void keep(const std::string& name, bus::RestSurface&& object);
    void keep(const std::string& name, TriangleMesh&& object);
    void clear_scene();
    void note_time(std::uint64_t time_ns);
    void advance_liquid();

    std::optional<bus::SessionKeys> keys_;
    std::optional<msg::SessionDescription> description_;
    Scenario scenario_;
    std::map<std::string, msg::ObjectKind> arrived_;
    std::uint32_t object_count_ = 0;
    std::uint64_t scene_revision_ = 0;

    std::vector<Vec3f> rest_centres_;
    std::vector<FramePose> frames_;
    std::vector<FramePose> decoded_;  ///< from the current message; empty between messages
    std::vector<FrameMap> maps_;
    std::vector<std::uint8_t> moved_;           ///< since the last update()
    std::vector<std::uint64_t> frame_time_ns_;  ///< time of each frame's newest update
    std::vector<std::uint8_t> heard_;           ///< by frame: whether any update has arrived
    std::size_t heard_count_ = 0;
    bool any_moved_ = false;
    std::uint64_t frames_revision_ = 0;

    // Shapes are computed on demand.
    mutable std::map<std::string, SkinnedSurface> surfaces_;
    mutable std::vector<std::uint8_t> unskinned_;  ///< by frame: moved since shapes were last computed
    mutable bool any_unskinned_ = false;
    std::optional<TriangleMesh> laryngoscope_;
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
    Landmarks landmarks_ = zero_landmarks();
    Landmarks rest_landmarks_ = zero_landmarks();
    bool live_landmarks_ = false;

    std::optional<Vec3f> gum_contact_;
    std::optional<RigidTransform> trainee_eye_;
    Annotations annotations_;
    std::vector<Vec3f> glottis_contour_;
    std::optional<msg::LiveMetrics> metrics_;
    LiveMeasures measures_;
    RuntimeParameters live_;
    std::optional<msg::SessionStatus> status_;
    std::optional<bus::AttemptReport> attempt_report_;
    std::optional<bus::AttemptReport> run_report_;
    std::uint64_t simulation_time_ns_ = 0;
    std::uint64_t dropped_ = 0;
    std::chrono::steady_clock::time_point last_drop_line_{};
};

}  // namespace eti::view
