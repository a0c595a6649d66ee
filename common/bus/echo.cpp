// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/bus/echo.hpp"

#include <algorithm>
#include <random>
#include <utility>

#include "common/bus/codec/convert.hpp"

namespace eti::bus {

namespace {

constexpr std::chrono::milliseconds poll_timeout{250};  // bounds the time to notice that a node ends
constexpr std::size_t max_round_trips = 1000;

double milliseconds(std::uint64_t later, std::uint64_t earlier) {
    return (static_cast<double>(later) - static_cast<double>(earlier)) * 1e-6;
}

}  // namespace

EchoResponder::EchoResponder(std::shared_ptr<Participant> participant, std::string program)
    : program_(std::move(program)),
      questions_(participant, topics::echo_question),
      answers_(participant, topics::echo_answer) {
    questions_.notify(wait_set_);
    thread_ = std::thread([this] { run(); });
}

EchoResponder::~EchoResponder() {
    ending_.store(true, std::memory_order_relaxed);
    thread_.join();
}

void EchoResponder::run() {
    msg::Echo question;
    while (!ending_.load(std::memory_order_relaxed)) {
        (void)wait_set_.wait(poll_timeout);
        while (questions_.take(question)) {
            answer(question);
        }
    }
}

void EchoResponder::answer(const msg::Echo& question) {
    const std::uint64_t heard = wall_clock_ns();
    if (question.heard_ns() != 0 || !allowed_.try_acquire(RateLimiter::Clock::now())) {
        return;
    }
    msg::Echo message = question;
    message.header(make_header(0, question.header().number()));
    message.heard_ns(heard);
    message.answerer(process_name());
    message.program(program_);
    answers_.publish(message);
}

EchoRequester::EchoRequester(Node& node)
    : questions_(node, topics::echo_question),
      answers_(node, topics::echo_answer),
      nonce_((std::uint64_t{std::random_device()()} << 32) | std::random_device()()) {}

bool EchoRequester::ask() {
    msg::Echo question;
    question.header(make_header(0, static_cast<std::uint32_t>(++asked_)));
    question.asker(process_name());
    question.nonce(nonce_);
    question.asked_ns(question.header().send_time_ns());
    return questions_.publish(question) && questions_.matched() > 0;
}

void EchoRequester::poll() {
    while (answers_.take(message_)) {
        // Time of reception, not of polling: a program that polls once a second would add up to a second.
        const std::uint64_t now = answers_.received_ns();
        const std::string process = message_.answerer().to_string();
        const std::uint64_t asked = message_.asked_ns(), heard = message_.heard_ns(),
                            sent = message_.header().send_time_ns();
        const bool ours = message_.nonce() == nonce_ && asked <= now && heard <= sent;
        if (!ours || (!peers_.contains(process) && peers_.size() >= max_peers)) {
            continue;
        }
        // Times of four events: asked and now by this clock, heard and sent by the peer's.
        const double round_trip = milliseconds(now, asked) - milliseconds(sent, heard);
        PeerEcho& peer = peers_[process];
        peer.process = process;
        peer.program = message_.program().to_string();
        peer.round_trip_ms = round_trip;
        if (peer.answers++ == 0 || round_trip < peer.min_round_trip_ms) {
            peer.min_round_trip_ms = round_trip;
            peer.clock_offset_ms = 0.5 * (milliseconds(heard, asked) + milliseconds(sent, now));
        }
        if (peer.round_trips_ms.size() == max_round_trips) {
            peer.round_trips_ms.erase(peer.round_trips_ms.begin());
        }
        peer.round_trips_ms.push_back(round_trip);
    }
}

}  // namespace eti::bus
