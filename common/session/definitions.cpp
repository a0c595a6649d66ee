// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/session/definitions.hpp"

#include "common/model/attempt_metrics.hpp"
#include "common/model/thresholds.hpp"
#include "common/session/text_columns.hpp"

namespace eti::session {

namespace {

using hdf5::Group;

constexpr const char* definitions_group = "definitions";

constexpr TextColumn<Definitions::Words> words_columns[] = {
    {"key", "of the metric, in summary and metrics; with a dot instead of a slash", &Definitions::Words::key},
    {"unit", "of its value", &Definitions::Words::unit},
    {"run", "aggregation of the attempts' values to the run's value", &Definitions::Words::run},
    {"definition", "in words", &Definitions::Words::definition},
    {"aim", "target, with its source", &Definitions::Words::aim},
};

constexpr TextColumn<Definitions::Number> number_columns[] = {
    {"name", "of the threshold", &Definitions::Number::name},
    {"unit", "of its value", &Definitions::Number::unit},
    {"meaning", "in words", &Definitions::Number::meaning},
};

}  // namespace

Definitions current_definitions(double time_limit) {
    Definitions here;
    here.version = definitions_version;
    for (const MetricField& field : metric_fields) {
        here.metrics.push_back({std::string(field.key), std::string(field.unit),
                                std::string(describe(field.combine)), std::string(field.definition),
                                std::string(field.norm)});
    }
    for (const Threshold& threshold : thresholds) {
        here.thresholds.push_back({std::string(threshold.name), threshold.value, std::string(threshold.unit),
                                   std::string(threshold.meaning)});
    }
    here.thresholds.push_back({"time_limit", time_limit, "s", "Longest attempt within the scenario's limit"});
    return here;
}

void write_definitions(const Group& scene, const Definitions& definitions) {
    if (definitions.version == 0) {
        return;
    }
    const Group group = scene.create(definitions_group);
    group.set_integer("version", definitions.version);
    write_text_columns(group.create("parameters"), definitions.metrics, words_columns);
    const Group numbers = group.create("thresholds");
    write_text_columns(numbers, definitions.thresholds, number_columns);
    std::vector<double> values;
    for (const Definitions::Number& number : definitions.thresholds) {
        values.push_back(number.value);
    }
    numbers.write<double>("value", values, {values.size()}, {"as in unit", "of each name"});
}

Definitions read_definitions(const Group& scene) {
    Definitions definitions;
    if (!scene.has(definitions_group)) {
        return definitions;
    }
    const Group group = scene.open(definitions_group);
    definitions.version = group.integer("version");
    definitions.metrics = read_text_columns(group.open("parameters"), words_columns);
    const Group numbers = group.open("thresholds");
    definitions.thresholds = read_text_columns(numbers, number_columns);
    const std::vector<double> values = numbers.read<double>("value", {definitions.thresholds.size()}).values;
    for (std::size_t i = 0; i < values.size(); ++i) {
        definitions.thresholds[i].value = values[i];
    }
    return definitions;
}

}  // namespace eti::session
