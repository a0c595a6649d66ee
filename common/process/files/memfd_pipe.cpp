// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/process/files/memfd_pipe.hpp"

#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <new>

namespace eti {

namespace {

constexpr std::size_t most_at_once = 1u << 30;
constexpr int refused = 3;

std::runtime_error no_memory() {
    return std::runtime_error(
        fmt::format("no memory for the result of a child process: {}", std::strerror(errno)));
}

}  // namespace

MemfdPipe::MemfdPipe() : file_(::memfd_create("eti-parsed", MFD_CLOEXEC)) {
    if (!file_) {
        throw no_memory();
    }
}

void MemfdPipe::put(const void* data, std::size_t size) const {
    const auto* at = static_cast<const char*>(data);
    while (size > 0) {
        const ssize_t done = ::write(file_.get(), at, std::min(size, most_at_once));
        if (done <= 0) {
            throw no_memory();
        }
        at += done;
        size -= static_cast<std::size_t>(done);
    }
}

void MemfdPipe::put(const std::string& text) const {
    const std::size_t size = text.size();
    put(&size, sizeof(size));
    put(text.data(), size);
}

void MemfdPipe::rewind() const {
    ::lseek(file_.get(), 0, SEEK_SET);
}

bool MemfdPipe::get(void* data, std::size_t size) const {
    auto* at = static_cast<char*>(data);
    while (size > 0) {
        const ssize_t done = ::read(file_.get(), at, std::min(size, most_at_once));
        if (done <= 0) {
            return false;
        }
        at += done;
        size -= static_cast<std::size_t>(done);
    }
    return true;
}

bool MemfdPipe::get(std::string& text) const {
    std::size_t size = 0;
    constexpr std::size_t most = 1 << 20;
    if (!get(&size, sizeof(size)) || size > most) {
        return false;
    }
    text.resize(size);
    return get(text.data(), size);
}

std::string damaged_file_message(const std::string& name, const std::string& how,
                                 const std::string& expected) {
    return fmt::format("{}: damaged: reading failed with {}; expected {}. Remedy: copy or export it again.",
                       name, how, expected);
}

std::vector<std::uint8_t> parse_in_child(const std::function<std::vector<std::uint8_t>()>& parse,
                                         const std::string& name, const GuardLimits& limits) {
    const MemfdPipe channel;
    const GuardedResult ended = run_guarded(
        [&]() -> int {
            try {
                const std::vector<std::uint8_t> made = parse();
                const std::size_t size = made.size();
                channel.put(&size, sizeof(size));
                channel.put(made.data(), size);
                return 0;
            } catch (const std::bad_alloc&) {
                channel.put(name + ": reading exceeds the memory limit; expected a smaller file.");
            } catch (const std::exception& error) {
                channel.put(error.what());
            }
            return refused;
        },
        limits);
    constexpr const char* expected = "a whole file";
    if (ended.broken) {
        throw ParseError(damaged_file_message(name, *ended.broken, expected));
    }
    channel.rewind();
    if (ended.status != 0) {
        std::string finding;
        if (!channel.get(finding)) {
            finding = damaged_file_message(name, fmt::format("status {}", ended.status), expected);
        }
        throw ParseError(finding);
    }
    std::size_t size = 0;
    std::vector<std::uint8_t> made;
    if (channel.get(&size, sizeof(size)) && size <= limits.memory_bytes) {
        made.resize(size);
        if (channel.get(made.data(), size)) {
            return made;
        }
    }
    throw ParseError(damaged_file_message(name, "an incomplete result", expected));
}

}  // namespace eti
