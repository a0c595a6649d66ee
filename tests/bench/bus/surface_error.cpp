// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "tests/bench/bus/surface_error.hpp"

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <map>
#include <stdexcept>

#include "common/bus/codec/wire.hpp"
#include "common/process/files/atomic_file_writer.hpp"
#include "tests/bench/bus/percentiles.hpp"

namespace eti::bench {

namespace {

using ChunkType = bus::WireType<msg::DeformationStatePubSubType>;

// Steps of simulation time after which both have every frame: a whole refresh of either topic, 45 states of
// up to 6 steps, and as much again for lost ones.
constexpr std::uint32_t settled_after = 540;

/// Over both scenes' surfaces: the largest distance of a vertex and the mean of those that differ [mm].
struct Apart {
    double most = 0.0, mean = 0.0;
};

Apart apart(const view::SceneView& a, const view::SceneView& b) {
    Apart out;
    double sum = 0.0;
    std::size_t count = 0;
    for (const auto& [name, surface] : a.surfaces()) {
        const auto& mine = surface.vertices();
        const auto& theirs = b.surfaces().at(name).vertices();
        for (std::size_t v = 0; v < mine.size(); ++v) {
            const auto distance = static_cast<double>((mine[v].position - theirs[v].position).norm());
            out.most = std::max(out.most, 1e3 * distance);
            sum += 1e3 * distance;
        }
        count += mine.size();
    }
    out.mean = count > 0 ? sum / static_cast<double>(count) : 0.0;
    return out;
}

std::map<std::uint32_t, std::size_t> by_state(const Chunks& chunks, std::uint32_t from, std::uint32_t to) {
    std::map<std::uint32_t, std::size_t> count;
    for (const auto& chunk : chunks) {
        if (const std::uint32_t number = chunk.header().number(); number >= from && number <= to) {
            ++count[number];
        }
    }
    return count;
}

}  // namespace

void save_chunks(const std::filesystem::path& file, const Chunks& chunks) {
    AtomicFileWriter unfinished(file);
    std::ofstream out(unfinished.path(), std::ios::binary);
    ChunkType type;
    for (const msg::DeformationState& chunk : chunks) {
        bus::rtps::SerializedPayload_t payload(type.size_of(&chunk));
        (void)type.write(&chunk, payload);
        out.write(reinterpret_cast<const char*>(&payload.length), sizeof payload.length);
        out.write(reinterpret_cast<const char*>(payload.data), payload.length);
    }
    out.close();
    if (!out) {
        throw std::runtime_error(file.string() + ": cannot be written; is the disk full?");
    }
    unfinished.finish();
}

Chunks load_chunks(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    Chunks chunks;
    ChunkType type;
    for (std::uint32_t size = 0; in.read(reinterpret_cast<char*>(&size), sizeof size);) {
        bus::rtps::SerializedPayload_t payload(size);
        if (!in.read(reinterpret_cast<char*>(payload.data), size)) {
            throw std::runtime_error(file.string() + ": ends within a message");
        }
        payload.length = size;
        if (!type.read(payload, &chunks.emplace_back())) {
            throw std::runtime_error(file.string() + ": a message is malformed");
        }
    }
    return chunks;
}

nlohmann::json surface_error(const view::SceneView& rest, const Chunks& whole, const Chunks& other) {
    if (whole.empty() || other.empty()) {
        return {{"error", "one of the two readers got no state"}};
    }
    const std::uint32_t from =
        std::max(whole.front().header().number(), other.front().header().number()) + settled_after;
    const std::uint32_t to = std::min(whole.back().header().number(), other.back().header().number());
    const auto all = by_state(whole, from, to), arrived = by_state(other, from, to);
    std::size_t sent = 0, got = 0, whole_states = 0;
    for (const auto& [number, chunks] : all) {
        const auto found = arrived.find(number);
        const std::size_t here = found == arrived.end() ? 0 : found->second;
        sent += chunks;
        got += here;
        whole_states += here >= chunks ? 1 : 0;
    }
    view::SceneView a = rest, b = rest;
    std::vector<double> most, mean;
    auto next = whole.begin(), theirs = other.begin();
    for (const auto& state : all) {
        const auto take_until = [&](Chunks::const_iterator& at, Chunks::const_iterator end,
                                    view::SceneView& scene) {
            while (at != end && at->header().number() <= state.first) {
                scene.apply(*at++);
            }
            scene.update();
        };
        take_until(next, whole.end(), a);
        take_until(theirs, other.end(), b);
        const Apart now = apart(a, b);
        most.push_back(now.most);
        mean.push_back(now.mean);
    }
    return {{"states", all.size()},
            {"states_whole", whole_states},
            {"chunks", sent},
            {"chunks_arrived", got},
            {"largest_error_mm", percentiles(most)},
            {"mean_error_mm", percentiles(mean)}};
}

}  // namespace eti::bench
