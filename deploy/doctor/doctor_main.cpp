// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <iterator>
#include <nlohmann/json.hpp>

#include "common/bus/command_line.hpp"
#include "common/process/program.hpp"
#include "deploy/doctor/graphics.hpp"
#include "deploy/doctor/machine.hpp"
#include "deploy/doctor/network.hpp"
#include "deploy/doctor/session.hpp"

namespace eti::doctor {
namespace {

struct Options {
    bus::Options bus;
    double duration = 5.0;  ///< [s]
    bool json = false;
};

const char* word(State state) {
    return state == State::ok ? "well" : state == State::info ? "note" : "mend";
}

/// All checks of the local machine.
Findings look_at_machine(const Options& options) {
    Findings all;
    const auto add = [&](Findings more) { std::ranges::move(more, std::back_inserter(all)); };
    const bool by_others = !options.bus.peers.empty() || !options.bus.discovery_servers.empty();
    add(versions());
    add(diagnose_interfaces(interfaces(), options.bus.network || by_others, !by_others));
    add(diagnose_buffers(socket_buffers()));
    add(diagnose_shared_memory(shared_memory("/dev/shm", !options.bus.profile.empty())));
    add(real_time_rights());
    add(graphics());
    add(openxr());
    add(identity(options.bus));
    return all;
}

nlohmann::ordered_json json_of(const SessionReport& report) {
    nlohmann::ordered_json peers = nlohmann::ordered_json::array(), topics = nlohmann::ordered_json::array();
    for (const PeerReport& peer : report.peers) {
        nlohmann::ordered_json one{{"name", peer.name},       {"process", peer.process},
                                   {"version", peer.version}, {"protocol", peer.protocol},
                                   {"serves", peer.serves},   {"answers", peer.round_trips_ms.size()}};
        if (!peer.round_trips_ms.empty()) {
            one["round_trip_ms"] = {{"min", percentile(peer.round_trips_ms, 0.0)},
                                    {"median", percentile(peer.round_trips_ms, 0.5)},
                                    {"p99", percentile(peer.round_trips_ms, 0.99)}};
            one["clock_offset_ms"] = peer.clock_offset_ms;
            one["clock_error_ms"] = peer.error_ms;
        }
        peers.push_back(one);
    }
    for (const TopicReport& topic : report.topics) {
        topics.push_back({{"topic", topic.topic},
                          {"arrived", topic.arrived},
                          {"lost", topic.lost},
                          {"lost_percent", topic.lost_percent},
                          {"arrived_mbit_per_s", topic.arrived_mbit_per_s},
                          {"sent_mbit_per_s", topic.sent_mbit_per_s()}});
    }
    return {{"server", report.server},
            {"peers", peers},
            {"topics", topics},
            {"rediscovered",
             {{"after_departure", report.rediscoveries.after_departure},
              {"after_silence", report.rediscoveries.after_silence}}}};
}

void print(const Findings& findings) {
    for (const Finding& one : findings) {
        fmt::print("{}  {:<10} {:<18} {}\n", word(one.state), one.area, one.thing, one.text);
        if (!one.remedy.empty()) {
            fmt::print("      to do: {}\n", one.remedy);
        }
    }
}

int run(const Options& options) {
    Findings findings = look_at_machine(options);
    if (!options.json) {
        print(findings);
    }
    SessionReport report;
    Findings of_session;
    try {
        report = observe(options.bus, std::chrono::duration<double>(options.duration));
        of_session = diagnose_session(report, options.bus);
    } catch (const bus::BusError& error) {
        of_session.push_back(
            {"session", options.bus.session, State::problem, "cannot be joined", error.what()});
    }
    if (!options.json) {
        print(of_session);
    }
    std::ranges::move(of_session, std::back_inserter(findings));
    const auto problems = std::ranges::count(findings, State::problem, &Finding::state);
    if (options.json) {
        nlohmann::ordered_json out{{"session", options.bus.session},
                                   {"domain", options.bus.domain},
                                   {"problems", problems},
                                   {"findings", nlohmann::ordered_json::array()}};
        for (const Finding& one : findings) {
            out["findings"].push_back({{"state", word(one.state)},
                                       {"area", one.area},
                                       {"thing", one.thing},
                                       {"text", one.text},
                                       {"remedy", one.remedy}});
        }
        out.update(json_of(report));
        print_json(true, out);
    } else {
        fmt::print("{}\n", problems == 0   ? "No problems found."
                           : problems == 1 ? "1 problem to fix."
                                           : fmt::format("{} problems to fix.", problems));
    }
    return problems == 0 ? 0 : 1;
}

}  // namespace
}  // namespace eti::doctor

int main(int argc, char** argv) {
    using namespace eti;
    doctor::Options options;
    options.bus.name = "eti-doctor";
    CommandLine app("Diagnoses this machine and a session: lists problems and their remedies.", "eti-doctor");
    app.add_number("--duration", options.duration, "Duration for which the session is observed",
                   {0.5, 3600.0, "s"})
        .capture_default_str();
    app.add_flag("--json", options.json, "Print everything as one JSON object");
    app.footer("Exit status: 0 no problems, 1 problems found, 2 wrong usage.");
    bus::add_options(app, options.bus);
    return run_program(app, argc, argv, [&] { return doctor::run(options); });
}
