// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/bus/security/session_keys.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "common/bus/codec/convert.hpp"
#include "common/model/tissue.hpp"

namespace eti::bus {

namespace {

constexpr std::size_t absent = std::numeric_limits<std::size_t>::max();
constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float longest_tool = 1.0f;  // [m]; a longer one is a corrupt message

/// A name as a fixed-size array; a test checks that the names in this program's tables fit.
template <class FixedString>
void put(std::string_view text, FixedString& to) {
    to = std::string(text);
}

/// Maps the names of one table to indices in a message, and collects names that only one side has.
class Places {
  public:
    template <class Keys, class Rows, class NameOf>
    std::vector<std::size_t> find(const Keys& keys, const Rows& rows, const NameOf& name_of) {
        std::vector<std::size_t> places;
        std::vector<bool> known(keys.size(), false);
        for (const auto& row : rows) {
            const std::string name(name_of(row));
            const auto found =
                std::ranges::find_if(keys, [&](const auto& key) { return key.name() == name.c_str(); });
            places.push_back(found == keys.end() ? absent : static_cast<std::size_t>(found - keys.begin()));
            if (found == keys.end()) {
                ours_.push_back(name);
            } else {
                known[places.back()] = true;
            }
        }
        for (std::size_t i = 0; i < keys.size(); ++i) {
            if (!known[i]) {
                theirs_.push_back(keys[i].name().to_string());
            }
        }
        return places;
    }

    [[nodiscard]] std::string text(const std::string& version) const {
        if (ours_.empty() && theirs_.empty()) {
            return {};
        }
        const auto list = [](const std::vector<std::string>& names) {
            return names.empty() ? std::string("nothing") : fmt::format("{}", fmt::join(names, ", "));
        };
        return fmt::format(
            "the server has version {}, this program {}: only the server knows {}; only this program knows "
            "{}. Everything else works",
            version, ETI_VERSION, list(theirs_), list(ours_));
    }

  private:
    std::vector<std::string> ours_, theirs_;
};

/// The values of a table, in its order.
template <class Number, class Rows, class Values>
std::vector<Number> in_order(const Rows& rows, const Values& values) {
    std::vector<Number> out;
    std::ranges::transform(rows, std::back_inserter(out), [&](const auto& row) { return values.*row.value; });
    return out;
}

/// The values of a table from a message; NaN for those that it does not contain.
template <class Values, class Number, class Rows>
Values by_place(const Rows& rows, std::span<const std::size_t> places, std::span<const Number> numbers) {
    Values out;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        out.*rows[i].value =
            places[i] < numbers.size() ? numbers[places[i]] : std::numeric_limits<Number>::quiet_NaN();
    }
    return out;
}

bool is_length(float metres) {
    return metres > 0.0f && metres < longest_tool;
}

/// Why the tools are invalid; empty if they are valid.
std::string faulty_tools(const msg::SessionDescription& m) {
    if (!is_length(m.blade_length()) || m.laryngoscope().size() != Laryngoscope().capsules.size()) {
        return fmt::format("a blade with a length of {} m and {} capsules", m.blade_length(),
                           m.laryngoscope().size());
    }
    for (const msg::CapsuleShape& c : m.laryngoscope()) {
        if (!is_valid_point(c.a()) || !is_valid_point(c.b()) || !is_length(c.radius())) {
            return "a capsule of the laryngoscope that is not finite";
        }
    }
    if (!is_length(m.tube_length()) || !is_length(m.tube_grip_from_tip()) ||
        !is_length(m.tube_inner_diameter()) || !is_length(m.tube_outer_diameter()) ||
        m.tube_outer_diameter() <= m.tube_inner_diameter() || !(m.tube_curve_radius() > 0.01f)) {
        return fmt::format(
            "a tube with diameters of {} and {} m, a length of {} m and a radius of curvature of {} m",
            m.tube_inner_diameter(), m.tube_outer_diameter(), m.tube_length(), m.tube_curve_radius());
    }
    return {};
}

/// Why a row of the runtime parameters is invalid; empty if it is valid.
std::string faulty_row(const msg::LiveKey& key) {
    const bool finite = std::isfinite(key.low()) && std::isfinite(key.high()) && std::isfinite(key.start()) &&
                        std::isfinite(key.rate()) && std::isfinite(key.per_unit());
    return finite && key.per_unit() > 0.0f && key.low() <= key.high()
               ? std::string()
               : fmt::format("'{}' ranges from {} to {}", key.name().to_string(), key.low(), key.high());
}

}  // namespace

void set_keys(const RuntimeParameters& start, msg::SessionDescription& message) {
    for (const RuntimeParameterField& field : runtime_parameter_fields) {
        msg::LiveKey& key = message.live().emplace_back();
        put(field.name, key.name());
        put(field.label, key.label());
        put(field.unit, key.unit());
        key.per_unit(field.per_unit);
        key.low(field.low);
        key.high(field.high);
        key.start(start.*field.value);
        key.rate(field.rate);
        key.relative(field.relative);
        key.on_off(field.on_off);
        put(field.help, key.help());
    }
    const auto put_key = [](const auto& field, std::string_view unit, msg::ParameterKey& key) {
        put(field.key, key.name());
        put(field.label, key.label());
        put(unit, key.unit());
    };
    for (const MetricField& field : metric_fields) {
        put_key(field, field.unit, message.parameters().emplace_back());
    }
    for (const LiveMeasureField& field : live_measure_fields) {
        put_key(field, field.si, message.measures().emplace_back());
    }
    for (const std::string_view name : tissue_names) {
        put(name, message.tissues().emplace_back());
    }
}

void set_tools(const Laryngoscope& scope, const Tube& tube, msg::SessionDescription& message) {
    put(name_of(scope.blade), message.blade());
    message.blade_length(scope.blade_length);
    for (const Capsule& capsule : scope.capsules) {
        msg::CapsuleShape& shape = message.laryngoscope().emplace_back();
        shape.a(to_msg(capsule.a));
        shape.b(to_msg(capsule.b));
        shape.radius(capsule.radius);
    }
    message.tube_inner_diameter(tube.inner_diameter);
    message.tube_outer_diameter(tube.outer_diameter);
    message.tube_length(tube.length);
    message.tube_grip_from_tip(tube.grip_from_tip);
    message.tube_curve_radius(tube.curve_radius);
}

void set_runtime_parameters(const RuntimeParameters& values, msg::LiveMetrics& message) {
    message.live(in_order<float>(runtime_parameter_fields, values));
}

void set_measures(const LiveMeasures& measures, msg::LiveMetrics& message) {
    message.measures(in_order<float>(live_measure_fields, measures));
}

std::vector<double> to_msg(const AttemptMetrics& metrics) {
    return in_order<double>(metric_fields, metrics);
}

std::optional<SessionKeys> SessionKeys::of(const msg::SessionDescription& m, std::string& why) {
    SessionKeys keys;
    Places places;
    keys.runtime_parameters_ = places.find(m.live(), runtime_parameter_fields,
                                           [](const RuntimeParameterField& field) { return field.name; });
    keys.metrics_ =
        places.find(m.parameters(), metric_fields, [](const MetricField& field) { return field.key; });
    keys.measures_ = places.find(m.measures(), live_measure_fields,
                                 [](const LiveMeasureField& field) { return field.key; });
    keys.landmarks_ = places.find(m.landmarks(), landmark_names, [](std::string_view name) { return name; });
    for (std::size_t i = 0; i < landmark_count; ++i) {
        if (keys.landmarks_[i] == absent) {
            why = fmt::format(
                "the server (version {}) has no landmark '{}', which this program (version {}) needs",
                m.version().to_string(), landmark_names[i], ETI_VERSION);
            return std::nullopt;
        }
        const msg::Vec3& rest = m.landmarks()[keys.landmarks_[i]].rest();
        if (!is_valid_point(from_msg(rest), longest_tool)) {
            why = fmt::format("invalid landmark '{}'", landmark_names[i]);
            return std::nullopt;
        }
        keys.rest_[i] = from_msg(rest);
    }
    why = faulty_tools(m);
    for (const msg::LiveKey& key : m.live()) {
        why = why.empty() ? faulty_row(key) : why;
    }
    if (why.empty() && !(m.patient_weight_kg() > 0.1f && m.patient_weight_kg() < 20.0f)) {
        why = fmt::format("a newborn with a weight of {} kg", m.patient_weight_kg());
    }
    if (!why.empty()) {
        return std::nullopt;
    }
    for (std::size_t i = 0; i < runtime_parameter_fields.size(); ++i) {
        keys.start_.*runtime_parameter_fields[i].value =
            keys.runtime_parameters_[i] == absent ? nan : m.live()[keys.runtime_parameters_[i]].start();
    }
    keys.weight_ = static_cast<double>(m.patient_weight_kg());
    keys.scope_.blade =
        m.blade() == std::string(name_of(Blade::miller_0)).c_str() ? Blade::miller_0 : Blade::miller_1;
    keys.scope_.blade_length = m.blade_length();
    for (std::size_t i = 0; i < keys.scope_.capsules.size(); ++i) {
        const msg::CapsuleShape& c = m.laryngoscope()[i];
        keys.scope_.capsules[i] = {from_msg(c.a()), from_msg(c.b()), c.radius()};
    }
    keys.tube_.inner_diameter = m.tube_inner_diameter();
    keys.tube_.outer_diameter = m.tube_outer_diameter();
    keys.tube_.length = m.tube_length();
    keys.tube_.grip_from_tip = m.tube_grip_from_tip();
    keys.tube_.curve_radius = m.tube_curve_radius();
    keys.liquid_ = liquid_kind_named(m.liquid().c_str());
    keys.key_mismatch_ = places.text(m.version().to_string());
    return keys;
}

RuntimeParameters SessionKeys::runtime_parameters(const msg::LiveMetrics& message) const {
    return by_place<RuntimeParameters, float>(runtime_parameter_fields, runtime_parameters_, message.live());
}

LiveMeasures SessionKeys::measures(const msg::LiveMetrics& message) const {
    return by_place<LiveMeasures, float>(live_measure_fields, measures_, message.measures());
}

AttemptMetrics SessionKeys::metrics(std::span<const double> values) const {
    return by_place<AttemptMetrics, double>(metric_fields, metrics_, values);
}

std::optional<Landmarks> SessionKeys::landmarks(const msg::LiveMetrics& message) const {
    Landmarks points;
    for (std::size_t i = 0; i < landmark_count; ++i) {
        if (landmarks_[i] >= message.landmarks().size() ||
            !is_valid_point(message.landmarks()[landmarks_[i]])) {
            return std::nullopt;
        }
        points[i] = from_msg(message.landmarks()[landmarks_[i]]);
    }
    return points;
}

}  // namespace eti::bus
