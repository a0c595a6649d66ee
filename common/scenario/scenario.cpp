// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/scenario/scenario.hpp"

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cstdlib>

#include "common/math/units.hpp"
#include "common/process/escaped.hpp"
#include "common/process/files/file_kind.hpp"
#include "common/scenario/yaml_map.hpp"

namespace eti {

namespace {

std::vector<std::filesystem::path> data_folders(const std::string& kind) {
    std::vector<std::filesystem::path> folders;
    if (const char* own = std::getenv("ETI_DATA"); own != nullptr && *own != '\0') {
        folders.push_back(std::filesystem::path(own) / kind);
    }
    std::error_code error;
    const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error);
    if (!error) {
        folders.push_back(program.parent_path().parent_path() / "share" / "neoeti" / kind);
    }
    return folders;
}

/// An XPBD tongue of earlier versions, `tetrahedra`, is read as implicit.
TissueMethod tissue_method_of(YamlMap& physics, TissueMethod fallback) {
    static constexpr std::array<std::string_view, 3> names = {"clusters", "implicit", "tetrahedra"};
    const std::size_t named = physics.choice("tissue_method", static_cast<std::size_t>(fallback), names);
    if (named < tissue_method_names.size()) {
        return static_cast<TissueMethod>(named);
    }
    spdlog::warn(
        "physics.tissue_method: 'tetrahedra' (XPBD) no longer exists; 'implicit' solves the same mesh");
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

void read_shape(YamlMap& patient, NewbornShape& shape) {
    apply(static_cast<AirwayVariant>(patient.choice("variant", 0, airway_variant_names)), shape);
    const std::span rows(shape_fields);
    read_fields(patient, "patient", rows.first(1), shape);
    if (patient.has(rows[0].key())) {
        shape.gestational_age = median_gestational_age(shape.weight);
    }
    read_fields(patient, "patient", rows.subspan(1), shape);
    const auto [lightest, heaviest] = plausible_weights(shape.gestational_age);
    if (shape.weight < lightest || shape.weight > heaviest) {
        patient.refuse(
            rows[0].key(), fmt::format("{:g}", shape.weight),
            fmt::format("{:.2f} to {:.2f} at gestational_age_weeks {:g}; or leave the age out, and it "
                        "follows the weight",
                        lightest, heaviest, shape.gestational_age));
    }
}

/// A built model fixes the keys it was built from.
void reject_keys_fixed_by_model(const YamlMap& map, std::span<const std::string> keys) {
    for (const std::string& key : keys) {
        if (map.has(key)) {
            map.refuse(key, "a value",
                       "none beside patient.model, which was built with its own; build another model");
        }
    }
}

}  // namespace

std::vector<std::string> data_names(const std::string& kind) {
    std::vector<std::string> names;
    std::error_code error;
    for (const std::filesystem::path& folder : data_folders(kind)) {
        for (std::filesystem::directory_iterator i(folder, error), end; !error && i != end;
             i.increment(error)) {
            if (i->path().extension() == ".yaml") {
                names.push_back(i->path().stem().string());
            }
        }
    }
    std::sort(names.begin(), names.end());
    names.erase(std::unique(names.begin(), names.end()), names.end());
    return names;
}

std::filesystem::path find_data_file(const std::string& name_or_path, const std::string& kind) {
    const std::filesystem::path given(name_or_path);
    std::error_code error;
    if (std::filesystem::is_regular_file(given, error)) {
        return given;
    }
    std::vector<std::string> searched;
    // A name, not a path: it cannot leave the data folders.
    const bool is_name = !name_or_path.empty() && given.filename() == given && given != ".." && given != ".";
    for (const std::filesystem::path& folder : data_folders(kind)) {
        searched.push_back(folder.string());
        if (is_name && std::filesystem::is_regular_file(folder / (name_or_path + ".yaml"), error)) {
            return folder / (name_or_path + ".yaml");
        }
    }
    const std::vector<std::string> names = data_names(kind);
    throw InputError(fmt::format("'{}' is neither a file nor a name in {}; names there are: {}", name_or_path,
                                 fmt::join(searched, ", "),
                                 names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "))));
}

namespace {

/// Whether the patient model's file must exist for its scenario to be valid; a recorded one may have moved.
enum class ModelFile { required, may_be_absent };

Scenario parse(const std::string& text, const std::filesystem::path& file, ModelFile model_file) {
    Scenario s;
    s.text = text;
    s.folder = file.parent_path();
    YamlMap root = YamlMap::parse(text, file.string());
    s.name = root.name("name", file.stem().string());
    s.description = root.text("description", "");
    if (auto patient = root.map("patient")) {
        Scenario::Patient& p = s.patient;
        read_shape(*patient, p.shape);
        read_fields(*patient, "patient", runtime_parameter_fields, s.runtime_parameters);
        if (const std::string model = patient->text("model", ""); !model.empty()) {
            std::vector<std::string> held = {"variant", find_runtime_parameter("tissue_stiffness")->key()};
            for (const ShapeField& field : shape_fields) {
                held.push_back(field.key());
            }
            reject_keys_fixed_by_model(*patient, held);
            // Relative to the scenario, wherever the server was started.
            p.model = s.folder / model;
            if (const std::string kind = describe_non_regular(p.model);
                model_file == ModelFile::required && !kind.empty()) {
                patient->refuse(
                    "model", fmt::format("'{}', where there is {}", escaped(p.model.string()), kind),
                    "a file that 'eti-anatomy build --out' wrote; build it, or mend the path, which "
                    "begins at the scenario's folder");
            }
        }
        patient->finish();
    }
    if (auto scope = root.map("laryngoscope")) {
        static constexpr std::array<std::string_view, 2> blades = {"miller_0", "miller_1"};
        s.blade = static_cast<Blade>(scope->choice("blade", static_cast<std::size_t>(s.blade), blades));
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
        p.substeps = physics->whole("substeps", p.substeps, 1, 64);
        p.spacing = physics->number("spacing_mm", p.spacing, {0.75f, 4.0f, millimetre});
        p.fine_spacing = physics->number("fine_spacing_mm", p.fine_spacing, {0.5f, 2.0f, millimetre});
        p.region = physics->number("region_mm", p.region, {4, 40, millimetre});
        p.tissue_method = tissue_method_of(*physics, p.tissue_method);
        if (!s.patient.model.empty()) {
            static const std::array<std::string, 3> held = {"spacing_mm", "fine_spacing_mm", "region_mm"};
            reject_keys_fixed_by_model(*physics, held);
        }
        if (p.fine_spacing > p.spacing) {
            physics->refuse("fine_spacing_mm", fmt::format("{:.2f}", p.fine_spacing / millimetre),
                            fmt::format("at most spacing_mm, {:.2f}", p.spacing / millimetre));
        }
        p.self_contact = physics->flag("self_contact", p.self_contact);
        p.sleep = physics->flag("sleep", p.sleep);
        physics->finish();
    }
    if (auto view = root.map("view")) {
        read_fields(*view, "view", runtime_parameter_fields, s.runtime_parameters);
        view->finish();
    }
    static constexpr std::array<std::string_view, 3> secretions = {"off", "on", "standby"};
    const std::size_t secretion = root.choice("saliva", 0, secretions);
    s.saliva = secretion != 0;
    s.saliva_standby = secretion == 2;
    s.liquid = static_cast<LiquidKind>(root.choice("liquid", 0, liquid_kind_names));
    if (!s.saliva && s.liquid != LiquidKind::saliva) {
        root.refuse("liquid", std::string(name_of(s.liquid)),
                    "saliva, or none: without 'saliva: on' or 'saliva: standby' there is no liquid");
    }
    s.runtime_parameters.secretion = s.saliva && !s.saliva_standby ? 1.0f : 0.0f;
    s.runtime_parameters.head_scale = s.patient.shape.head_scale;
    s.runtime_parameters.tongue_scale = s.patient.shape.tongue_scale;
    static constexpr std::array<std::string_view, 2> silences = {"go_on", "freeze"};
    s.freeze_on_silence = root.choice("silent_device", 0, silences) == 1;
    s.time_limit = root.number("time_limit_s", s.time_limit, {1, 600});
    static constexpr std::array<std::string_view, 2> switches = {"off", "on"};
    s.vital_signs = root.choice("vital_signs", 0, switches) == 1;
    s.manikin = root.choice("manikin", 0, switches) == 1;
    if (s.manikin && (s.saliva || s.vital_signs)) {
        root.refuse("manikin", fmt::format("'on' beside '{}'", s.saliva ? "saliva" : "vital_signs"),
                    "one of the two; a manikin has neither");
    }
    s.inspired_oxygen = root.number("inspired_oxygen_percent", s.inspired_oxygen, {21, 100, 0.01f});
    s.seed = root.seed("seed", s.seed);
    root.finish();
    return s;
}

}  // namespace

Scenario load_scenario(const std::filesystem::path& file) {
    return parse(read_text_file(file), file, ModelFile::required);
}

Scenario parse_scenario(const std::string& text, const std::filesystem::path& file) {
    return parse(text, file, ModelFile::may_be_absent);
}

}  // namespace eti
