// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/scenario/scenario.hpp"

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <array>

#include "common/math/units.hpp"
#include "common/process/escaped.hpp"
#include "common/process/files/file_kind.hpp"
#include "common/scenario/yaml_map.hpp"

namespace eti {

namespace {

/// Names of earlier versions, `hexahedra` and `tetrahedra`, are read as implicit.
TissueMethod tissue_method_of(YamlMap& physics, TissueMethod fallback) {
    static constexpr std::array<std::string_view, 4> names = {"clusters", "implicit", "hexahedra",
                                                              "tetrahedra"};
    const std::size_t named = physics.choice(
        "tissue_method", static_cast<std::size_t>(fallback), names,
        "How soft tissue is computed. `implicit`: tongue and epiglottis as one mesh of nearly incompressible "
        "hexahedra with a converged implicit step, all else by shape matching. `clusters`: everything by "
        "shape matching, which lets the tongue be squeezed and holds bones fixed. `hexahedra` and "
        "`tetrahedra`, of earlier versions, are read as `implicit`");
    if (named < tissue_method_names.size()) {
        return static_cast<TissueMethod>(named);
    }
    if (names[named] == "tetrahedra") {
        spdlog::warn("physics.tissue_method: 'tetrahedra' (XPBD) no longer exists; using 'implicit'");
    }
    return TissueMethod::implicit;
}

/// The rows of a table that belong to `section`.
template <class Rows, class Values>
void read_fields(YamlMap& map, std::string_view section, const Rows& rows, Values& values) {
    for (const auto& field : rows) {
        if (field.section != section) {
            continue;
        }
        const std::string key = field.key_in_section();
        float& value = values.*field.value;
        if constexpr (requires { field.on_off; }) {
            if (field.on_off) {
                value = map.flag(key, value != 0.0f) ? 1.0f : 0.0f;
                continue;
            }
        }
        value = map.number(key, value, {field.low, field.high, field.per_unit});
    }
}

/// The kind that a key names.
template <class Kind>
void choose(YamlMap& map, const std::string& key, Kind& kind, std::span<const std::string_view> names,
            std::string_view help) {
    kind = static_cast<Kind>(map.choice(key, static_cast<std::size_t>(kind), names, help));
}

void read_shape(YamlMap& patient, NewbornShape& shape) {
    AirwayVariant variant = AirwayVariant::normal;
    choose(patient, "variant", variant, airway_variant_names,
           "Preset of the patient's shape; keys given explicitly take precedence");
    apply(variant, shape);
    const std::span rows(shape_fields);
    read_fields(patient, "patient", rows.first(1), shape);
    if (patient.has(rows[0].key())) {
        shape.gestational_age = median_gestational_age(shape.weight);
    }
    read_fields(patient, "patient", rows.subspan(1), shape);
    const auto [lightest, heaviest] = plausible_weights(shape.gestational_age);
    if (shape.weight < lightest || shape.weight > heaviest) {
        patient.refuse(rows[0].key(), fmt::format("{:g}", shape.weight),
                       fmt::format("{:.2f} to {:.2f} at gestational_age_weeks {:g}; or omit the age, which "
                                   "then follows the weight",
                                   lightest, heaviest, shape.gestational_age));
    }
}

/// A built model fixes the keys it was built from.
void reject_keys_fixed_by_model(const YamlMap& map, std::span<const std::string> keys) {
    for (const std::string& key : keys) {
        if (map.has(key)) {
            map.refuse(key, "a value",
                       "no value together with patient.model, which has its own; build another model");
        }
    }
}

/// Runtime parameters of a section that have an effect on yielding bones only.
void refuse_on_fixed_bones(const YamlMap& map, std::string_view section, const RuntimeParameters& values) {
    for (const RuntimeParameterField& field : runtime_parameter_fields) {
        const float value = values.*field.value;
        if (field.section == section && acts_on_yielding_bones(field) &&
            value != RuntimeParameters{}.*field.value) {
            map.refuse(field.key_in_section(), fmt::format("{:g}", value / field.per_unit),
                       "'physics.bones_yield: on' as well; fixed bones do not yield to it");
        }
    }
}

void read_assistant(YamlMap& map, Scenario& s) {
    const auto hand = [&](const std::string& key, float& stiffness, std::string_view help) {
        stiffness = map.number(key, stiffness, {0.0f, 10.0f}, help);
        if (map.has(key) && !s.physics.bones_yield) {
            map.refuse(key, fmt::format("{:g}", stiffness),
                       "'physics.bones_yield: on' as well; fixed bones stay where commands put them");
        }
    };
    hand("hand_on_jaw_nm_per_rad", s.assistant.hand_on_jaw,
         "Stiffness [N m/rad] with which a hand holds the jaw at its commanded opening; 0: none holds it. "
         "Requires `bones_yield`");
    hand("hand_on_head_nm_per_rad", s.assistant.hand_on_head,
         "Stiffness [N m/rad] with which a hand or a roll holds the head at its commanded elevation; 0: none "
         "holds it");
    read_fields(map, "assistant", runtime_parameter_fields, s.runtime_parameters);
    if (!s.physics.bones_yield) {
        refuse_on_fixed_bones(map, "assistant", s.runtime_parameters);
    }
}

/// Whether the patient model's file must exist for its scenario to be valid; a recorded one may have moved.
enum class ModelFile { required, may_be_absent };

/// `described`: takes the keys that were read, if given.
Scenario parse(const std::string& text, const std::filesystem::path& file, ModelFile model_file,
               std::vector<KeyDescription>* described = nullptr) {
    Scenario s;
    s.text = text;
    s.folder = file.parent_path();
    YamlMap root = YamlMap::parse(text, file.string());
    s.name = root.name("name", file.stem().string(), "Name of the session in records and on screen");
    s.description = root.text("description", "", "Shown beside the name as the session begins");
    s.debriefing = root.text(
        "debriefing", "", "What to discuss afterwards; shown once the session has ended, and in the report");
    auto patient = root.map("patient");
    if (patient) {
        Scenario::Patient& p = s.patient;
        read_shape(*patient, p.shape);
        read_fields(*patient, "patient", runtime_parameter_fields, s.runtime_parameters);
        if (const std::string model = patient->text(
                "model", "",
                "A model written by 'eti-anatomy build', relative to the scenario; shape, stiffness and "
                "spacings are then fixed by the model and may not be given");
            !model.empty()) {
            std::vector<std::string> held = {"variant", find_runtime_parameter("tissue_stiffness")->key()};
            for (const ShapeField& field : shape_fields) {
                held.push_back(field.key());
            }
            reject_keys_fixed_by_model(*patient, held);
            // Relative to the scenario, wherever the server was started.
            p.model = s.folder / model;
            if (const std::string kind =
                    model_file == ModelFile::required ? describe_non_regular(p.model) : "";
                !kind.empty()) {
                patient->refuse("model", fmt::format("'{}', which is {}", escaped(p.model.string()), kind),
                                "a file written by 'eti-anatomy build --out'; build it, or correct the path, "
                                "which is relative to the scenario's folder");
            }
        }
        patient->finish();
    }
    if (auto scope = root.map("laryngoscope")) {
        static constexpr std::array<std::string_view, 2> blades = {"miller_0", "miller_1"};
        choose(*scope, "blade", s.blade, blades, "Blade of 76 or 100 mm");
        scope->finish();
    }
    if (auto tube = root.map("tube")) {
        Tube& t = s.tube;
        read_fields(*tube, "tube", tube_fields, t);
        read_fields(*tube, "tube", runtime_parameter_fields, s.runtime_parameters);
        t = apply_to_tube(t, s.runtime_parameters);
        if (t.grip_from_tip > t.length) {
            tube->refuse("grip_from_tip_mm", fmt::format("{:.0f}", t.grip_from_tip / millimetre),
                         fmt::format("at most the tube's length, {:.0f}", t.length / millimetre));
        }
        tube->finish();
    }
    s.tube.outer_diameter = outer_diameter_of(s.tube.inner_diameter);
    if (auto physics = root.map("physics")) {
        Scenario::Physics& p = s.physics;
        p.substeps = physics->whole(
            "substeps", p.substeps, 1, 64,
            "Substeps per 1/180 s step for clusters, contacts and the tube; time is proportional to it. The "
            "forces of the implicit tongue do not depend on it");
        p.spacing = physics->number("spacing_mm", p.spacing, {0.75f, 4.0f, millimetre},
                                    "Particle spacing in the bulk; time grows with its inverse cube");
        p.fine_spacing = physics->number("fine_spacing_mm", p.fine_spacing, {0.5f, 2.0f, millimetre},
                                         "The same at epiglottis and larynx, at most `spacing_mm`");
        p.region = physics->number("region_mm", p.region, {4, 40, millimetre},
                                   "Tissue farther from the airway moves rigidly with the bones");
        p.tissue_method = tissue_method_of(*physics, p.tissue_method);
        if (!s.patient.model.empty()) {
            static const std::array<std::string, 3> held = {"spacing_mm", "fine_spacing_mm", "region_mm"};
            reject_keys_fixed_by_model(*physics, held);
        }
        if (p.fine_spacing > p.spacing) {
            physics->refuse("fine_spacing_mm", fmt::format("{:.2f}", p.fine_spacing / millimetre),
                            fmt::format("at most spacing_mm, {:.2f}", p.spacing / millimetre));
        }
        // Reads a flag that is off with clusters.
        const auto implicit_only = [&](const char* key, bool value, const char* help, const char* why) {
            const bool wanted = physics->has(key);
            const bool on = physics->flag(key, value, help);
            const bool clusters = p.tissue_method == TissueMethod::clusters;
            if (wanted && on && clusters) {
                physics->refuse(key, "on with 'tissue_method: clusters'",
                                std::string("'tissue_method: implicit', ") + why);
            }
            return on && !clusters;
        };
        p.bones_yield = implicit_only("bones_yield", p.bones_yield,
                                      "Head, mandible and hyoid yield to the forces on them; always off with "
                                      "`tissue_method: clusters`",
                                      "whose step the bones are part of");
        p.relaxation = implicit_only("relaxation", p.relaxation,
                                     "The force of a held blade falls, as tongue and epiglottis relax; "
                                     "always off with `tissue_method: clusters`",
                                     "whose elements relax");
        p.self_contact = physics->flag("self_contact", p.self_contact,
                                       "Whether clusters of larynx, pharynx and epiglottis keep apart, too; "
                                       "tongue and epiglottis always do");
        p.sleep =
            physics->flag("sleep", p.sleep,
                          "Whether tissue at rest without a tool nearby is skipped until something moves "
                          "it; saves most of the time of an idle scene");
        physics->finish();
    }
    if (patient && !s.physics.bones_yield) {
        refuse_on_fixed_bones(*patient, "patient", s.runtime_parameters);
    }
    if (auto assistant = root.map("assistant")) {
        read_assistant(*assistant, s);
        assistant->finish();
    }
    if (auto view = root.map("view")) {
        read_fields(*view, "view", runtime_parameter_fields, s.runtime_parameters);
        view->finish();
    }
    static constexpr std::array<std::string_view, 3> secretions = {"off", "on", "standby"};
    const std::size_t secretion = root.choice(
        "saliva", 0, secretions,
        "Secretions in mouth and throat: a pool behind the tongue, a film on it, and flow from the "
        "glands; the laryngoscope's suction removes them. `standby`: none until an instructor "
        "switches them on");
    s.saliva = secretion != 0;
    s.saliva_standby = secretion == 2;
    choose(root, "liquid", s.liquid, liquid_kind_names,
           "Rheology and appearance of the secretions; needs `saliva` on or standby");
    if (!s.saliva && s.liquid != LiquidKind::saliva) {
        root.refuse("liquid", std::string(name_of(s.liquid)),
                    "'saliva: on' or 'saliva: standby' as well; without either there is no liquid");
    }
    s.runtime_parameters.secretion = s.saliva && !s.saliva_standby ? 1.0f : 0.0f;
    s.runtime_parameters.head_scale = s.patient.shape.head_scale;
    s.runtime_parameters.tongue_scale = s.patient.shape.tongue_scale;
    static constexpr std::array<std::string_view, 2> silences = {"go_on", "freeze"};
    choose(
        root, "silent_device", s.freeze_on_silence, silences,
        "When a device that was connected sends nothing for 0.5 s. `go_on`: its tool stays in place and the "
        "attempt continues. `freeze`: simulation time stops until the device is back");
    s.time_limit =
        root.number("time_limit_s", s.time_limit, {1, 600}, "A longer attempt is marked as over time");
    s.vital_signs = root.flag("vital_signs", s.vital_signs,
                              "Whether oxygen saturation and heart rate fall during an attempt and recover "
                              "after it");
    s.manikin = root.flag("manikin", s.manikin,
                          "A real manikin replaces the patient; only the tools' poses are tracked");
    if (s.manikin && (s.saliva || s.vital_signs)) {
        root.refuse("manikin", fmt::format("'on' together with '{}'", s.saliva ? "saliva" : "vital_signs"),
                    "one of the two; a manikin has neither");
    }
    s.inspired_oxygen = root.number("inspired_oxygen_percent", s.inspired_oxygen, {21, 100, 0.01f},
                                    "Oxygen in the gas that ventilates the newborn between attempts");
    s.seed = root.seed("seed", s.seed, "Random seed; the same seed gives the same session");
    root.finish();
    if (described != nullptr) {
        *described = root.described();
    }
    return s;
}

}  // namespace

Scenario load_scenario(const std::filesystem::path& file) {
    return parse(read_text_file(file), file, ModelFile::required);
}

Scenario parse_scenario(const std::string& text, const std::filesystem::path& file) {
    return parse(text, file, ModelFile::may_be_absent);
}

Scenario shown_scenario(const std::string& text) {
    try {
        return parse_scenario(text, "the session's scenario");
    } catch (const InputError& error) {
        spdlog::warn("{}; shown are the defaults", error.what());
        return {};
    }
}

std::vector<KeyDescription> describe_scenario() {
    std::vector<KeyDescription> keys;
    (void)parse("patient: {}\nlaryngoscope: {}\ntube: {}\nphysics: {}\nassistant: {}\nview: {}\n",
                "the file's name", ModelFile::may_be_absent, &keys);
    return keys;
}

}  // namespace eti
