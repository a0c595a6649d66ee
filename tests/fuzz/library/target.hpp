// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <memory>

#include "common/bus/participant.hpp"
#include "datagrams.hpp"

namespace eti::fuzz {

/// Topics that a participant writes; it reads those of the other.
enum class Side : std::uint8_t { server, client, both };

/// The bus of one program on the memory network, with topics of each kind: reliable and best-effort, keyed
/// and not, for late joiners, with liveliness, with one writer at a time, larger than a datagram.
class Target {
  public:
    /// `identity`: as Options::identity.
    Target(std::string_view name, Side side, const std::filesystem::path& identity);
    ~Target();

    [[nodiscard]] Prefix prefix() const;
    void receive(const Datagram& datagram) const;
    /// Takes all samples that have arrived.
    void take();
    /// Publishes a sample of each of its topics.
    void publish();
    [[nodiscard]] bool has_port(std::uint16_t port) const { return port == discovery_ || port == user_; }
    [[nodiscard]] bool is_user_port(std::uint16_t port) const { return port == user_; }

  private:
    struct Endpoints;
    std::shared_ptr<bus::Participant> participant_;
    std::unique_ptr<Endpoints> endpoints_;
    std::uint16_t discovery_ = 0, user_ = 0;
};

}  // namespace eti::fuzz
