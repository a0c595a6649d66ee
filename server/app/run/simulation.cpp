// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/run/simulation.hpp"

#include <fmt/format.h>

#include "common/hdf5/handle.hpp"
#include "common/model/tools/parked_pose.hpp"
#include "server/app/run/patient_cache.hpp"
#include "server/patient/newborn/from_scenario.hpp"

namespace eti::app {

namespace {

/// Physiology of the newborn if vital signs are simulated. A built model provides its weight only.
std::optional<physiology::Physiology> physiology_of(const Scenario& scenario,
                                                    const patient::Patient& patient) {
    if (!scenario.vital_signs) {
        return std::nullopt;
    }
    const float weeks = scenario.patient.model.empty() ? scenario.patient.shape.gestational_age
                                                       : median_gestational_age(patient.weight);
    return physiology::newborn_physiology(static_cast<double>(patient.weight), static_cast<double>(weeks),
                                          static_cast<double>(scenario.inspired_oxygen));
}

scene::Settings scene_settings(const Scenario& scenario) {
    const PatientLimits limits = limits_of(scenario);
    return {.substeps = scenario.physics.substeps,
            .tissue_method = scenario.physics.tissue_method,
            .head_scale = limits.head_scale,
            .tongue_scale = limits.tongue_scale,
            .rigid = {},
            .bones_yield = scenario.physics.bones_yield,
            .joints = {.hand_on_jaw = scenario.assistant.hand_on_jaw,
                       .hand_on_head = scenario.assistant.hand_on_head},
            .relaxation = scenario.physics.relaxation,
            .self_contact = scenario.physics.self_contact,
            .sleep = scenario.physics.sleep,
            .saliva = scenario.saliva,
            .liquid = scenario.liquid,
            .dry_start = scenario.saliva_standby,
            .seed = scenario.seed,
            .manikin = scenario.manikin};
}

}  // namespace

PatientLimits limits_of(const Scenario& scenario) {
    PatientLimits limits;
    limits.saliva = scenario.saliva;
    limits.bones_yield = scenario.physics.bones_yield && !scenario.manikin;
    // A model file's own sizes count as 1.
    const NewbornShape built = scenario.patient.model.empty() ? scenario.patient.shape : NewbornShape();
    limits.head_scale = built.head_scale;
    limits.tongue_scale = built.tongue_scale;
    return limits;
}

scene::Inputs parked_inputs(const Scenario& scenario, const patient::Patient& patient) {
    scene::Inputs inputs;
    inputs.laryngoscope = parked_pose(Tool::laryngoscope);
    inputs.tube_grip = parked_pose(Tool::tube);
    inputs.runtime_parameters = scenario.runtime_parameters;
    inputs.runtime_parameters.tissue_stiffness = patient.tissue_stiffness;
    return inputs;
}

patient::Patient patient_of(const Scenario& scenario) {
    if (!scenario.patient.model.empty()) {
        try {
            return patient::load_patient(scenario.patient.model);
        } catch (const hdf5::Error& error) {
            throw InputError(
                fmt::format("scenario '{}', key 'patient.model': {}", scenario.name, error.what()));
        }
    }
    return cached_patient(scenario.patient.shape, patient::settings_of(scenario));
}

Assessor::Assessor(const patient::Patient& patient, const Laryngoscope& scope, const Scenario& scenario)
    : manikin_(scenario.manikin), viewer_(patient, scope, {.tube_radius = scenario.tube.outer_radius()}) {
    metrics_.begin(patient, scope, static_cast<double>(scenario.time_limit), physiology_of(scenario, patient),
                   manikin_ ? metrics::PatientKind::manikin : metrics::PatientKind::newborn);
}

void Assessor::observe(const scene::Snapshot& snapshot, const std::optional<Vec3f>& eye) {
    due_ = snapshot.step % steps_per_view_check == 0;
    if (due_ && !manikin_) {
        eye_ = eye ? *eye : best_eye(snapshot.landmarks);
        view_ = viewer_.evaluate(snapshot, eye_);
    }
    metrics_.observe(snapshot, view_);
}

Simulation::Simulation(const Scenario& scenario, const patient::Patient& patient, const scene::Inputs& start)
    : scope_(make_laryngoscope(scenario.blade)),
      scene_(patient, scope_, scenario.tube, start, scene_settings(scenario)),
      assessor_(patient, scope_, scenario),
      tube_depth_rule_(static_cast<float>(tube_depth_by_weight(static_cast<double>(patient.weight)))) {}

void Simulation::step(const scene::Inputs& inputs, const std::optional<Vec3f>& eye) {
    scene_.step(inputs);
    assessor_.observe(snapshot(), eye);
}

double Simulation::time() const {
    return static_cast<double>(snapshot().time_ns) * 1e-9;
}

Observation Simulation::observation() const {
    const scene::Snapshot& s = snapshot();
    const metrics::LiveMetrics& live = metrics().live();
    return {time(),
            s.landmarks,
            live.measures.glottic_opening_percent,
            s.tube_nodes.empty() ? Vec3f(Vec3f::Zero()) : s.tube_nodes.back(),
            live.measures.tube_depth_past_glottis,
            s.proxy,
            tube_depth_rule_};
}

}  // namespace eti::app
