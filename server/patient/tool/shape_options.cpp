// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <fmt/format.h>
#include <algorithm>
#include <optional>

#include "common/process/command_line.hpp"
#include "server/patient/tool/commands.hpp"

namespace eti::tool {

struct ShapeOptions::Typed {
    std::string variant;
    std::array<std::optional<float>, shape_fields.size()> values;
};

ShapeOptions::ShapeOptions(CommandLine& command) : typed_(std::make_shared<Typed>()) {
    const NewbornShape usual;
    for (std::size_t i = 0; i < shape_fields.size(); ++i) {
        const ShapeField& field = shape_fields[i];
        std::string name = "--" + field.key();
        std::replace(name.begin(), name.end(), '_', '-');
        command.add_number(name, typed_->values[i],
                           fmt::format("{} [{:g}]", field.help, usual.*field.value / field.per_unit),
                           {field.low, field.high, std::string(field.unit)});
    }
    command
        .add_option("--variant", typed_->variant, "Preset of the above; values given explicitly override it")
        .one_of(std::vector<std::string>(airway_variant_names.begin(), airway_variant_names.end()));
}

NewbornShape ShapeOptions::shape() const {
    NewbornShape shape;
    const auto variant = std::find(airway_variant_names.begin(), airway_variant_names.end(), typed_->variant);
    if (variant != airway_variant_names.end()) {
        apply(static_cast<AirwayVariant>(variant - airway_variant_names.begin()), shape);
    }
    for (std::size_t i = 0; i < shape_fields.size(); ++i) {
        if (typed_->values[i]) {
            shape.*shape_fields[i].value = *typed_->values[i] * shape_fields[i].per_unit;
            if (shape_fields[i].value == &NewbornShape::weight) {
                shape.gestational_age = median_gestational_age(shape.weight);
            }
        }
    }
    if (const std::string why = implausibility(shape); !why.empty()) {
        throw std::runtime_error(why);
    }
    return shape;
}

bool ShapeOptions::any() const {
    return !typed_->variant.empty() || std::any_of(typed_->values.begin(), typed_->values.end(),
                                                   [](const auto& v) { return v.has_value(); });
}

}  // namespace eti::tool
