// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/replay/recorded_states.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "server/app/output/recorder.hpp"
#include "server/metrics/airway_watch.hpp"
#include "server/scene/saliva.hpp"

namespace eti::app {

namespace {

constexpr std::size_t rows_per_place = 6;

/// Builds the patient from the scene in a file.
patient::Patient patient_in(const session::SceneRecord& scene, float weight) {
    patient::Patient patient;
    patient.weight = weight;
    patient.frame_rest_centre = scene.frame_rest_centre;
    patient.surfaces = scene.surfaces;
    for (const session::PointRecord& point : scene.landmarks) {
        if (const auto which = find_landmark(point.name)) {
            patient.landmarks[static_cast<std::size_t>(*which)] = {point.rest, point.skin};
        }
    }
    for (const session::PointRecord& point : scene.glottis_contour) {
        patient.glottis_contour.push_back({point.rest, point.skin});
    }
    return patient;
}

/// For a built model, derives the weight from the rule for the tube's depth, which is its only trace in the
/// file.
float weight_of(const Scenario& scenario, const session::StepRecord& step) {
    const auto by_rule = static_cast<float>(step.metrics.tube_depth_rule_cm - 6.0);
    return scenario.patient.model.empty() || !(by_rule > 0.0f) ? scenario.patient.shape.weight : by_rule;
}

FramePose interpolate(const FramePose& from, const FramePose& to, float share) {
    FramePose out;
    out.centre = from.centre + share * (to.centre - from.centre);
    const float sign = from.rotation.dot(to.rotation) < 0.0f ? -1.0f : 1.0f;
    out.rotation.coeffs() = (1.0f - share) * from.rotation.coeffs() + share * sign * to.rotation.coeffs();
    out.rotation.normalize();
    return out;
}

template <class Records>
auto latest_before(const Records& records, std::uint64_t time_ns) {
    return std::ranges::upper_bound(records, time_ns, {}, [](const auto& record) { return record.time_ns; });
}

}  // namespace

RecordedStates::RecordedStates(const Recording& recording, const Scenario& scenario)
    : recording_(recording),
      patient_(patient_in(recording.scene, weight_of(scenario, recording.steps.back()))) {
    if (patient_.frame_rest_centre.size() < patient::bone_count || patient_.surfaces.empty()) {
        throw InputError("the file contains no surfaces to show: its scene is lost");
    }
    const auto ordered = [](const auto& records) {
        return std::ranges::is_sorted(records, {}, [](const auto& record) { return record.time_ns; });
    };
    if (!ordered(recording.steps) || !ordered(recording.deformations) || !ordered(recording.fluids) ||
        !ordered(recording.events) || !ordered(recording.annotations)) {
        throw InputError("the file's times are not in order: it is damaged, see eti-review check");
    }
    for (const session::DeformationRecord& record : recording.deformations) {
        for (std::size_t k = 0; k < record.frame.size(); ++k) {
            if (record.frame[k] >= patient_.frame_rest_centre.size() ||
                !is_valid_pose({record.pose[k].rotation, record.pose[k].centre})) {
                throw InputError(
                    fmt::format("deformation at {:.3f} s: an invalid pose of frame {} of {}; the file is "
                                "damaged, see eti-review check",
                                1e-9 * static_cast<double>(record.time_ns), record.frame[k],
                                patient_.frame_rest_centre.size()));
            }
        }
    }
    snapshot_.glottis_contour.resize(patient_.glottis_contour.size());
    snapshot_.saliva.on = recording.reader.root().has("fluid");
    snapshot_.saliva.spacing = scene::saliva_spacing(patient_);
    find_tube_places();
}

void RecordedStates::find_tube_places() {
    metrics::AirwayWatch watch;
    for (std::size_t row = 0; row < size(); row += rows_per_place) {
        const scene::Snapshot& s = at(row);
        if (!s.tube_nodes.empty()) {
            (void)watch.update(s.tube_nodes.back(), metrics::airway_gates(s));
        }
        tube_places_.push_back(watch.place());
    }
}

void RecordedStates::seek(std::uint64_t time_ns) {
    const auto& records = recording_.deformations;
    if (from_.empty() || (next_record_ > 0 && records[next_record_ - 1].time_ns > time_ns)) {
        next_record_ = 0;
        from_.assign(patient_.frame_rest_centre.size(), {});
        for (std::size_t f = 0; f < from_.size(); ++f) {
            from_[f].centre = patient_.frame_rest_centre[f];
        }
    }
    for (; next_record_ < records.size() && records[next_record_].time_ns <= time_ns; ++next_record_) {
        const session::DeformationRecord& record = records[next_record_];
        for (std::size_t k = 0; k < record.frame.size(); ++k) {
            from_[record.frame[k]] = record.pose[k];
            from_[record.frame[k]].rotation.normalize();
        }
    }
}

void RecordedStates::fill_frames(std::uint64_t time_ns) {
    seek(time_ns);
    snapshot_.frames = from_;
    if (next_record_ == recording_.deformations.size()) {
        return;
    }
    const session::DeformationRecord& next = recording_.deformations[next_record_];
    if (next_record_ == 0) {
        return;
    }
    // Records without motion are omitted: motion towards the next record began at most one period before it.
    const std::uint64_t begin = std::max(recording_.deformations[next_record_ - 1].time_ns,
                                         next.time_ns - std::min(next.time_ns, deformation_period_ns));
    if (time_ns <= begin) {
        return;
    }
    const float share = static_cast<float>(time_ns - begin) / static_cast<float>(next.time_ns - begin);
    for (std::size_t k = 0; k < next.frame.size(); ++k) {
        snapshot_.frames[next.frame[k]] = interpolate(from_[next.frame[k]], next.pose[k], share);
    }
}

const scene::Snapshot& RecordedStates::at(std::size_t row) {
    const session::StepRecord& step = recording_.steps[row];
    scene::Snapshot& s = snapshot_;
    s.step = step.step;
    s.time_ns = step.time_ns;
    // Values lost according to a repair stay unchanged.
    if (is_valid_pose(step.laryngoscope)) {
        s.device = step.laryngoscope;
    }
    if (is_valid_pose(step.proxy)) {
        s.proxy = s.last_free = step.proxy;
    }
    if (is_valid_pose(step.tube_grip)) {
        s.tube_grip = step.tube_grip;
    }
    if (std::ranges::all_of(step.tube_nodes, [](const Vec3f& node) { return node.allFinite(); })) {
        s.tube_nodes = step.tube_nodes;
    }
    s.shell_force = step.shell_force;
    s.shell_torque = step.shell_torque;
    s.tissue_force = step.tissue_force;
    s.tissue_torque = step.tissue_torque;
    s.runtime_parameters = step.runtime_parameters;
    fill_frames(step.time_ns);
    const auto carried = [&](const patient::CarriedPoint& point) {
        return skin_point(point.rest, point.skin, patient_.frame_rest_centre, s.frames);
    };
    for (std::size_t i = 0; i < landmark_count; ++i) {
        s.landmarks[i] = carried(patient_.landmarks[i]);
    }
    for (std::size_t i = 0; i < s.glottis_contour.size(); ++i) {
        s.glottis_contour[i] = carried(patient_.glottis_contour[i]);
    }
    s.shell_contacts.clear();
    if (step.measures.gum_force_n > 0.0f) {
        constexpr auto gum = static_cast<std::size_t>(Tissue::upper_gum);
        const Vec3f met(step.loads.place[gum].data());
        const bool known = met.allFinite() && (step.loads.pressed[gum] > 0.0f ||
                                               Vec3f(step.loads.net[gum].data()).norm() > 0.0f);
        // In files of earlier versions the middle of the gum stands for the contact point.
        const Vec3f place = known ? met : eti::at(s.landmarks, Landmark::upper_gum);
        s.shell_contacts.push_back({place, Vec3f::UnitY(), step.measures.gum_force_n, Tissue::upper_gum});
    }
    s.saliva.positions.clear();
    if (const auto after = latest_before(recording_.fluids, step.time_ns);
        after != recording_.fluids.begin()) {
        s.saliva.positions = std::prev(after)->position;
        std::erase_if(s.saliva.positions, [](const Vec3f& place) { return !place.allFinite(); });
    }
    s.saliva.lower = s.saliva.upper = s.landmarks[0];
    for (const Vec3f& place : s.saliva.positions) {
        s.saliva.lower = s.saliva.lower.cwiseMin(place);
        s.saliva.upper = s.saliva.upper.cwiseMax(place);
    }
    return s;
}

const AttemptStatus& RecordedStates::status(std::size_t row) {
    const session::StepRecord& step = recording_.steps[row];
    status_.attempt = step.attempt;
    status_.attempt_running = step.attempt_running;
    status_.measures = step.measures;
    status_.tube_place = tube_places_[row / rows_per_place];
    status_.metrics = step.metrics;
    status_.eye = is_valid_pose(step.eye) ? std::optional(step.eye) : std::nullopt;
    status_.message.clear();
    for (auto event = latest_before(recording_.events, step.time_ns); event != recording_.events.begin();) {
        --event;
        if (event->kind == "attempt") {
            status_.message = event->text;
            break;
        }
    }
    return status_;
}

}  // namespace eti::app
