// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
//
// eti-lab-link connects network namespaces of one machine by a medium with delay, loss and limited rate, for
// kernels without netem. The caller sets up namespaces and addresses (deploy/lab/hosts.py).
#include <fmt/format.h>
#include <poll.h>
#include <spdlog/spdlog.h>
#include <sys/prctl.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/process/program.hpp"
#include "common/process/threads/priority.hpp"
#include "deploy/lab/medium.hpp"
#include "deploy/lab/tap.hpp"

namespace {

using namespace eti::lab;
using namespace std::chrono_literals;

constexpr std::size_t largest_frame = 16384;  // [bytes], of an interface with a large MTU
constexpr int frames_at_once = 64;            // per host and turn

constexpr int as_hardware = eti::priority::loop + 5;

std::chrono::nanoseconds from_ms(double ms) {
    return std::chrono::nanoseconds(static_cast<std::int64_t>(1e6 * ms));
}

struct Numbers {
    double delay_ms = 0.0, jitter_ms = 0.0, loss_percent = 0.0, rate_mbit = 0.0;

    [[nodiscard]] Attachment attachment() const {
        return {from_ms(delay_ms), from_ms(jitter_ms), 0.01 * loss_percent, 1e6 * rate_mbit};
    }
};

struct Host {
    std::string name, space, interface = "eth0";
    Numbers numbers;
};

double number(std::string_view host, std::string_view key, std::string_view value, double most) {
    double x = 0.0;
    const auto [stop, error] = std::from_chars(value.data(), value.data() + value.size(), x);
    if (error != std::errc() || stop != value.data() + value.size() || !(x >= 0.0 && x <= most)) {
        throw std::invalid_argument(
            fmt::format("host '{}': {}={} is not a number from 0 to {:g}", host, key, value, most));
    }
    return x;
}

/// NAME=NAMESPACE[,interface=I][,delay=MS][,jitter=MS][,loss=PCT][,rate=MBIT]
Host parse_host(std::string_view text, const Numbers& common) {
    Host host{.name{}, .space{}, .numbers = common};
    bool first = true;
    for (std::string_view rest = text; !rest.empty();) {
        const std::string_view part = rest.substr(0, rest.find(','));
        rest.remove_prefix(std::min(rest.size(), part.size() + 1));
        const std::size_t equals = part.find('=');
        const std::string_view key = part.substr(0, equals);
        const std::string_view value = equals == part.npos ? "" : part.substr(equals + 1);
        if (key.empty() || value.empty()) {
            throw std::invalid_argument(fmt::format(
                "host '{}': '{}' is not KEY=VALUE; expected NAME=NAMESPACE[,delay=MS][,...]", text, part));
        }
        if (std::exchange(first, false)) {
            host.name = key;
            host.space = value;
        } else if (key == "interface") {
            host.interface = value;
        } else if (key == "delay") {
            host.numbers.delay_ms = number(text, key, value, 10e3);
        } else if (key == "jitter") {
            host.numbers.jitter_ms = number(text, key, value, 10e3);
        } else if (key == "loss") {
            host.numbers.loss_percent = number(text, key, value, 100.0);
        } else if (key == "rate") {
            host.numbers.rate_mbit = number(text, key, value, 1e6);
        } else {
            throw std::invalid_argument(fmt::format(
                "host '{}': '{}' is not known; expected interface, delay, jitter, loss or rate", text, key));
        }
    }
    return host;
}

void run(Medium& medium, std::vector<Tap>& taps) {
    std::vector<pollfd> files;
    for (const Tap& tap : taps) {
        files.push_back({tap.file(), POLLIN, 0});
    }
    std::vector<std::uint8_t> frame(largest_frame);
    while (!eti::stop_requested()) {
        const auto wait = std::clamp<std::chrono::nanoseconds>(medium.next_at() - Clock::now(), 0ns, 100ms);
        const timespec timeout{0, static_cast<long>(wait.count())};
        (void)::ppoll(files.data(), files.size(), &timeout, nullptr);
        for (std::size_t port = 0; port < taps.size(); ++port) {
            for (int i = 0; files[port].revents != 0 && i < frames_at_once; ++i) {
                const std::size_t size = taps[port].read(frame);
                if (size == 0) {
                    break;
                }
                medium.send(port, std::span(frame).first(size), Clock::now());
            }
        }
        while (const auto delivery = medium.next(Clock::now())) {
            taps[delivery->port].write(*delivery->frame);
        }
    }
}

nlohmann::json report(const std::vector<Host>& hosts, const Medium& medium) {
    nlohmann::json ports = nlohmann::json::object();
    for (std::size_t i = 0; i < hosts.size(); ++i) {
        const PortCount& count = medium.counts()[i];
        ports[hosts[i].name] = {
            {"sent", {{"frames", count.frames_sent}, {"bytes", count.bytes_sent}}},
            {"received", {{"frames", count.frames_received}, {"bytes", count.bytes_received}}},
            {"lost", count.lost},
            {"overflowed", count.overflowed},
            {"multicast_held_back", count.held_back}};
    }
    return ports;
}

}  // namespace

int main(int argc, char** argv) {
    eti::CommandLine app(
        "Connects network namespaces through a medium with delay and loss until SIGTERM; then prints "
        "statistics as JSON.\n"
        "Between two hosts the worse of their values applies. Prints 'up' when all interfaces exist.",
        "eti-lab-link");
    Numbers common;
    bool no_multicast = false;
    std::uint64_t seed = 1;
    std::vector<std::string> texts;
    app.add_number("--delay", common.delay_ms, "One-way delay", {0.0, 10e3, "ms"});
    app.add_number("--jitter", common.jitter_ms, "Additional delay, uniform from 0", {0.0, 10e3, "ms"});
    app.add_number("--loss", common.loss_percent, "Share of lost frames", {0.0, 100.0, "%"});
    app.add_number("--rate", common.rate_mbit, "Rate of each host in each direction; 0: no limit",
                   {0.0, 1e6, "Mbit/s"});
    app.add_flag("--no-multicast", no_multicast, "Drop multicast");
    app.add_number("--seed", seed, "Seed of the losses", {0}).capture_default_str();
    app.add_option("host", texts,
                   "NAME=NAMESPACE[,interface=eth0][,delay=MS][,jitter=MS][,loss=PCT][,rate=MBIT]; "
                   "NAMESPACE: /proc/PID/ns/net or /run/netns/NAME")
        .required();
    return eti::run_program(app, argc, argv, [&] {
        // Without this, the kernel would wake this thread up to 50 us late and schedule the hosts' programs
        // first. The thread stands for hardware, which takes no time from programs.
        ::prctl(PR_SET_TIMERSLACK, 1UL);
        if (const std::string refusal = eti::set_real_time_priority(as_hardware); !refusal.empty()) {
            spdlog::warn("{}", refusal);
        }
        std::vector<Host> hosts;
        std::vector<Tap> taps;
        std::vector<Attachment> ports;
        for (const std::string& text : texts) {
            hosts.push_back(parse_host(text, common));
            taps.emplace_back(hosts.back().space, hosts.back().interface);
            ports.push_back(hosts.back().numbers.attachment());
        }
        Medium medium(std::move(ports), !no_multicast, seed);
        fmt::print("up\n");
        std::fflush(stdout);
        run(medium, taps);
        fmt::print("{}\n", report(hosts, medium).dump());
        return 0;
    });
}
