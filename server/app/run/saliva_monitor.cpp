// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/run/saliva_monitor.hpp"

#include <fmt/format.h>

#include <utility>

namespace eti::app {

std::string SalivaMonitor::check(const scene::SalivaState& saliva) {
    if (saliva.overflow > 0 && !std::exchange(full_, true)) {
        return fmt::format(
            "mouth and throat contain the maximum amount of saliva ({} particles): secretion stops until "
            "suction removes some",
            saliva.positions.size());
    }
    if (saliva.dropped_neighbours > 0 && !std::exchange(crowded_, true)) {
        return fmt::format(
            "saliva is compressed: {} neighbours beyond 64 of a particle were ignored, so that its pressure "
            "is too low there; reduce the secretion, or remove saliva by suction",
            saliva.dropped_neighbours);
    }
    return {};
}

}  // namespace eti::app
