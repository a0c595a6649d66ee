// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <vector>

#include "common/bus/fastdds/names.hpp"
#include "common/bus/guard/reader.hpp"

namespace eti::fuzz {

/// UDP in memory, in place of the library's own: this program defines UDPv4TransportDescriptor's
/// create_transport(), which the dynamic linker prefers to the library's. Everything above it, the filter
/// included, is what a session uses. Nothing is delivered by itself. Thread-safe.
class MemoryNetwork {
  public:
    using Receiver = bus::transport::TransportReceiverInterface;

    struct Sent {
        std::vector<std::uint8_t> bytes;
        std::vector<std::uint16_t> ports;
    };

    static MemoryNetwork& instance();

    /// Opens a port; a unicast port only once.
    bool open(std::uint16_t port, bool group, const void* owner, Receiver* receiver);
    void close(std::uint16_t port, const void* owner);
    [[nodiscard]] bool is_open(std::uint16_t port, const void* owner) const;
    /// Unicast ports, ascending.
    [[nodiscard]] std::vector<std::uint16_t> unicast_ports() const;

    void send(const std::uint8_t* bytes, std::size_t size, std::vector<std::uint16_t> ports);
    /// Whether sent datagrams are kept; otherwise they are lost.
    void keep_sent(bool keep);
    [[nodiscard]] std::vector<Sent> take_sent();

    /// Delivers a datagram on the calling thread to everyone that has opened the port. The bytes are copied
    /// into a buffer of their size, so that the sanitizer sees every read beyond them.
    void deliver(std::uint16_t port, bus::Bytes datagram);

  private:
    struct Port {
        const void* owner = nullptr;
        Receiver* receiver = nullptr;
        bool group = false;
    };

    mutable std::mutex mutex_;
    std::multimap<std::uint16_t, Port> ports_;
    std::vector<Sent> sent_;
    bool keep_ = false;
};

}  // namespace eti::fuzz
