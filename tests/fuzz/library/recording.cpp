// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "recording.hpp"

#include <fmt/format.h>

#include <chrono>
#include <fstream>
#include <optional>
#include <thread>

#include "memory_network.hpp"
#include "target.hpp"

namespace eti::fuzz {

namespace {

using namespace std::chrono_literals;

/// The library adds a submessage of statistics to each datagram. It has to be the last, so mutations with it
/// are mostly refused: it stays in every 16th only.
void remove_statistics(std::vector<std::uint8_t>& datagram) {
    constexpr std::size_t size = 60;
    if (datagram.size() > size && datagram[datagram.size() - size] == 0x80) {
        datagram.resize(datagram.size() - size);
    }
}

/// A client, which is what receives inputs later, and the server.
struct Meeting {
    explicit Meeting(const std::filesystem::path& lab) : secured(!lab.empty()) {
        MemoryNetwork::instance().keep_sent(true);
        client.emplace("eti-client", secured ? Side::client : Side::both, secured ? lab / "hands" : "");
        server.emplace("eti-server", secured ? Side::server : Side::both, secured ? lab / "server" : "");
        client_id = client->prefix();
        server_id = server->prefix();
    }
    ~Meeting() { MemoryNetwork::instance().keep_sent(false); }

    /// Delivers what is sent for a while; returns what the client has received.
    Datagrams pump(std::chrono::milliseconds time, bool lossy) {
        Datagrams received;
        const auto unicast = MemoryNetwork::instance().unicast_ports();
        const auto end = std::chrono::steady_clock::now() + time;
        for (unsigned sent = 0; std::chrono::steady_clock::now() < end; std::this_thread::sleep_for(1ms)) {
            for (const MemoryNetwork::Sent& one : MemoryNetwork::instance().take_sent()) {
                if (lossy && ++sent % 5 == 0) {
                    continue;
                }
                const bool to_client = std::ranges::any_of(one.ports, [&](std::uint16_t port) {
                    return client->has_port(port) || std::ranges::find(unicast, port) == unicast.end();
                });
                if (to_client && std::ranges::equal(std::span(one.bytes).subspan(8, 12), server_id)) {
                    received.push_back({client->is_user_port(one.ports.front()), one.bytes});
                    auto& bytes = received.back().bytes;
                    if (++kept % 16 != 0) {
                        remove_statistics(bytes);
                    }
                    if (!secured) {
                        replace(bytes, server_id, peer);  // with security it follows from the certificate
                    }
                    replace_prefix(bytes, client_id, own_prefix);
                }
                for (const std::uint16_t port : one.ports) {
                    MemoryNetwork::instance().deliver(port, one.bytes);
                }
            }
        }
        return received;
    }

    const bool secured;
    std::optional<Target> client, server;
    Prefix client_id{}, server_id{};
    unsigned kept = 0;
};

/// Kinds that neither has sent: a gap, and questions and announcements of single fragments.
Datagrams rare_kinds() {
    const auto of = [](std::uint8_t kind, std::vector<std::uint32_t> words) {
        std::vector<std::uint8_t> bytes = {'R', 'T', 'P', 'S', 2, 3, 1, 15};
        bytes.insert(bytes.end(), peer.begin(), peer.end());
        bytes.insert(bytes.end(), {kind, 1, static_cast<std::uint8_t>(4 * words.size()), 0});
        for (const std::uint32_t word : words) {
            for (unsigned shift = 0; shift < 32; shift += 8) {
                bytes.push_back(static_cast<std::uint8_t>(word >> shift));
            }
        }
        return Datagram{true, bytes};
    };
    constexpr std::uint32_t scene_reader = 0x07020000, scene_writer = 0x02010000;
    return {of(0x08, {scene_reader, scene_writer, 0, 1, 0, 3, 8, 0x80000000}),
            of(0x12, {scene_reader, scene_writer, 0, 1, 1, 2, 0xc0000000, 1}),
            of(0x13, {scene_reader, scene_writer, 0, 1, 3, 1})};
}

void write(const std::filesystem::path& file, const Datagrams& datagrams) {
    const auto bytes = input_of(datagrams);
    std::ofstream(file, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

}  // namespace

void record(const std::filesystem::path& folder, const std::filesystem::path& lab) {
    Meeting meeting(lab);
    const Datagrams introduction = meeting.pump(lab.empty() ? 700ms : 6s, false);
    std::filesystem::create_directories(folder);
    write(folder / "introduction", introduction);
    Datagrams all;
    const auto add = [&](Datagrams more) { std::ranges::move(more, std::back_inserter(all)); };
    for (int i = 0; i < 8; ++i) {
        meeting.client->publish();
        meeting.server->publish();
        add(meeting.pump(100ms, true));
        meeting.client->take();
        meeting.server->take();
    }
    meeting.server.reset();
    add(meeting.pump(500ms, false));
    add(rare_kinds());
    constexpr std::size_t together = 8;
    for (std::size_t at = 0; at < all.size(); at += together) {
        const auto first = all.begin() + static_cast<std::ptrdiff_t>(at);
        const auto count = static_cast<std::ptrdiff_t>(std::min(together, all.size() - at));
        write(folder / fmt::format("{:03}", at / together), Datagrams(first, first + count));
    }
    fmt::print(stderr, "{} datagrams of introduction and {} others recorded in {}\n", introduction.size(),
               all.size(), folder.string());
}

}  // namespace eti::fuzz
