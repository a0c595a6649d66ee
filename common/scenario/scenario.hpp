// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/model/liquid_kind.hpp"
#include "common/model/newborn_shape.hpp"
#include "common/model/runtime_parameters.hpp"
#include "common/model/tissue.hpp"
#include "common/model/tools/tools.hpp"
#include "common/scenario/data_file.hpp"

namespace eti {

/// A training scenario as read from YAML; angles in radians, lengths in metres.
struct Scenario {
    std::string name;
    std::string description;
    std::string debriefing;        ///< what to discuss after the session
    std::string text;              ///< the file as read, for the session record
    std::filesystem::path folder;  ///< of that file; other file names in it are relative to this

    struct Patient {
        NewbornShape shape;
        std::filesystem::path model;  ///< a model built by eti-anatomy, used instead of `shape`; empty: none
    } patient;
    RuntimeParameters runtime_parameters;  ///< at the start; a built model overrides the stiffness

    /// How firmly an assistant's hands hold what is commanded, of bones that yield; 0: they do not.
    struct Assistant {
        float hand_on_jaw = 1.0f;   ///< [N m/rad], holds the mouth open
        float hand_on_head = 0.5f;  ///< [N m/rad], a roll or a hand that holds the head back
    } assistant;

    Blade blade = Blade::miller_1;
    Tube tube;

    struct Physics {
        int substeps =
            8;  ///< per 1/180 s step; cost grows linearly, error of contact forces falls quadratically
        float spacing = 2.0e-3f;       ///< [m], particles in the bulk; cost grows with its -3rd power
        float fine_spacing = 1.0e-3f;  ///< [m], particles at epiglottis and larynx
        TissueMethod tissue_method = TissueMethod::implicit;
        float region = 7e-3f;       ///< [m], tissue farther than this from the airway moves with the bones
        bool bones_yield = true;    ///< head, mandible and hyoid, with an implicit mesh
        bool relaxation = true;     ///< of the stress in tongue and epiglottis, with an implicit mesh
        bool self_contact = false;  ///< contact between tissue and tissue
        bool sleep = true;          ///< tissue at rest is not simulated until something moves it
    } physics;

    bool saliva = false;                     ///< secretions are possible
    bool saliva_standby = false;             ///< with saliva: none until someone switches them on
    LiquidKind liquid = LiquidKind::saliva;  ///< kind of secretions
    bool manikin = false;  ///< a real manikin replaces the patient; only the poses of the tools are simulated
    float time_limit = 30.0f;      ///< [s], per attempt
    bool vital_signs = false;      ///< simulates saturation and heart rate
    float inspired_oxygen = 0.3f;  ///< fraction, ventilated between the attempts
    bool freeze_on_silence =
        false;  ///< pauses simulation time while a connected device is silent; else time continues
    std::uint64_t seed = 1;
};

/// Reads and validates a scenario. Throws InputError instead of returning a partial one.
[[nodiscard]] Scenario load_scenario(const std::filesystem::path& file);

/// The same from text. `file` is only used in errors, and gives the name where the text has none.
[[nodiscard]] Scenario parse_scenario(const std::string& text, const std::filesystem::path& file);

/// The scenario of a running or recorded session, as what shows the session needs it: the defaults where this
/// version cannot read its text.
[[nodiscard]] Scenario shown_scenario(const std::string& text);

/// The keys beside those of shape_fields, tube_fields and runtime_parameter_fields.
[[nodiscard]] std::vector<KeyDescription> describe_scenario();

}  // namespace eti
