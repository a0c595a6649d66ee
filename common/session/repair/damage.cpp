// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/session/repair/damage.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>

#include "common/session/opinions.hpp"

namespace eti::session {

namespace {

constexpr const char* damage_group = "damage";

}  // namespace

std::string describe(const Damage& damage) {
    if (damage.path == "scene") {
        return "scene: surfaces and landmarks are lost";
    }
    if (damage.path == ratings_group || damage.path == answers_group) {
        return fmt::format("{}: all are lost", damage.path);
    }
    return damage.count == 1 ? fmt::format("{}: row {} is lost", damage.path, damage.first)
                             : fmt::format("{}: rows {} to {} are lost", damage.path, damage.first,
                                           damage.first + damage.count - 1);
}

bool is_known_lost(const std::vector<Damage>& damage, std::string_view path) {
    return std::ranges::any_of(damage, [&](const Damage& one) { return one.path == path; });
}

void write_damage(const hdf5::Group& root, const std::vector<Damage>& damage) {
    const hdf5::Group group = root.create(damage_group);
    std::vector<std::string> paths;
    std::vector<std::uint64_t> rows;
    for (const Damage& one : damage) {
        paths.push_back(one.path);
        rows.push_back(one.first);
        rows.push_back(one.count);
    }
    group.write_texts("path", paths, {"1", "series, or group of times, with lost rows"});
    group.write<std::uint64_t>("rows", rows, {damage.size(), 2},
                               {"1", "first lost row and number of lost rows"});
}

std::vector<Damage> read_damage(const hdf5::Group& root) {
    if (!root.has(damage_group)) {
        return {};
    }
    const hdf5::Group group = root.open(damage_group);
    const auto paths = group.read_texts("path");
    const auto rows = group.read<std::uint64_t>("rows", {paths.size(), 2}).values;
    std::vector<Damage> damage;
    for (std::size_t i = 0; i < paths.size(); ++i) {
        damage.push_back({paths[i], rows[2 * i], rows[2 * i + 1]});
    }
    return damage;
}

}  // namespace eti::session
