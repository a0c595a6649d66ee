// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "deploy/doctor/session.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <thread>

#include "common/bus/discovery/peers.hpp"
#include "common/bus/echo.hpp"
#include "common/model/pace.hpp"
#include "common/process/stop_signal.hpp"

namespace eti::doctor {

namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds between_questions{100};
constexpr std::chrono::microseconds between_looks{200};  // added to every round trip
// A longer delay is felt in the hand (docs/hands); messages arrive every 5.6 ms.
constexpr double slow_ms = 20.0;
// The age of a frame is computed from two clocks; a larger offset than a frame's duration falsifies it.
constexpr double clock_ms = 15.0;
constexpr double lossy_percent = 1.0;
// Share of what is sent below which a link is too thin; a lossy one that suffices carries more.
constexpr double thin_share = 0.9;

// Of a datagram beside its payload: Ethernet, IP and UDP 46 bytes, RTPS 20, its timestamp 12, DATA with its
// header 28, the representation 4.
constexpr std::size_t overhead_bytes = 110;
// A single program that leaves and is wrongly believed gone may have an innocent cause.
constexpr std::uint64_t many_departures = 2;

/// Size in CDR, to a few bytes.
std::size_t bytes_of(const msg::DeformationState& message) {
    constexpr std::size_t header = 20, lengths = 12, frame = 24, node = 12;
    return header + lengths + frame * message.frames().size() + node * message.tube_nodes().size();
}

std::size_t bytes_of(const msg::LiveMetrics& message) {
    constexpr std::size_t others = 120, point = 12;
    return others + 4 * (message.measures().size() + message.live().size()) +
           point * (message.glottis_contour().size() + message.landmarks().size()) +
           8 * message.parameters().size() + message.message().size();
}

template <class Message>
void take_all(bus::Subscriber<Message>& topic, ChunkLossCounter& loss, std::uint64_t& bytes) {
    for (Message message; topic.take(message);) {
        bytes += bytes_of(message) + overhead_bytes;
        if constexpr (requires { message.chunks(); }) {
            loss.note(message.header().number(), message.chunks());
        } else {
            loss.note(message.header().number(), 1);
        }
    }
}

TopicReport report_of(std::string_view topic, const ChunkLossCounter& loss, std::uint64_t bytes,
                      double seconds) {
    return {std::string(topic), loss.arrived(), loss.lost(), loss.percent(),
            seconds > 0.0 ? 8e-6 * static_cast<double>(bytes) / seconds : 0.0};
}

/// Whether programs vanish that are still there, which stops forces each time and counts as no loss.
void diagnose_rediscoveries(const SessionReport& report, Findings& findings) {
    const bus::Rediscoveries& found = report.rediscoveries;
    if (found.after_departure >= many_departures) {
        findings.push_back(
            {"session", "departures", State::problem,
             fmt::format(
                 "{} times in {:.0f} s a program was said to have left that was still there; forces are "
                 "off each time",
                 found.after_departure, report.seconds),
             "somebody forges departures: use --identity (docs/security.md), or a network that strangers "
             "cannot enter"});
    }
    if (found.after_silence > 0) {
        findings.push_back(
            {"session", "connection", State::problem,
             fmt::format("{} times in {:.0f} s a program was lost and found again", found.after_silence,
                         report.seconds),
             "the link is interrupted, or the machine is too busy to answer: check cable and switch, and "
             "close other programs"});
    }
}

/// Whether the link carries what the server sends.
void diagnose_link(const SessionReport& report, Findings& findings) {
    double arrived = 0.0, sent = 0.0;
    for (const TopicReport& topic : report.topics) {
        arrived += topic.arrived_mbit_per_s;
        sent += topic.sent_mbit_per_s();
    }
    // What is missed while a program is believed gone is not the link's.
    const bool interrupted = report.rediscoveries.after_departure + report.rediscoveries.after_silence > 0;
    if (arrived <= 0.0 || interrupted) {
        return;
    }
    Finding finding{
        "loss", "link", State::ok,
        fmt::format("{:.1f} Mbit/s arrive of {:.1f} that the server sends to this program", arrived, sent),
        ""};
    if (arrived < thin_share * sent) {
        finding.state = State::problem;
        finding.remedy = fmt::format(
            "the link is too thin, or loses what it carries: a client needs {:.0f} Mbit/s with room to "
            "spare; "
            "use a cable, or let clients --observe, which takes a third",
            std::ceil(2.0 * sent));
    }
    findings.push_back(finding);
}

Finding diagnose_peer(const PeerReport& peer) {
    const double median = percentile(peer.round_trips_ms, 0.5);
    Finding finding{"peer", peer.name, State::ok, "", ""};
    const std::string who = fmt::format("{} {} version {}", peer.name, peer.process, peer.version);
    if (peer.protocol != bus::protocol) {
        finding.state = State::problem;
        finding.text = fmt::format("{} uses protocol {}, this program {}", who, peer.protocol, bus::protocol);
        finding.remedy = "they are incompatible; run programs of the same version on all machines";
        return finding;
    }
    if (peer.round_trips_ms.empty()) {
        finding.state = State::problem;
        finding.text = fmt::format("{} is announced, but does not answer", who);
        finding.remedy =
            "it was started with other network options than this program, it hangs, or a firewall passes UDP "
            "from port 7400 on in one direction only (docs/network.md)";
        return finding;
    }
    finding.text = fmt::format(
        "{}: round trip {:.2f} ms at least, {:.2f} median, {:.2f} p99 of {}; clock {:+.2f} ms "
        "(within {:.2f})",
        who, percentile(peer.round_trips_ms, 0.0), median, percentile(peer.round_trips_ms, 0.99),
        peer.round_trips_ms.size(), peer.clock_offset_ms, peer.error_ms);
    if (median > slow_ms) {
        finding.state = State::problem;
        finding.remedy = fmt::format(
            "delays above {} ms can be felt; use a cable, a nearer machine, or a less busy one", slow_ms);
    } else if (std::abs(peer.clock_offset_ms) > clock_ms + peer.error_ms) {
        finding.state = State::info;
        finding.remedy =
            "ages of pictures and messages depend on synchronised clocks; run chrony on both machines";
    }
    return finding;
}

}  // namespace

void ChunkLossCounter::note(std::uint32_t number, std::uint32_t chunks) {
    if (arrived_++ == 0) {
        last_ = number;
        chunks_ = std::max(1u, chunks);
        of_last_ = 1;
    } else if (number == last_) {
        ++of_last_;
    } else if (number > last_) {
        const std::uint32_t states = (number - last_ + steps_ / 2) / steps_;
        const std::uint64_t due = chunks_ + std::uint64_t{states > 0 ? states - 1 : 0} * std::max(1u, chunks);
        const std::uint64_t missing = due > of_last_ ? due - of_last_ : 0;
        // The number of chunks of the first state that were sent before this reader joined is unknown.
        if (settled_ > 0 || chunks_ == 1) {
            lost_ += missing;
        }
        settled_ += of_last_;
        last_ = number;
        chunks_ = std::max(1u, chunks);
        of_last_ = 1;
    } else if (lost_ > 0) {
        --lost_;  // a late one, counted as lost before
    }
}

double ChunkLossCounter::percent() const {
    const auto lost = static_cast<double>(lost_), all = lost + static_cast<double>(arrived_);
    return all > 0.0 ? 100.0 * lost / all : 0.0;
}

SessionReport observe(const bus::Options& options, std::chrono::duration<double> duration) {
    bus::Node node(options);
    bus::EchoRequester asker(node);
    bus::Subscriber<msg::SessionStatus> status(node, bus::topics::session_status);
    bus::Subscriber<msg::DeformationState> deformation(node, bus::topics::deformation);
    bus::Subscriber<msg::LiveMetrics> metrics(node, bus::topics::live_metrics);
    ChunkLossCounter deformation_loss(steps_per_second / 90), metrics_loss(steps_per_second / 30);
    std::uint64_t deformation_bytes = 0, metrics_bytes = 0;
    SessionReport report;
    const auto begin = Clock::now();
    std::optional<Clock::time_point> first;
    std::map<std::string, bus::Peer> met;
    const auto end = Clock::now() + std::chrono::duration_cast<Clock::duration>(duration);
    for (auto question = Clock::now(); Clock::now() < end && !stop_requested();) {
        if (Clock::now() >= question) {
            (void)asker.ask();
            question += between_questions;
            for (const bus::Peer& one : bus::discovered_peers(node)) {
                met[one.process] = one;
            }
            report.server = report.server || status.matched() > 0;
            report.contested = report.contested || node.contested();
        }
        asker.poll();
        take_all(deformation, deformation_loss, deformation_bytes);
        take_all(metrics, metrics_loss, metrics_bytes);
        if (!first && deformation_bytes + metrics_bytes > 0) {
            first = Clock::now();
        }
        std::this_thread::sleep_for(between_looks);
    }
    for (const auto& [process, one] : met) {
        if (one.session != options.session) {
            if (!std::ranges::count(report.elsewhere, one.session)) {
                report.elsewhere.push_back(one.session);
            }
            continue;
        }
        PeerReport peer{one.name, one.process, one.version, one.protocol, one.serves, {}, 0.0, 0.0};
        if (const auto told = asker.peers().find(process); told != asker.peers().end()) {
            peer.round_trips_ms = told->second.round_trips_ms;
            peer.clock_offset_ms = told->second.clock_offset_ms;
            peer.error_ms = 0.5 * told->second.min_round_trip_ms;
        }
        report.peers.push_back(peer);
    }
    const auto now = Clock::now();
    report.seconds = std::chrono::duration<double>(now - begin).count();
    report.rediscoveries = bus::rediscoveries(node);
    if (report.server) {
        const double receiving = std::chrono::duration<double>(now - first.value_or(now)).count();
        report.topics = {
            report_of(bus::topics::deformation.name, deformation_loss, deformation_bytes, receiving),
            report_of(bus::topics::live_metrics.name, metrics_loss, metrics_bytes, receiving)};
    }
    return report;
}

Findings diagnose_session(const SessionReport& report, const bus::Options& options) {
    Findings findings;
    if (report.contested) {
        findings.push_back({"session", options.session, State::problem,
                            "two programs write this session's status",
                            "forces are not reliable; stop one of them, or restrict access with --identity "
                            "(docs/security.md)"});
    }
    if (report.server) {
        findings.push_back({"session", options.session, State::ok,
                            fmt::format("a server runs it; {} programs found", report.peers.size()), ""});
    } else {
        const auto [finding, remedy] = bus::explain_missing_server(options);
        findings.push_back({"session", options.session, State::problem, finding, remedy});
    }
    if (!report.server && !report.elsewhere.empty()) {
        findings.push_back({"session", "others", State::info,
                            fmt::format("this domain has session '{}'", fmt::join(report.elsewhere, "', '")),
                            "is that the intended --session?"});
    }
    for (const PeerReport& peer : report.peers) {
        findings.push_back(diagnose_peer(peer));
    }
    diagnose_rediscoveries(report, findings);
    for (const TopicReport& topic : report.topics) {
        Finding finding{"loss", topic.topic, State::ok,
                        fmt::format("{} of {} messages lost ({:.2f} %)", topic.lost,
                                    topic.lost + topic.arrived, topic.lost_percent),
                        ""};
        if (topic.arrived == 0) {
            finding.state = State::info;
            finding.text = "no messages";
            finding.remedy = "the session may be waiting for its devices; otherwise check the server's log";
        } else if (topic.lost_percent > lossy_percent) {
            finding.state = State::problem;
            finding.remedy =
                "use larger socket buffers (above), a cable instead of wireless, or fewer observers on this "
                "link";
        }
        findings.push_back(finding);
    }
    diagnose_link(report, findings);
    return findings;
}

double percentile(std::vector<double> values, double share) {
    if (values.empty()) {
        return 0.0;
    }
    std::ranges::sort(values);
    const auto last = static_cast<double>(values.size() - 1);
    return values[static_cast<std::size_t>(std::ceil(share * last))];
}

}  // namespace eti::doctor
