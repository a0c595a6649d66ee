// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <vector>

#include "common/scenario/scenario.hpp"
#include "server/patient/model/patient.hpp"
#include "server/scene/scene.hpp"

namespace eti::bench {

/// A path of the laryngoscope, by step. Every model is judged on the same one: an operator who lifts until he
/// sees compares different lifts.
using LiftPath = std::vector<RigidTransform>;

/// The shipped expert's lift in this scenario, to the best view.
[[nodiscard]] LiftPath record_lift(const Scenario& scenario, const patient::Patient& patient);

/// Text of one pose in six steps: `time_s,x,y,z,qw,qx,qy,qz`, in metres in the patient frame.
void write_path(const LiftPath& path, const std::filesystem::path& file);
/// Reads it, interpolating linearly between poses, and lets the blade rest at its end.
[[nodiscard]] LiftPath read_path(const std::filesystem::path& file);

}  // namespace eti::bench
