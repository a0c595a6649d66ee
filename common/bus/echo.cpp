// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/bus/echo.hpp"

#include <algorithm>
#include <random>
#include <utility>

#include "common/bus/convert.hpp"

namespace eti::bus {

namespace {

constexpr std::chrono::milliseconds patience{250};  // so soon a node's end is noticed
constexpr std::size_t most_kept = 1000;

double milliseconds(std::uint64_t later, std::uint64_t earlier) {
    return (static_cast<double>(later) - static_cast<double>(earlier)) * 1e-6;
}

}  // namespace

EchoAnswers::EchoAnswers(std::shared_ptr<Participant> participant, std::string program)
    : program_(std::move(program)),
      questions_(participant, topics::echo_question),
      answers_(participant, topics::echo_answer) {
    questions_.ring(bell_);
    thread_ = std::thread([this] { run(); });
}

EchoAnswers::~EchoAnswers() {
    ending_.store(true, std::memory_order_relaxed);
    thread_.join();
}

void EchoAnswers::run() {
    msg::Echo question;
    while (!ending_.load(std::memory_order_relaxed)) {
        (void)bell_.wait(patience);
        while (questions_.take(question)) {
            answer(question);
        }
    }
}

void EchoAnswers::answer(const msg::Echo& question) {
    const std::uint64_t heard = wall_clock_ns();
    if (question.heard_ns() != 0 || !allowed_.take(Allowance::Clock::now())) {
        return;
    }
    msg::Echo message = question;
    message.header(make_header(0, question.header().number()));
    message.heard_ns(heard);
    message.answerer(process_name());
    message.program(program_);
    answers_.publish(message);
}

EchoAsker::EchoAsker(Node& node)
    : questions_(node, topics::echo_question),
      answers_(node, topics::echo_answer),
      nonce_((std::uint64_t{std::random_device()()} << 32) | std::random_device()()) {}

bool EchoAsker::ask() {
    msg::Echo question;
    question.header(make_header(0, static_cast<std::uint32_t>(++asked_)));
    question.asker(process_name());
    question.nonce(nonce_);
    question.asked_ns(question.header().send_time_ns());
    return questions_.publish(question) && questions_.matched() > 0;
}

void EchoAsker::poll() {
    while (answers_.take(message_)) {
        // Not when it is looked at: who asks once a second looks once a second.
        const std::uint64_t now = answers_.received_ns();
        const std::string process = message_.answerer().to_string();
        const std::uint64_t asked = message_.asked_ns(), heard = message_.heard_ns(),
                            sent = message_.header().send_time_ns();
        const bool ours = message_.nonce() == nonce_ && asked <= now && heard <= sent;
        if (!ours || (!peers_.contains(process) && peers_.size() >= most_peers)) {
            continue;
        }
        // Times of four events: asked and now by this clock, heard and sent by the peer's.
        const double round_trip = milliseconds(now, asked) - milliseconds(sent, heard);
        PeerEcho& peer = peers_[process];
        peer.process = process;
        peer.program = message_.program().to_string();
        peer.round_trip_ms = round_trip;
        if (peer.answers++ == 0 || round_trip < peer.least_round_trip_ms) {
            peer.least_round_trip_ms = round_trip;
            peer.clock_offset_ms = 0.5 * (milliseconds(heard, asked) + milliseconds(sent, now));
        }
        if (peer.round_trips_ms.size() == most_kept) {
            peer.round_trips_ms.erase(peer.round_trips_ms.begin());
        }
        peer.round_trips_ms.push_back(round_trip);
    }
}

}  // namespace eti::bus
