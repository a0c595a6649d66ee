// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/model/liquid_kind.hpp"
#include "common/model/live.hpp"
#include "common/model/newborn_shape.hpp"
#include "common/model/tissue.hpp"
#include "common/model/tools.hpp"

namespace eti {

/// A training scenario as read from YAML; angles in radians, lengths in metres, as everywhere inside.
struct Scenario {
    std::string name;
    std::string description;
    std::string text;              ///< the file as read, for the session record
    std::filesystem::path folder;  ///< of that file; names of other files in it start here

    struct Patient {
        NewbornShape shape;
        std::filesystem::path model;  ///< a model that eti-anatomy built, instead of `shape`; empty: none
    } patient;
    LiveValues live;  ///< at the start; a built model has a stiffness of its own instead

    Blade blade = Blade::miller_1;
    Tube tube;

    struct Physics {
        int substeps =
            8;  ///< per 1/180 s step; cost grows linearly, error of contact forces falls quadratically
        float spacing = 2.0e-3f;       ///< [m], particles in the bulk; cost grows with its -3rd power
        float fine_spacing = 1.0e-3f;  ///< [m], particles at epiglottis and larynx
        TissueMethod tissue_method = TissueMethod::implicit;
        float region = 7e-3f;       ///< [m], tissue farther than this from the airway moves with the bones
        bool self_contact = false;  ///< whether tissue also meets tissue
        bool sleep = true;          ///< whether tissue at rest is left alone until something moves it
    } physics;

    bool saliva = false;                     ///< whether there may be secretions
    bool saliva_standby = false;             ///< with saliva: none before someone switches them on
    LiquidKind liquid = LiquidKind::saliva;  ///< what the secretions are
    bool manikin = false;  ///< a real one takes the patient's place; only where the tools are is simulated
    float time_limit = 30.0f;      ///< [s], per attempt
    bool vital_signs = false;      ///< whether saturation and heart rate are simulated
    float inspired_oxygen = 0.3f;  ///< share, of what the newborn is ventilated with beside the attempts
    bool freeze_on_silence =
        false;  ///< time stands still while a device that was there is silent; else it goes on
    std::uint64_t seed = 1;
};

/// A mistake in a file that a user wrote: says file, line, key, what was found, what was expected.
class InputError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// Names that find_data_file() knows of a `kind`, sorted.
[[nodiscard]] std::vector<std::string> data_names(const std::string& kind);

/// Resolves a scenario, operator or preset by name (a file `NAME.yaml` in the data folder's `kind` folder)
/// or by path. Throws InputError naming the places searched and the names there are.
[[nodiscard]] std::filesystem::path find_data_file(const std::string& name_or_path, const std::string& kind);

/// Reads and validates a scenario. Throws InputError; nothing is half-configured.
[[nodiscard]] Scenario load_scenario(const std::filesystem::path& file);

/// The same from text; `file` is only named in errors, and gives the name where the text has none.
[[nodiscard]] Scenario parse_scenario(const std::string& text, const std::filesystem::path& file);

}  // namespace eti
